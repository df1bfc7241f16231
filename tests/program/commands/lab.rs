//! `tomcom new`: what it writes is the project's own, and works.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tomcom_session::files::carried;

use super::complaint;
use crate::program::{self, TOMCOM, done};

#[test]
fn the_program_carries_every_settings_file_of_the_project() {
    let mut there = BTreeSet::new();
    for folder in ["layouts", "recipes", "sessions", "sessions/people", "sessions/questionnaires", "sessions/tutorials"]
    {
        let files = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
        there.extend(files.filter(|path| path.extension().is_some_and(|kind| kind == "toml")));
    }
    let carried: BTreeSet<PathBuf> = carried::FILES.iter().map(|(path, _)| PathBuf::from(path)).collect();
    assert_eq!(carried, there, "src/session/files/carried.rs and the files differ");
}

#[test]
fn a_new_lab_simulates_every_session_and_overwrites_nothing() {
    let lab = program::folder("new").join("lab");
    let path = lab.display().to_string();
    assert!(done(&["new", &path]).contains("26 files written"));
    let own = lab.join("sessions/default.toml");
    fs::write(&own, "# the lab's own\n").expect("written");
    let told = done(&["new", &path]);
    assert!(told.contains("0 files written") && told.contains("sessions/default.toml was there"), "{told}");
    assert_eq!(fs::read_to_string(&own).expect("read"), "# the lab's own\n");
    for session in ["all-arms", "burger", "paper", "probes", "study"] {
        let session = format!("sessions/{session}.toml");
        let simulate = ["simulate", &session, "--trials", "1", "--arm", "timed", "--out", "pilot"];
        let status = Command::new(TOMCOM).args(simulate).current_dir(&lab).output().expect("tomcom runs");
        assert!(status.status.success(), "{status:?}");
    }
}

#[test]
fn a_file_that_a_lab_would_have_is_missed_with_the_remedy() {
    let empty = program::folder("no-lab");
    for command in ["plan", "simulate", "operate", "keys"] {
        let command = Command::new(TOMCOM).args([command, "sessions/study.toml"]).current_dir(&empty).output();
        let told = String::from_utf8(command.expect("tomcom runs").stderr).expect("UTF-8");
        assert!(told.contains("sessions/study.toml: cannot be read") && told.contains("tomcom new DIR"), "{told}");
    }
    assert!(Path::new(&empty).read_dir().expect("a folder").next().is_none());
    assert!(!complaint(&["plan", "sessions/other.toml"]).contains("tomcom new"));
}
