//! `tomcom forget`: it asks first, and forgets a person everywhere.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serial_test::serial;
use tomcom::edge::files::read_session;
use tomcom::run::simulate::{Shard, SimulationRequest, simulate};

use crate::tmux::TOMCOM;

#[test]
#[serial]
fn forgetting_asks_first_and_a_wizards_code_is_that_of_the_training() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("forgetting");
    let _ = fs::remove_dir_all(&out);
    let mut files = read_session(Path::new("sessions/paper.toml")).expect("the paper's session");
    files.spec.trial.presses = 10;
    let simulation = SimulationRequest { files, trials: 1, shard: Shard::WHOLE, out: out.clone() };
    simulate(&simulation, || ()).expect("the folder can be written");
    let record = |wizard: &str, recordings: &[&str]| {
        let judged = |name: &&str| {
            format!(
                "{{\"recording\":\"{name}\",\"complete\":true,\"presses\":1,\"signals\":[],\"measures\":{},\"kappa_with_oneself\":null}}",
                serde_json::to_string(&tomcom::measures::wizard::WizardMeasures::from_signals(&[], None))
                    .expect("JSON")
            )
        };
        let judged: Vec<String> = recordings.iter().map(judged).collect();
        format!(
            "{{\"wizard\":\"{wizard}\",\"at\":\"2026-03-14T10:00:00Z\",\"minutes\":1.0,\"criterion\":{{\"hits\":0.6,\"wrong\":0.4}},\"met\":true,\"recordings\":[{}]}}",
            judged.join(",")
        )
    };
    let training = out.join("training");
    fs::create_dir_all(&training).expect("made");
    fs::write(training.join("W1-1.json"), record("W1", &["seed1-P01-1", "seed9-S001"])).expect("written");
    fs::write(training.join("W1-2.json"), record("W1", &["seed1-P01-1"])).expect("written");
    fs::write(training.join("W2-1.json"), record("W2", &["seed9-S001"])).expect("written");
    let tomcom = |arguments: &[&str]| {
        let out = out.to_str().expect("UTF-8");
        let mut command = Command::new(TOMCOM);
        let done = command.args(arguments).args(["--in", out]).stdin(Stdio::null()).output();
        let done = done.expect("the program starts");
        (done.status.code(), String::from_utf8_lossy(&[done.stdout, done.stderr].concat()).into_owned())
    };
    let (code, told) = tomcom(&["forget", "P01"]);
    assert!(code == Some(2) && told.contains("seed1-P01-1 (recording)") && told.contains("--yes"), "{told}");
    assert!(out.join("seed1-P01-1").exists());
    assert_eq!(tomcom(&["forget", "P01", "--yes"]).0, Some(0));
    assert!(!out.join("seed1-P01-1").exists() && !training.join("W1-2.json").exists());
    let left = fs::read_to_string(training.join("W1-1.json")).expect("what was trained on others stays");
    assert!(left.contains("seed9-S001") && !left.contains("P01"), "{left}");
    assert_eq!(tomcom(&["forget", "P01", "--yes"]).0, Some(1), "there is nothing left");
    assert_eq!(tomcom(&["forget", "W1", "--yes"]).0, Some(0));
    assert!(!training.join("W1-1.json").exists() && training.join("W2-1.json").exists());
    assert_eq!(tomcom(&["forget", "Jane Doe", "--yes"]).0, Some(2));
}
