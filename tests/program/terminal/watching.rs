//! A session watched from another terminal, and a recording coded by a rater.

use std::fs;
use std::time::Duration;

use serial_test::serial;

use super::kitchen;
use crate::tmux::{self, TOMCOM, Terminal};

#[test]
#[serial]
fn a_running_session_is_watched_from_another_terminal_and_looked_at_again() {
    let Some(terminal) = Terminal::open("watched") else { return };
    let Some(other) = Terminal::open("watching") else { return };
    terminal.operate("default.toml", "");
    terminal.start();
    let recording = terminal.recording();
    other.run(&format!("{TOMCOM} replay {} --follow", recording.display()));
    other.see("RUNNING");
    other.see("live");
    terminal.key_logs("a", "signal_shown");
    other.see("highlight assembly board");
    terminal.quit();
    other.see("CLOSED");
    other.key("q");
    other.is_whole("0");
    other.run(&format!("{TOMCOM} replay {}", recording.display()));
    other.see("play 1x");
    for (key, seen) in [("+", "play 2x"), (".", "paused 2x"), ("End", "CLOSED"), ("Home", "event 0/")] {
        other.key(key);
        other.see(seen);
    }
    other.key("Right");
    other.see("event 1/");
    other.key("q");
    other.is_whole("0");
}

#[test]
#[serial]
fn a_rater_codes_errors_by_keys_and_sees_no_estimate() {
    let Some(terminal) = Terminal::open("rater") else { return };
    let out = terminal.folder.join("recordings");
    let simulated =
        tmux::tomcom(&["simulate", "sessions/default.toml", "--seed", "7", "--out", &out.display().to_string()]);
    assert!(simulated.status.success(), "{simulated:?}");
    let recording = terminal.recording();
    let log = terminal.log();
    let codes = recording.join("codes-R1.csv");
    let rows =
        || fs::read_to_string(&codes).unwrap_or_default().lines().skip(1).map(str::to_string).collect::<Vec<_>>();
    terminal.run(&format!("{TOMCOM} replay {} --rater R1", recording.display()));
    terminal.see("R1, before the first of");
    assert!(!terminal.screen().contains("Belief"), "{}", terminal.screen());
    let kitchen = kitchen("default.toml");
    let place = kitchen.locations.iter().find(|location| location.name == "cooking_pot").expect("a pot");
    let letter = place.signal_key.expect("a key").to_string();
    for (key, seen) in [
        ("9", "\"9\" has no meaning"),
        ("1", "no error yet"),
        ("Enter", "R1, error 1 of"),
        ("1", "slip (1 coded)"),
        ("Enter", "R1, error 2 of"),
        (&letter, "wrong about cooking pot (2 coded)"),
        ("Enter", "R1, error 3 of"),
        ("3", "other (3 coded)"),
        ("DC", " effect: not coded (2 coded)"),
        ("BSpace", "R1, error 2 of"),
    ] {
        terminal.key(key);
        terminal.see(seen);
        std::thread::sleep(Duration::from_millis(800));
    }
    terminal.key("C-c");
    terminal.is_whole("0");
    let kept = rows();
    assert!(matches!(&kept[..], [a, b] if a.ends_with(",slip,") && b.ends_with(",belief,cooking_pot")), "{kept:?}");
    assert_eq!(terminal.log(), log, "the log stays as it is");
    terminal.run(&format!("{TOMCOM} replay {} --rater R1", recording.display()));
    terminal.see("(2 coded)");
    terminal.key("C-c");
    terminal.is_whole("0");
}

#[test]
#[serial]
fn a_recording_of_a_folder_is_chosen_from_a_list_by_typing() {
    let Some(terminal) = Terminal::open("chosen") else { return };
    let out = terminal.folder.join("recordings");
    for (name, golden) in [("P07-1", "hand"), ("S001", "simulated")] {
        fs::create_dir_all(out.join(name)).expect("a folder");
        let golden = format!("tests/golden/format-1-{golden}.jsonl");
        fs::copy(golden, out.join(name).join("events.jsonl")).expect("a recording");
    }
    terminal.run(&format!("{TOMCOM} replay {}", out.display()));
    terminal.see("Which recording of");
    terminal.see("2 of 2");
    terminal.key("Space");
    for key in ["s", "0", "0", "1"] {
        terminal.key(key);
    }
    terminal.see("s001_");
    terminal.see("1 of 2");
    terminal.key("Enter");
    terminal.see("play 1x");
    terminal.key("q");
    terminal.is_whole("0");
    terminal.run(&format!("{TOMCOM} replay {} --verify", out.display()));
    terminal.see("Which recording of");
    terminal.key("Escape");
    terminal.is_whole("0");
}
