//! `tomcom new`, and the program outside of a lab's folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tomcom_session::files::carried;

use crate::program::{TOMCOM, done, files_below, folder, verified};

/// Runs the program in a folder; its exit code and what it said on standard error.
fn run_in(place: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(TOMCOM);
    command.args(arguments).current_dir(place).stdin(Stdio::null());
    let Output { status, stderr, .. } = command.output().expect("tomcom runs");
    (status.code(), String::from_utf8(stderr).expect("UTF-8"))
}

#[test]
fn the_program_carries_every_settings_file_of_the_project() {
    let files = ["layouts", "recipes", "sessions"].map(|folder| files_below(Path::new(folder))).concat();
    let is_settings = |path: &PathBuf| path.extension().is_some_and(|kind| kind == "toml");
    let there: BTreeSet<PathBuf> = files.into_iter().filter(is_settings).collect();
    let carried: BTreeSet<PathBuf> = carried::FILES.iter().map(|(path, _)| PathBuf::from(path)).collect();
    assert_eq!(carried, there, "src/session/files/carried.rs and the files differ");
}

#[test]
fn a_new_lab_simulates_every_session_and_overwrites_nothing() {
    let lab = folder("new").join("lab");
    let path = lab.display().to_string();
    // Beside them a README, and four scripts that read recordings and tables.
    let files = carried::FILES.len() + 5;
    let told = done(&["new", &path]);
    assert!(told.contains(&format!("{files} files written")), "{told}");
    // What is tried first is no recording of the study.
    assert!(told.ends_with("lab, and tomcom --out try. README.md says what else.\n"), "{told}");
    let own = lab.join("recipes/burger.toml");
    fs::write(&own, "# the lab's own\n").expect("written");
    fs::remove_file(lab.join("sessions/study.toml")).expect("removed");
    let (code, told) = run_in(&lab, &["plan"]);
    assert_eq!(code, Some(2), "in a lab's folder, its own files hold: {told}");
    assert!(told.contains("sessions/study.toml: cannot be read") && told.contains("tomcom new DIR"), "{told}");
    let told = done(&["new", &path]);
    assert!(told.contains("1 file written") && told.contains("recipes/burger.toml was there"), "{told}");
    assert_eq!(fs::read_to_string(&own).expect("read"), "# the lab's own\n");
    let (code, told) = run_in(&lab, &["plan"]);
    assert_eq!((code, told.as_str()), (Some(0), ""));
    for session in ["all-arms", "arms", "default", "paper", "probes", "study"] {
        let (file, out) = (format!("sessions/{session}.toml"), format!("pilot/{session}"));
        let simulated = run_in(&lab, &["simulate", &file, "--trials", "1", "--arm", "timed", "--out", &out]);
        assert_eq!(simulated.0, Some(0), "{}", simulated.1);
        assert!(!simulated.1.contains("carries"), "{}", simulated.1);
    }
}

#[test]
fn outside_of_a_lab_the_program_reads_what_it_carries_and_says_so() {
    let place = folder("no-lab");
    let goes = format!("Recordings go to {}.", place.join("pilot").display());
    for (arguments, code, out) in [
        (&["plan", "--out", "pilot"][..], 0, true),
        (&["plan", "./sessions/people/../all-arms.toml"], 0, false),
        (&["kitchen"], 0, false),
        (&["kitchen", "layouts/burger.toml"], 0, false),
        (&["keys"], 0, false),
        (&["doctor", "sessions/study.toml", "--out", "pilot"], 1, true),
        (&["simulate", "--trials", "1", "--arm", "timed", "--seed", "7", "--out", "pilot"], 0, true),
        // There is no terminal here; where recordings would go is said before.
        (&["--out", "pilot"], 1, true),
        (&["tutorial", "--out", "pilot", "--language", "de"], 1, true),
    ] {
        let (found, told) = run_in(&place, arguments);
        assert_eq!(found, Some(code), "{arguments:?}: {told}");
        assert!(told.starts_with("No lab's folder is here: "), "{arguments:?}: {told}");
        assert!(told.contains("tomcom new DIR") && told.contains(&goes) == out, "{arguments:?}: {told}");
    }
    let recording = place.join("pilot/seed7-S001");
    verified(&recording);
    let same = ["simulate", "sessions/default.toml", "--trials", "1", "--arm", "timed", "--seed", "7", "--out"];
    let of_files = folder("no-lab-files");
    done(&[&same[..], &[&of_files.display().to_string()]].concat());
    let log = |folder: &Path| fs::read(folder.join("seed7-S001/events.jsonl")).expect("a log");
    assert!(log(&place.join("pilot")) == log(&of_files), "a carried session is that of the files");
    // Who names the file of a session with a person means that file.
    for arguments in [&["operate", "sessions/study.toml", "--code", "P01"][..], &["plan", "sessions/other.toml"]] {
        let (code, told) = run_in(&place, arguments);
        assert_eq!(code, Some(2), "{told}");
        assert!(
            told.contains("cannot be read") && told.contains("tomcom new DIR") == (arguments[0] == "operate"),
            "{told}"
        );
    }
    let (_, told) = run_in(&place, &["plan", "sessions/studdy.toml"]);
    assert!(told.contains("; did you mean sessions/study.toml?"), "{told}");
}
