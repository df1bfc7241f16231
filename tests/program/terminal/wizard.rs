//! A wizard's session by keys, its comparison with an assistant, and the training.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::kitchen;
use crate::program::{json, verified};
use crate::pseudo_terminal::Terminal;

/// A wizard's whole session: every key that concerns participant, robot or analysis, and its line in the log.
fn check_wizard(session: &str) {
    let terminal = Terminal::open(&format!("wizard-{session}"));
    let kitchen = kitchen(session);
    terminal.operate(session, &[]);
    terminal.begin();
    for location in &kitchen.locations {
        let Some(key) = location.signal_key.filter(|_| location.name != "human_hand") else { continue };
        // An order that was served has no recipe to show until the next one comes.
        let shown = format!("\":\"{}\"}}}}", location.name);
        terminal.insist(&key.to_string(), &shown, || terminal.count(&shown) > 0);
    }
    terminal.key_logs("Backspace", "taken_back");
    let shown = terminal.count("signal_shown");
    terminal.see("taken back");
    // Within the time after a signal in which none can be sent, a held key sends nothing at all.
    let time = |line: &str| serde_json::from_str::<Value>(line).ok()?["t_ns"].as_u64();
    terminal.wait("the end of the cool-down", || {
        let log = terminal.log();
        let signal = log.lines().rev().find(|line| line.contains("signal_shown")).and_then(time);
        log.lines().rev().find_map(time).zip(signal).is_some_and(|(now, signal)| now > signal + 600_000_000)
    });
    terminal.hold("a");
    terminal.wait("a held key", || terminal.count("signal_shown") > shown);
    terminal.key_logs("3", "\"marker\",\"note\":\"slip\"");
    terminal.key_logs("Space", "robot_stopped");
    terminal.see("EMERGENCY STOP");
    assert_eq!(terminal.count("signal_shown"), shown + 1, "a held key sends once");
    terminal.key_logs("C-r", "robot_resumed");
    terminal.key_logs(".", "trial_paused");
    terminal.see("PAUSED");
    terminal.key("0");
    terminal.see("Note");
    terminal.send("Asks for help");
    terminal.see("Asks for help");
    terminal.key_logs("Enter", "\"note\":\"Asks for help\"");
    terminal.key_logs(".", "trial_resumed");
    terminal.key("?");
    terminal.see("─ Keys ─");
    terminal.key("x");
    terminal.key("C-e");
    terminal.see("End the trial?");
    terminal.key_logs("y", "trial_ended");
    terminal.quit();
    assert_eq!(terminal.count("session_ended"), 1);
    assert_eq!(terminal.count("\"kind\":\"preflight\""), 1);
    for open in ["note", "help", "end_trial", "quit"] {
        let seen = "\"room\":\"medium\",\"panels\":[\"orders\",\"kitchen\",\"belief\",\"presses\",\"recommendation\"";
        let log = terminal.log();
        let mut lines = log.lines().filter(|line| line.contains(seen));
        assert!(lines.any(|line| line.contains(&format!("\"dialog\":\"{open}\""))), "{open}:\n{log}");
    }
    terminal.verifies();
}

#[test]
fn a_wizard_runs_a_session_in_the_sushi_kitchen() {
    check_wizard("default.toml");
}

#[test]
fn a_wizard_runs_a_session_in_the_burger_kitchen() {
    check_wizard("burger.toml");
}

#[test]
fn an_aborted_trial_is_done_again_in_a_recording_of_its_own() {
    let terminal = Terminal::open("again");
    terminal.operate("default.toml", &[]);
    let first = terminal.recording();
    terminal.begin();
    terminal.key_logs("C-p", "robot_held");
    terminal.see("HELD");
    // What a terminal reports when its window loses and regains the keyboard.
    for (report, event) in [("\x1b[O", "focus_lost"), ("\x1b[I", "focus_regained")] {
        terminal.send(report);
        terminal.wait(event, || terminal.count(event) == 1);
    }
    terminal.key("C-u");
    terminal.see("Correct the kitchen");
    terminal.key("Enter");
    terminal.see("What is really at human hand?");
    terminal.key("Escape");
    terminal.see("Correct the kitchen");
    terminal.key_logs("Space", "robot_stopped");
    terminal.key("Escape");
    terminal.wait("a closed list", || !terminal.screen().contains("Correct the kitchen"));
    terminal.key("C-x");
    terminal.see("Abort the trial: why?");
    terminal.key("Enter");
    terminal.see("enter without words gives the reason alone");
    terminal.key_logs("Enter", "\"trial_aborted\",\"reason\":\"participant stopped\"");
    terminal.see("^n repeat the trial");
    terminal.key("C-n");
    terminal.see("READY");
    let name = first.file_name().expect("a name").to_string_lossy().into_owned();
    let second = first.with_file_name(format!("{}-2", name.trim_end_matches("-1")));
    let log = |folder: &Path| fs::read_to_string(folder.join("events.jsonl")).expect("a log");
    assert!(log(&second).contains(&format!("\"redoes\":\"{name}\"")));
    assert!(log(&first).ends_with("\"session_ended\"}\n"), "the aborted recording is closed");
    terminal.begin();
    terminal.quit();
    let orders = |log: &str| -> Vec<String> {
        let shown = log.lines().filter(|line| line.contains("order_shown")).take(2);
        shown.filter_map(|line| Some(line.split_once("\"kind\"")?.1.to_string())).collect()
    };
    assert_eq!(orders(&log(&first)), orders(&log(&second)), "it is the same trial");
    [first, second].iter().for_each(|recording| drop(verified(recording)));
}

#[test]
fn wizard_and_assistant_are_compared_live_and_from_another_terminal() {
    let (terminal, beside) = (Terminal::open("compare"), Terminal::open("compare-follow"));
    terminal.run(&["compare", "sessions/default.toml", "--with", "tom", "--out", &terminal.recordings()]);
    terminal.see("READY");
    terminal.see("Signals of wizard and assistant compared");
    terminal.begin();
    // The other sees the same lanes, and writes nothing.
    beside.run(&["compare", &terminal.recording().display().to_string(), "--with", "tom", "--follow"]);
    beside.see("Signals of wizard and assistant compared");
    terminal.key_logs("q", "show_recipe");
    for one in [&terminal, &beside] {
        one.see("recall");
        one.see("wizard");
        one.see("tom-com");
    }
    // What may still be matched is no difference.
    terminal.see("o details");
    terminal.key("C-o");
    terminal.see("What wizard and assistant knew");
    terminal.key("x");
    terminal.wait("a closed dialog", || !terminal.screen().contains("What wizard and assistant knew"));
    beside.key("Escape");
    beside.is_whole(0);
    terminal.quit();
    assert_eq!(terminal.count("\"kind\":\"unblinded\",\"concepts\":[\"tom-com\",\"tom\"]"), 1);
    assert!(terminal.count("signal_drawn") > 0, "when a signal was seen");
    assert!(terminal.count("\"comparison\"") > 0, "the panel is among those that were seen");
    terminal.verifies();
}

#[test]
fn a_wizard_is_trained_with_feedback_and_a_score_and_held_against_oneself() {
    let terminal = Terminal::open("train");
    let (folder, out) = (terminal.folder.join("training"), terminal.folder.join("training").display().to_string());
    let mut met = Vec::new();
    for time in 1..=2 {
        let length = ["--speed", "1", "--seconds", "30"];
        terminal
            .run(&[&["train", "--wizard", "W7", "--hits", "0", "--wrong", "1", "--out", &out], &length[..]].concat());
        terminal.see("0 hit, 0 missed, 0 wrong");
        terminal.see("A hit is the first signal");
        terminal.key(".");
        terminal.see("the recording plays");
        // The orders come with the trial's first moment.
        terminal.see("0:01");
        for (key, signal) in
            [("q", "recipe of order 1:"), ("c", "highlight cutting board:"), ("p", "highlight cooking pot:")]
        {
            terminal.insist(key, "feedback", || terminal.screen().contains(signal));
        }
        terminal.see("The training is over");
        terminal.key("Enter");
        terminal.is_whole(0);
        terminal.see("recorded in");
        let record = fs::read_to_string(folder.join(format!("W7-{time}.json"))).expect("a record");
        let record: serde_json::Value = serde_json::from_str(&record).expect("a JSON object");
        let one = &record["recordings"][0];
        assert_eq!(one["complete"], true, "{record}");
        assert!(one["signals"].as_array().is_some_and(|signals| signals.len() >= 3), "{record}");
        assert!(one["signals"][0]["worth"].is_string());
        assert_eq!(one["beliefs"].as_array().map(|all| all.len() as u64), one["measures"]["episodes"].as_u64());
        assert_eq!(record["speed"], 1.0, "{record}");
        assert_eq!(one["kappa_with_oneself"].is_number(), time == 2, "{record}");
        met.push(record["met"].clone());
    }
    assert_eq!(met[0], met[1], "the criterion holds for the same signals");
    // The training belongs to the wizard's figures.
    let recording =
        fs::read_dir(folder.join("recordings/30s")).expect("a folder").flatten().next().expect("a recording");
    let recording = recording.path().display().to_string();
    let figures = json(&["compare", "--wizard", "W7", "--training", &out, &recording]);
    assert_eq!(figures["training"]["times"], 2, "{figures}");
}

#[test]
fn the_space_bar_stops_the_robot_whatever_came_before_and_pasted_text_is_no_keys() {
    let terminal = Terminal::open("space");
    terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "none"]);
    terminal.begin();
    let stop = |before: &str| {
        let stops = terminal.count("robot_stopped");
        // As of a terminal that reports no releases.
        terminal.send(&format!("{before} "));
        terminal.wait("a stop", || terminal.count("robot_stopped") > stops);
        terminal.key_logs("C-r", "robot_resumed");
    };
    // Alt with [ or O, and mouse reports and sequences that were cut.
    for before in ["\x1b[", "\x1bO", "\x1b[<", "\x1b[<35;12", "\x1b[1;", "\x1b[M", "\x1b]11;rgb:0", "\x1bP", "\x1b"] {
        stop(before);
    }
    let (stops, signals) = (terminal.count("robot_stopped"), terminal.count("signal_shown"));
    terminal.send("\x1b[200~please call me\x1b[201~");
    terminal.see("pasted text is not taken for keys");
    assert_eq!(
        (terminal.count("robot_stopped"), terminal.count("signal_shown")),
        (stops, signals),
        "{}",
        terminal.log()
    );
    // A paste without an end is given up, and then the next space counts.
    terminal.send("\x1b[200~call");
    terminal.see("a paste did not end");
    stop("");
    terminal.send("\x1b[200~please call");
    terminal.wait("its space counts, too", || terminal.count("robot_stopped") == stops + 2);
    terminal.quit();
    terminal.verifies();
}
