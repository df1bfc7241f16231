//! `simulate`, `kitchen`, `fit` and `accuracy`, and `replay --verify`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{check, complaint, failed};
use crate::program::{folder, json, session_file};

#[test]
fn kitchen_prints_the_state_space_and_the_plans() {
    let sushi = json(&["kitchen", "layouts/sushi.toml"]);
    assert_eq!(sushi["states"], "83878450387200000");
    assert_eq!(sushi["aspects"].as_array().map(Vec::len), Some(16));
    let plans = sushi["plans"].as_array().expect("plans");
    let mut lengths: Vec<u64> = plans.iter().filter_map(|plan| plan["actions"].as_u64()).collect();
    lengths.sort_unstable();
    assert_eq!(lengths, [15, 15, 16, 16, 18, 19]);
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = json(&["kitchen", layout]);
        for plan in kitchen["plans"].as_array().expect("plans") {
            let presses = plan["presses"].as_array().map(|presses| presses.len() as u64);
            assert_eq!(presses, plan["actions"].as_u64(), "{layout}: {plan}");
        }
        check(&["kitchen", layout], 0);
    }
}

#[test]
fn simulate_records_what_replay_verifies() {
    let out = folder("simulate");
    let out = out.to_str().expect("a path in UTF-8");
    let simulate =
        ["simulate", "sessions/default.toml", "--trials", "2", "--seed", "7", "--arm", "timed", "--out", out];
    let found = json(&simulate);
    for key in ["trials", "human_actions", "robot_actions", "errors", "signals", "orders_served", "presses_per_order"] {
        assert!(found[key].is_number(), "{key} in {found}");
    }
    for key in ["belief_related_errors", "sequences", "mean_sequence_length"] {
        assert!(found[key].is_number(), "{key} in {found}");
    }
    let recordings = found["recordings"].as_array().expect("recordings");
    assert_eq!(recordings.len(), 2);
    let mut related = 0;
    for recording in recordings {
        let recording = recording.as_str().expect("a path");
        let verified = json(&["replay", recording, "--verify"]);
        assert_eq!((&verified["verified"], &verified["cut"]), (&Value::Bool(true), &Value::Bool(false)));
        let replayed = json(&["replay", recording]);
        assert_eq!(replayed["events"], verified["events"]);
        related += replayed["belief_related_errors"].as_u64().expect("a number of errors");
        let log = fs::read_to_string(Path::new(recording).join("events.jsonl")).expect("a log");
        let header: Value = serde_json::from_str(log.lines().next().unwrap_or_default()).expect("a header");
        assert_eq!((header.get("started"), &header["session"]["trial"]["condition"]), (None, &Value::from("none")));
    }
    assert_eq!(found["belief_related_errors"].as_u64(), Some(related), "replays find the causes that simulate found");
    let paths: Vec<&str> = recordings.iter().filter_map(Value::as_str).collect();
    check(&[&["replay"], &paths[..]].concat(), 2);
    // What was changed does not verify, which is an answer and no wrong argument.
    let log = Path::new(recordings[0].as_str().expect("a path")).join("events.jsonl");
    let text = fs::read_to_string(&log).expect("a log").replacen("take nori", "take rice", 1);
    fs::write(&log, text).expect("the log can be written");
    let log = log.to_str().expect("a path in UTF-8");
    assert_eq!(failed(&["replay", log, "--verify"])["verified"], Value::Bool(false));
}

#[test]
fn it_is_a_failure_if_every_trial_of_a_program_fails() {
    let out = folder("every-trial-failed");
    let out = out.to_str().expect("a path in UTF-8");
    let [acts, league] = [["--condition", "assistant", "--concept"].as_slice(), &["--concepts"]];
    for (command, concept) in [("simulate", acts), ("tournament", league)] {
        let simulate = [command, "sessions/default.toml", "--arm", "timed", "--trials", "1", "--out", out];
        let failed = check(&[&simulate[..], concept, &["exit 7; /"]].concat(), 1);
        let told = String::from_utf8_lossy(&failed.stderr);
        assert!(told.contains("every trial failed: ") && !failed.stdout.is_empty(), "{told}");
    }
}

#[test]
fn a_simulation_replaces_itself_and_no_other_recording() {
    let out = folder("replaced");
    let out = out.to_str().expect("a path in UTF-8");
    let log = Path::new(out).join("seed7-S001/events.jsonl");
    let simulate = |session: &'static str| ["simulate", session, "--seed", "7", "--arm", "timed", "--out", out];
    check(&simulate("sessions/default.toml"), 0);
    let before = fs::read(&log).expect("a log");
    check(&simulate("sessions/default.toml"), 0);
    assert!(fs::read(&log).expect("a log") == before, "the same session is the same recording");
    let refused = check(&simulate("sessions/burger.toml"), 1);
    let told = String::from_utf8_lossy(&refused.stderr);
    assert!(told.contains("seed7-S001") && told.contains("the recording of another session"), "{told}");
    assert!(fs::read(&log).expect("a log") == before, "what was there is still there");
    // A recording of another format: what other commands say about it, with the remedy.
    let text = String::from_utf8(before).expect("UTF-8").replacen("\"version\":3", "\"version\":2", 1);
    fs::write(&log, text).expect("written");
    let program = env!("CARGO_PKG_VERSION");
    let remedy =
        format!("found format version 2; wanted: format version 3, or the tomcom {program} that wrote the log");
    for (command, code) in [(&simulate("sessions/default.toml")[..], 1), (&["list", out], 0)] {
        let output = check(command, code);
        let told =
            [output.stderr, output.stdout].map(|text| String::from_utf8_lossy(&text).replace("\n", " ")).concat();
        let told = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(told.contains(&remedy), "{told}");
    }
}

/// Few presses, thought about little: what the commands print is looked at here, not how good it is.
const QUICK: &str = "[trial]
condition = \"none\"
presses = 30
[assistant.rollout]
horizon = 2
rollouts = 4
states = 2
least_rollouts = 2
";

/// A wizard who is a person is not there: of a plan, the conditions are named that have no signals.
#[test]
fn simulate_tells_which_conditions_of_a_plan_have_no_signals() {
    let folder = folder("absent");
    let out = folder.join("out").display().to_string();
    let plan = "[console]\nvisibility = \"state\"\n[plan]\nname = \"absent\"\nparticipants = 1\n\
                conditions = [\"none\", \"wizard\", \"wizard+advice\"]\n";
    let told = |wizard: &str, seed: &str| {
        let session = session_file(&folder, &format!("{QUICK}{plan}{wizard}"));
        let output = check(&["simulate", &session, "--out", &out, "--seed", seed], 0);
        [output.stderr, output.stdout].map(|text| String::from_utf8_lossy(&text).into_owned())
    };
    let [aside, summary] = told("", "9704");
    assert!(aside.contains("\"wizard\" and \"wizard+advice\"") && aside.contains("without signals"), "{aside}");
    assert!(!summary.contains("wizard with advice"), "{summary}");
    let [aside, summary] = told("[wizard]\nkind = \"scripted\"\n", "9705");
    assert_eq!(aside, "");
    assert!(summary.contains("  wizard: ") && summary.contains("  wizard with advice: "), "{summary}");
}

#[test]
fn simulate_tells_what_holds_at_the_console_alone() {
    let folder = folder("unused");
    let out = folder.join("out").display().to_string();
    let acting =
        QUICK.replace("\"none\"", "\"assistant\"").replace("[assistant.", "[assistant]\nshadow = \"on\"\n[assistant.");
    let session = session_file(&folder, &acting);
    let told = |arguments: &[&str]| {
        let output = check(&[&["simulate", &session, "--out", &out], arguments].concat(), 0);
        let told = String::from_utf8_lossy(&output.stderr);
        ["the assistant does not act; --condition assistant does that", "advice is not computed; --shadow does that"]
            .map(|option| told.contains(option))
    };
    assert_eq!(told(&[]), [true, true]);
    assert_eq!(told(&["--shadow", "--seed", "2"]), [true, false]);
    // An assistant that acts computes recommendations anyway.
    assert_eq!(told(&["--condition", "assistant", "--seed", "3"]), [false, false]);
}

#[test]
fn fit_writes_a_parameter_file_and_accuracy_tells_its_figures() {
    let folder = folder("fit");
    let path = |name: &str| folder.join(name).to_str().expect("a path in UTF-8").to_string();
    let [start, out, fitted] = ["start.toml", "out", "fitted.toml"].map(path);
    let session = session_file(&folder, QUICK);
    let few = "[inference]\nbeliefs = 8\nstates = 4\nmax_beliefs = 8\npredictions = 4\n";
    fs::write(&start, few).expect("the parameters can be written");
    let simulated = json(&["simulate", &session, "--out", &out]);
    let recording = simulated["recordings"][0].as_str().expect("a recording");
    let fit = ["fit", recording, "--start", &start, "--tries", "10", "--out", &fitted];
    let found = json(&[&fit[..], &["--parameters", "tau,lapse"]].concat());
    assert_eq!(found["human_actions"], simulated["human_actions"]);
    let names: Vec<&str> =
        found["parameters"].as_array().expect("parameters").iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["tau", "lapse"]);
    // What was fitted is in force where a session names the file.
    let session = session_file(&folder, &format!("human_model = {fitted:?}\n{QUICK}"));
    let again = json(&["simulate", &session, "--out", &out, "--seed", "5"]);
    let log = Path::new(again["recordings"][0].as_str().expect("a recording")).join("events.jsonl");
    let log = fs::read_to_string(log).expect("a log");
    let header: Value = serde_json::from_str(log.lines().next().unwrap_or_default()).expect("a header");
    let [in_force, fitted_tau] = [&header["session"]["human"]["decision"]["tau"], &found["parameters"][0]["value"]];
    assert!((in_force.as_f64().expect("a number") - fitted_tau.as_f64().expect("a number")).abs() < 1e-9);
    assert!(complaint(&["fit", &session]).contains("events.jsonl"));
    let paper = path("paper.toml");
    fs::write(&paper, "model = \"paper-2021\"\n").expect("the parameters can be written");
    let told = complaint(&["fit", recording, "--start", &paper, "--parameters", "tau,reading"]);
    assert!(told.contains("reading_rate_hz is not used with observation = \"sample\""), "{told}");
    assert!(complaint(&["fit", recording, "--probes"]).contains("no answer to a freeze probe"));
}
