//! A terminal that nobody reads any more (a suspended multiplexer, a dead connection) keeps the program neither from closing
//! the recording nor from ending. Without Python the tests say that they were skipped.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use serial_test::serial;

use crate::tmux::{TOMCOM, tomcom};

/// A folder of its own, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stuck").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Runs a script in Python with this argument; what it prints, or `None` without Python.
fn python(name: &str, script: &str, asked: &Value) -> Option<Value> {
    let python = std::env::var("TOMCOM_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let Ok(output) = Command::new(python).args([script, &asked.to_string()]).output() else {
        eprintln!("skipped: {name} needs Python");
        return None;
    };
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    Some(serde_json::from_slice(&output.stdout).expect("JSON"))
}

/// How often the program is asked to end before it counts as stuck: on a machine so busy that closing a recording takes longer
/// than two seconds, it is ended by its own limit, with exit code 1.
const ATTEMPTS: usize = 5;

/// Runs the program in a terminal until this is on the screen, reads no further, and asks it to end by these keys and
/// signals. It must end by itself, and leave the terminal as it should be. `begin` comes before every attempt.
fn check(name: &str, arguments: &[&str], see: &str, ask: &Value, begin: impl Fn()) -> Option<()> {
    let command: Vec<&str> = std::iter::once(TOMCOM).chain(arguments.iter().copied()).collect();
    let mut asked = json!({ "command": command, "see": see });
    for (key, value) in ask.as_object().expect("keys or signals") {
        asked[key] = value.clone();
    }
    let mut end = Value::Null;
    for _ in 0..ATTEMPTS {
        begin();
        end = python(name, "tests/program/unread.py", &asked)?;
        println!("{name}: ended after {:.2} s", end["seconds"].as_f64().unwrap_or(f64::NAN));
        if end["exit"] != 1 {
            break;
        }
    }
    // 0: on the way out that it takes in every terminal, not because its time was over.
    assert_eq!(end["exit"], 0, "{name}: {end}");
    assert_eq!(end["whole"], true, "{name}: {end}");
    Some(())
}

/// The only recording in a folder is closed, and verifies.
fn check_closed(name: &str, out: &Path) {
    let recordings: Vec<PathBuf> = fs::read_dir(out).expect("recordings").flatten().map(|entry| entry.path()).collect();
    let [recording] = &recordings[..] else { panic!("{name}: {recordings:?}") };
    let told = tomcom(&["replay", &recording.display().to_string(), "--verify", "--format", "json"]);
    let found: Value = serde_json::from_slice(&told.stdout).unwrap_or_else(|_| panic!("{name}: {told:?}"));
    assert_eq!((&found["verified"], &found["cut"]), (&json!(true), &json!(false)), "{name}: {found}");
    assert!(!recording.join("lock").exists(), "{name}: the lock is given back");
}

/// A session at the console; its recording is closed, and verifies.
fn check_session(name: &str, command: &str, ask: &Value) {
    let out = folder(name).join("recordings");
    let place = out.display().to_string();
    let arguments = [command, "sessions/default.toml", "--participant", "keyboard", "--gaze", "none", "--out", &place];
    let begin = || drop(folder(name));
    if check(name, &arguments, "READY", ask, begin).is_none() {
        return;
    }
    check_closed(name, &out);
}

#[test]
#[serial]
fn a_session_whose_console_fails_is_closed() {
    let out = folder("hung-up").join("recordings");
    let place = out.display().to_string();
    let command =
        [TOMCOM, "operate", "sessions/default.toml", "--participant", "keyboard", "--gaze", "none", "--out", &place];
    let asked = json!({ "command": command, "see": "READY" });
    let Some(end) = python("hung-up", "tests/program/hung_up.py", &asked) else { return };
    assert_eq!(end["exit"], 1, "{end}");
    assert!(end["told"].as_str().is_some_and(|told| told.contains("terminal")), "{end}");
    check_closed("hung-up", &out);
}

#[test]
#[serial]
fn a_session_ends_by_a_signal_when_nobody_reads_its_terminal() {
    for signal in ["TERM", "HUP", "INT"] {
        check_session(&format!("session-{signal}"), "operate", &json!({ "signals": [signal] }));
    }
}

#[test]
#[serial]
fn a_second_signal_changes_nothing() {
    check_session("session-twice", "operate", &json!({ "signals": ["TERM", "TERM", "HUP"] }));
}

#[test]
#[serial]
fn a_session_ends_by_its_keys_when_nobody_reads_its_terminal() {
    check_session("session-keys", "operate", &json!({ "keys": ["\u{3}", "y"] }));
}

#[test]
#[serial]
fn a_comparison_ends_when_nobody_reads_its_terminal() {
    check_session("compare", "compare", &json!({ "signals": ["TERM"] }));
}

#[test]
#[serial]
fn a_replay_and_a_training_end_when_nobody_reads_their_terminal() {
    let home = folder("replay");
    let place = home.display().to_string();
    let simulated = tomcom(&["simulate", "sessions/default.toml", "--seed", "7", "--arm", "timed", "--out", &place]);
    assert!(simulated.status.success(), "{simulated:?}");
    let recording = home.join("seed7-S001").display().to_string();
    let begin = || ();
    check("replay", &["replay", &recording], "play 1x", &json!({ "signals": ["TERM"] }), begin);
    check("replay-keys", &["replay", &recording], "play 1x", &json!({ "keys": ["q"] }), begin);
    let out = home.join("training").display().to_string();
    let arguments = ["train", &recording, "--wizard", "W7", "--out", &out];
    check("train", &arguments, "A hit is the first signal", &json!({ "signals": ["TERM"] }), begin);
}
