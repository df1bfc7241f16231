//! Session files: their defaults, their keys, their presets.

use std::path::Path;

use tomcom::console::{KeyBindings, KeyFileBindings};
use tomcom::edge::files::read_session;
use tomcom::edge::parse::parse;
use tomcom::session::settings::{ArmKind, ParticipantKind, RobotSpec, SessionSpec};

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
fn presets_of_the_session_file_are_checked() {
    let wrong = |change: fn(&mut SessionSpec)| {
        let mut spec = read_session(Path::new("sessions/default.toml")).expect("the default session").spec;
        change(&mut spec);
        spec.check().expect_err("a wrong setting").key().to_string()
    };
    assert_eq!(wrong(|spec| spec.console.notes.clear()), "notes");
    assert_eq!(wrong(|spec| spec.console.notes.push("a sixth".to_string())), "notes");
    assert_eq!(wrong(|spec| spec.console.notes[0] = "two\nlines".to_string()), "notes");
    assert_eq!(wrong(|spec| spec.console.reasons[0] = "x".repeat(41)), "reasons");
    assert_eq!(wrong(|spec| spec.signals.cool_down_s = -1.0), "cool_down_s");
}
