//! A session watched from another terminal, and a recording coded by a rater.

use std::fs;

use super::kitchen;
use crate::program::done;
use crate::pseudo_terminal::Terminal;

#[test]
fn a_running_session_is_watched_from_another_terminal_and_looked_at_again() {
    let (terminal, other) = (Terminal::open("watched"), Terminal::open("watching"));
    terminal.operate("default.toml", &[]);
    terminal.begin();
    let recording = terminal.recording().display().to_string();
    other.run(&["replay", &recording, "--follow"]);
    other.see("RUNNING");
    other.see("live");
    terminal.key_logs("a", "signal_shown");
    other.see("highlight assembly board");
    terminal.quit();
    other.see("ENDED EARLY");
    other.key("Escape");
    other.is_whole(0);
    other.run(&["replay", &recording]);
    // It stands there until it is played.
    other.see("paused; . plays");
    other.see("paused 1x");
    assert!(!other.screen().contains("READY"), "a replay opens at the start of the trial: {}", other.screen());
    for (key, seen) in
        [(".", "play 1x"), ("+", "play 2x"), ("End", "ENDED EARLY"), ("Home", "before the trial, 0:00 of")]
    {
        other.key(key);
        other.see(seen);
    }
    other.key("Right");
    other.see("0:00 of");
    other.key("Escape");
    other.is_whole(0);
}

/// Presses keys, and waits for what the screen says after each.
fn press_each(terminal: &Terminal, keys: &[(&str, &str)]) {
    for (key, seen) in keys {
        terminal.key(key);
        terminal.see(seen);
    }
}

#[test]
fn a_rater_codes_errors_undoes_goes_on_another_time_and_settles_with_another_one() {
    let terminal = Terminal::open("rater");
    let out = terminal.recordings();
    done(&["simulate", "sessions/default.toml", "--seed", "7", "--condition", "assistant", "--out", &out]);
    let name = terminal.recording().display().to_string();
    terminal.run(&["replay", &name, "--rater", "R1"]);
    terminal.see("R1: 0/");
    terminal.see("error 1 is the first without a code");
    for telling in ["Beliefs", "assistant", "Recommendation", "On the participant's display"] {
        assert!(!terminal.screen().contains(telling), "{}", terminal.screen());
    }
    let kitchen = kitchen("default.toml");
    let place = kitchen.locations.iter().find(|location| location.name == "cooking_pot").expect("a pot");
    let letter = place.signal_key.expect("a key").to_string();
    let first = [
        ("9", "the key \"9\" does nothing here"),
        ("1", "saved: error 1, slip"),
        ("Enter", "coded, 1 since opening"),
        (&letter, "saved: error 2, wrong about cooking pot"),
        ("u", "saved: code of error 2 removed, was wrong about cooking pot"),
        ("C-y", "saved: error 2, wrong about cooking pot"),
        ("Down", "coded, 2 since opening"),
        ("3", "no code given: error 3 is only selected"),
        ("Enter", "coded, 2 since opening"),
        ("3", "saved: error 3, other cause"),
        ("2", "saved: error 3, race, was other cause"),
        ("Delete", "saved: code of error 3 removed, was race"),
        ("Backspace", "2 since opening"),
    ];
    press_each(&terminal, &first);
    terminal.key("C-c");
    terminal.is_whole(0);
    terminal.see("2 since opening; all codes are saved in");
    let kept = rows(&terminal, "codes-R1.csv");
    assert!(matches!(&kept[..], [a, b] if a.ends_with(",slip,") && b.ends_with(",belief,cooking_pot")), "{kept:?}");

    let film = terminal.folder.join("room.mp4").display().to_string();
    std::fs::write(&film, "a film").expect("written");
    done(&["video", "attach", &name, &film, "--at", "12"]);
    std::fs::remove_file(&film).expect("removed");
    terminal.run(&["replay", &name, "--rater", "R1"]);
    // Who codes without the film that there was has to know.
    terminal.see("the film of this recording is not shown");
    terminal.see("R1: 2/");
    terminal.see("error 3 is the first without a code");
    terminal.key("C-c");
    terminal.is_whole(0);

    settle_with_another(&terminal, &name, &kept);
}

/// The rows of a file with codes beside the recording.
fn rows(terminal: &Terminal, file: &str) -> Vec<String> {
    let text = fs::read_to_string(terminal.recording().join(file)).unwrap_or_default();
    text.lines().skip(1).map(str::to_string).collect()
}

/// The other rater codes the first error alike and the second otherwise; both settle the second.
fn settle_with_another(terminal: &Terminal, name: &str, kept: &[String]) {
    let (recording, log) = (terminal.recording(), terminal.log());
    let presses: Vec<&str> = kept.iter().filter_map(|row| row.split(',').nth(1)).collect();
    let codes = format!("rater,press,cause,aspect\nR2,{},slip,\nR2,{},race,\n", presses[0], presses[1]);
    fs::write(recording.join("codes-R2.csv"), codes).expect("written");
    terminal.run(&["replay", name, "--settle", "R2", "R1"]);
    terminal.see("error 2 is the first to be settled");
    terminal.see("R1: wrong about cooking pot");
    terminal.see("R2: race");
    let screen = terminal.screen();
    let bar = screen.lines().find_map(|line| line.trim_start().strip_prefix("recording ")).expect("the bar");
    assert!(bar.matches(['e', '✗']).count() <= 1, "only what they coded differently is marked: {bar}");
    let settled = [
        ("2", "code saved; all is settled"),
        ("u", "saved: code of error 2 removed"),
        ("C-y", "code saved; all is settled"),
    ];
    press_each(terminal, &settled);
    terminal.key("C-c");
    terminal.is_whole(0);
    let settled = rows(terminal, "consensus.csv");
    let agreed = format!("R1,slip,,R2,slip,,{},slip,", presses[0]);
    let decided = format!("R1,belief,cooking_pot,R2,race,,{},race,", presses[1]);
    assert_eq!(settled, [agreed, decided]);
    assert_eq!(rows(terminal, "codes-R1.csv"), kept, "a consensus leaves the raters' codes");
    assert_eq!(terminal.log(), log, "the log stays as it is");
    let told = done(&["codes", name]);
    assert!(told.contains("consensus of R1 and R2 on errors: 1 agreed, 1 settled"), "{told}");
    let told = done(&["review", name, "--errors"]);
    assert!(told.contains("; R1: wrong about cooking pot; R2: race; R1+R2: race\n"), "{told}");
    terminal.run(&["replay", name, "--settle", "R1", "R3"]);
    terminal.is_whole(2);
    terminal.see("no codes of the rater R3");
}

#[test]
fn a_recording_of_a_folder_is_chosen_from_a_list_by_typing() {
    let terminal = Terminal::open("chosen");
    let out = terminal.folder.join("recordings");
    for (name, golden) in [("P07-1", "hand"), ("S001", "simulated")] {
        fs::create_dir_all(out.join(name)).expect("a folder");
        let golden = format!("tests/golden/format-3-{golden}.jsonl");
        fs::copy(golden, out.join(name).join("events.jsonl")).expect("a recording");
    }
    terminal.run(&["replay", &terminal.recordings()]);
    terminal.see("Which recording of");
    terminal.see("2 of 2");
    terminal.key("Space");
    terminal.send("s001");
    terminal.see("s001_");
    terminal.see("1 of 2");
    terminal.key("Enter");
    terminal.see("paused 1x");
    terminal.key("Escape");
    terminal.is_whole(0);
    terminal.run(&["replay", &terminal.recordings(), "--verify"]);
    terminal.see("Which recording of");
    terminal.key("Escape");
    terminal.is_whole(0);
}
