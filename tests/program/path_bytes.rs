//! Paths that are no text: every command works in a folder whose name is not UTF-8, and its JSON is JSON.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use tomcom_session::log::LOG_NAME;

use crate::program::{self, TOMCOM, session_file};

/// Runs a command and demands the exit code; the JSON that it prints.
fn json(code: i32, arguments: &[&OsStr]) -> Value {
    let output = Command::new(TOMCOM).args(arguments).stdin(Stdio::null()).output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {told}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{arguments:?}: {error}: {output:?}"))
}

#[test]
fn every_command_works_in_a_folder_whose_name_is_no_text() {
    let home = program::folder("path-bytes");
    let folder = home.join(OsStr::from_bytes(b"lab \xff\xfe"));
    fs::create_dir(&folder).expect("a file system with names that are no text");
    let at = |name: &str| folder.join(name).into_os_string();
    let word = OsString::from;
    let run = |code: i32, words: &[OsString]| {
        let mut words: Vec<&OsStr> = words.iter().map(OsString::as_os_str).collect();
        words.extend([OsStr::new("--format"), OsStr::new("json")]);
        json(code, &words)
    };
    let shown = folder.display().to_string();
    let session = session_file(&home, "seed = 7\n[trial]\npresses = 20\n[robot]\narm = \"timed\"\n");
    let simulate = [word("simulate"), word(session.as_str()), word("--trials"), word("1"), word("--out")];
    let [all, recording] = [at("all"), at("all/seed7-S001")];
    let simulated = run(0, &[&simulate[..], &[all.clone(), word("--rerun")]].concat());
    assert_eq!(simulated["recordings"][0], format!("{shown}/all/seed7-S001"));
    run(0, &[word("study"), all.clone(), word("--skip"), word("concepts"), word("--out"), at("study")]);
    let of_recording: [(&[&str], &[OsString]); 7] = [
        (&["replay"], &[]),
        (&["replay"], &[word("--verify")]),
        (&["compare"], &[word("--with"), word("tom-com")]),
        (&["codes"], &[word("--export"), at("codes.csv")]),
        (&["export"], &[word("--mcap"), word("--bids"), at("bids")]),
        (&["fit"], &[word("--parameters"), word("tau"), word("--tries"), word("10"), word("--out"), at("fitted.toml")]),
        (&["exclude"], &[word("--reason"), word("noise")]),
    ];
    for (command, options) in of_recording {
        let command: Vec<OsString> = command.iter().map(OsString::from).collect();
        run(0, &[&command[..], std::slice::from_ref(&recording), options].concat());
    }
    run(0, &[word("list"), all.clone()]);
    let study = word("sessions/study.toml");
    run(0, &[word("plan"), study.clone(), word("--out"), all.clone()]);
    let frozen = run(0, &[word("plan"), study, word("--freeze"), at("frozen")]);
    assert_eq!(frozen["file"], format!("{shown}/frozen"));
    run(1, &[word("doctor"), word("--out"), all.clone()]);
    run(2, &[word("forget"), word("S001"), word("--in"), all.clone()]);

    let log = Path::new(&recording).join(LOG_NAME);
    let text = fs::read_to_string(&log).expect("a log");
    let line = text.lines().find(|line| line.contains("\"kind\":\"participant_believes\"")).expect("a witness");
    let stamp = line.split_once("\"kind\"").expect("a stamp").0;
    fs::write(&log, text.replacen(line, &format!("{stamp}\"kind\":\"marker\",\"note\":\"x\"}}"), 1)).expect("written");
    let differs = run(1, &[word("replay"), recording, word("--verify")]);
    assert_eq!(differs["difference"]["log"], format!("{shown}/all/seed7-S001/events.jsonl"));
    let forgotten = run(0, &[word("forget"), word("S001"), word("--in"), all, word("--yes")]);
    assert_eq!(forgotten["deleted"], true, "{forgotten}");
}

#[test]
fn a_gaze_file_whose_path_is_no_text_is_refused_before_the_session() {
    let mut command = Command::new(TOMCOM);
    command.args(["operate", "--participant", "keyboard", "--gaze-file"]).arg(OsStr::from_bytes(b"lab \xff/gaze.csv"));
    let output = command.stdin(Stdio::null()).output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && told.contains("no UTF-8"), "{output:?}");
}
