//! Session files: their defaults, their keys, their presets.

use tomcom::console::{KeyBindings, KeyFileBindings};
use tomcom_core::communication::signals;
use tomcom_core::mind::model::{PAPER_2021, PLAIN};
use tomcom_session::files::parse::parse;
use tomcom_session::settings::RobotSpec;

use crate::support::*;

#[test]
fn every_session_file_loads_and_its_keys_are_unambiguous() {
    for entry in std::fs::read_dir("sessions").expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let mut files = read_session(&path).unwrap_or_else(|error| panic!("{error}"));
        files.spec.participant.kind = ParticipantKind::Keyboard;
        KeyBindings::live(&files.kitchen.kitchen, &files.spec, &KeyFileBindings::default())
            .unwrap_or_else(|clash| panic!("{}: {clash}", path.display()));
    }
}

#[test]
fn the_default_session_spells_out_every_default() {
    let path = Path::new("sessions/default.toml");
    let only_layout: SessionSpec = parse(path, "layout = \"../layouts/sushi.toml\"").expect("a session file");
    let spec = read_session(path).expect("the default session").spec;
    // But for the arm, which is timed where nothing is said.
    let robot = RobotSpec { arm: ArmKind::Timed, ..spec.robot };
    assert_eq!(SessionSpec { robot, ..spec }, only_layout);
}

#[test]
fn a_session_names_a_model_and_sets_single_parameters_on_top_of_it() {
    let read = |settings: &str| SessionSpec::from_toml(&format!("layout = \"\"\n{settings}"));
    let spec = read("[human]\nmodel = \"paper-2021\"\n[human.decision]\ntau = 3.0\n").expect("settings");
    let mut wanted = PAPER_2021;
    wanted.decision.tau = 3.0;
    assert_eq!(spec.human, wanted);
    assert_eq!(spec.human.differences(), ["decision.tau = 3.0, not 4.0"]);
    assert_eq!(read("").expect("settings").human, PLAIN);
    let header = serde_json::to_string(&spec).expect("JSON");
    assert_eq!(serde_json::from_str::<SessionSpec>(&header).expect("the same settings"), spec);
    let unknown = read("[human]\nmodel = \"paper\"\n").expect_err("no such model").to_string();
    assert!(unknown.contains("paper-2021"), "{unknown}");
}

#[test]
fn signals_highlight_what_session_or_model_name() {
    let setup = session_file("default");
    let kitchen = setup.kitchen.kitchen;
    let highlighted = |spec: &SessionSpec| {
        let all = signals(&kitchen, spec.highlights(&kitchen)).into_iter();
        let names = all.filter_map(|(_, signal)| match signal {
            Signal::Highlight(name) => Some(name),
            _ => None,
        });
        names.collect::<Vec<String>>()
    };
    let mut spec = setup.spec;
    let usual = highlighted(&spec);
    assert!(usual.contains(&"counter".to_string()) && !usual.contains(&"human_hand".to_string()), "{usual:?}");
    spec.human = PAPER_2021;
    assert_eq!(highlighted(&spec), ["robot_hand", "assembly_board"]);
    spec.signals.highlights = Some(vec!["counter".to_string()]);
    assert_eq!(highlighted(&spec), ["counter"]);
    assert!(spec.check_kitchen(&kitchen).is_ok());
    for refused in [&["cellar"][..], &["human_hand"], &["order_1"], &["counter", "counter"]] {
        spec.signals.highlights = Some(refused.iter().map(|name| name.to_string()).collect());
        let error = spec.check_kitchen(&kitchen).expect_err("nothing to highlight");
        assert!(error.found.starts_with(&format!("highlights = {refused:?}, ")), "{error}");
        assert!(!error.remedy.contains("human_hand") && !error.remedy.contains("order"), "{error}");
    }
}

#[test]
fn presets_of_the_session_file_are_checked() {
    let wrong = |change: fn(&mut SessionSpec)| {
        let mut spec = session_file("default").spec;
        change(&mut spec);
        spec.check().expect_err("a wrong setting").key().to_string()
    };
    assert_eq!(wrong(|spec| spec.console.notes.push("a sixth".to_string())), "notes");
    assert_eq!(wrong(|spec| spec.console.notes[0] = "two\nlines".to_string()), "notes");
    assert_eq!(wrong(|spec| spec.console.reasons[0] = "x".repeat(41)), "reasons");
}
