//! What the program prints commands no terminal, whatever stands in the files that it reads.

use std::fs;
use std::path::{Path, PathBuf};

use tomcom_session::log::LOG_NAME;

use crate::program::{done, folder, tomcom};

/// Clears the screen, and begins a sequence in one byte (as it stands in a text, and in JSON).
const HOSTILE: &str = "a\x1b[2J\u{9b}31mb\u{202e}";
const IN_JSON: &str = "a\\u001b[2J\u{9b}31mb\u{202e}";
/// What is left of it.
const WRITTEN_OUT: &str = "a\\u001b[2J\\u009b31mb\\u202e";

/// The output, of which nothing commands a terminal.
fn check(arguments: &[&str]) -> String {
    let output = tomcom(arguments);
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("text")).concat();
    let commands = |letter: char| (letter.is_control() && letter != '\n') || letter == '\u{202e}';
    assert!(!text.chars().any(commands), "{arguments:?}: {text:?}");
    text
}

/// A recording in a folder of a hostile name, with a hostile note in its log.
fn recording(home: &Path) -> PathBuf {
    let out = home.display().to_string();
    done(&["simulate", "sessions/default.toml", "--seed", "7", "--arm", "timed", "--out", &out]);
    let recording = home.join(HOSTILE);
    fs::rename(home.join("seed7-S001"), &recording).expect("renamed");
    let log = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    // A note in the place of a witness changes nothing else.
    let line = log.lines().find(|line| line.contains("\"kind\":\"participant_believes\"")).expect("a witness");
    let stamp = line.split_once("\"kind\"").expect("a stamp").0;
    let noted = log.replacen(line, &format!("{stamp}\"kind\":\"marker\",\"note\":\"{IN_JSON}\"}}"), 1);
    fs::write(recording.join(LOG_NAME), noted).expect("written");
    recording
}

#[test]
fn wrong_arguments_are_told_with_control_characters_written_out() {
    let option = format!("--{HOSTILE}");
    let arguments: [&[&str]; 8] = [
        &[HOSTILE],
        &[&option],
        &["simulate", "sessions/default.toml", HOSTILE],
        &["simulate", "sessions/default.toml", "--trials", HOSTILE],
        &["operate", "--gaze", HOSTILE],
        &["operate", "--listen", HOSTILE],
        &["replay", &option],
        &["completions", HOSTILE],
    ];
    for arguments in arguments {
        let told = check(arguments);
        assert!(told.contains(WRITTEN_OUT), "{arguments:?}: {told}");
    }
}

#[test]
fn recordings_are_told_with_control_characters_written_out() {
    let home = folder("escapes");
    let recording = recording(&home);
    let place = recording.display().to_string();
    assert!(check(&["replay", &place]).contains(&format!("marker: {WRITTEN_OUT}\n")));
    check(&["replay", &place, "--format", "json"]);
    assert!(check(&["replay", &place, "--verify"]).contains("\\u001b[2J"), "the line that differs");
    let codes = check(&["codes", &place, "--format", "json"]);
    let codes: serde_json::Value = serde_json::from_str(&codes).expect("JSON");
    assert_eq!(codes["recordings"][0]["recording"], HOSTILE, "in JSON no value changes");
    assert!(check(&["codes", &place]).starts_with(&format!("{WRITTEN_OUT}: ")));
    assert!(check(&["study", &place, "--out", &home.join(HOSTILE).display().to_string()]).contains(WRITTEN_OUT));
    assert!(check(&["exclude", &place, "--reason", "noise"]).contains(WRITTEN_OUT));
    assert!(check(&["forget", "S001", "--in", &home.display().to_string()]).contains(WRITTEN_OUT));
}

#[test]
fn errors_show_excerpts_and_names_with_control_characters_written_out() {
    let home = folder("escapes-in-errors");
    let recording = recording(&home);
    let log = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    fs::write(recording.join(LOG_NAME), log.replacen("\"kind\":\"marker\"", "\"kind\":\"\x1b[31mmarker\"", 1))
        .expect("written");
    let told = check(&["replay", &recording.display().to_string()]);
    assert!(told.contains("\\u001b[31mmarker") && told.contains(&format!("{WRITTEN_OUT}/{LOG_NAME}:")), "{told}");
    let layout = home.join("layout.toml");
    fs::write(&layout, format!("name = \"x\"\n{HOSTILE} = 1\n")).expect("written");
    assert!(check(&["kitchen", &layout.display().to_string()]).contains(WRITTEN_OUT));
    let table = home.join("codes.csv");
    fs::write(&table, format!("recording,rater,press,cause,aspect\nseed7-S001,{HOSTILE},1,slip,\n")).expect("written");
    fs::write(recording.join(LOG_NAME), log).expect("written");
    let told = check(&["codes", &recording.display().to_string(), "--import", &table.display().to_string()]);
    assert!(told.contains(WRITTEN_OUT), "{told}");
    assert!(check(&["replay", &home.join(format!("no{HOSTILE}")).display().to_string()]).contains(WRITTEN_OUT));
}
