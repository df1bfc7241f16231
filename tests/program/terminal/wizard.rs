//! A wizard's session by keys, its comparison with an assistant, and the training.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use serial_test::serial;

use super::kitchen;
use crate::tmux::{self, TOMCOM, Terminal};

/// A wizard's whole session: every key that concerns participant, robot or analysis, and its line in the log.
fn check_wizard(session: &str) {
    let Some(terminal) = Terminal::open(&format!("wizard-{session}")) else { return };
    let kitchen = kitchen(session);
    terminal.operate(session, "");
    terminal.start();
    terminal.see("RUNNING");
    for location in &kitchen.locations {
        let Some(key) = location.signal_key.filter(|_| location.name != "human_hand") else { continue };
        // An order that was served has no recipe to show until the next one comes.
        let shown = format!("\":\"{}\"}}}}", location.name);
        terminal.wait(&shown, || {
            terminal.key(&key.to_string());
            std::thread::sleep(Duration::from_millis(800));
            terminal.count(&shown) > 0
        });
    }
    let shown = terminal.count("signal_shown");
    terminal.key_logs("BSpace", "taken_back");
    terminal.see("taken back");
    // As fast as a terminal repeats a held key, however busy the machine is.
    terminal.tmux(&["send-keys", "-l", &"a".repeat(20)]);
    terminal.wait("a held key", || terminal.count("signal_shown") > shown);
    terminal.key_logs("3", "\"marker\",\"note\":\"slip\"");
    terminal.key_logs("Space", "robot_stopped");
    terminal.see("EMERGENCY STOP");
    assert_eq!(terminal.count("signal_shown"), shown + 1, "a held key sends once");
    terminal.key_logs("C-r", "robot_resumed");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key_logs(".", "trial_paused");
    terminal.see("PAUSED");
    terminal.key("0");
    terminal.see("Note");
    terminal.tmux(&["send-keys", "-l", "Asks for help"]);
    terminal.see("Asks for help");
    terminal.key_logs("Enter", "\"note\":\"Asks for help\"");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key_logs(".", "trial_resumed");
    terminal.key("?");
    terminal.see("─ Keys ─");
    terminal.key("x");
    std::thread::sleep(Duration::from_millis(800));
    terminal.key("C-e");
    terminal.see("End the trial?");
    terminal.key_logs("y", "trial_ended");
    terminal.quit();
    assert_eq!(terminal.count("session_ended"), 1);
    assert_eq!(terminal.count("\"kind\":\"preflight\""), 1);
    for open in ["note", "help", "end_trial", "quit"] {
        let seen = "\"room\":\"medium\",\"panels\":[\"kitchen\",\"belief\",\"recommendation\"";
        let log = terminal.log();
        let mut lines = log.lines().filter(|line| line.contains(seen));
        assert!(lines.any(|line| line.contains(&format!("\"dialog\":\"{open}\""))), "{open}:\n{log}");
    }
    terminal.verifies();
}

#[test]
#[serial]
fn a_wizard_runs_a_session_in_the_sushi_kitchen() {
    check_wizard("default.toml");
}

#[test]
#[serial]
fn a_wizard_runs_a_session_in_the_burger_kitchen() {
    check_wizard("burger.toml");
}

#[test]
#[serial]
fn an_aborted_trial_is_done_again_in_a_recording_of_its_own() {
    let Some(terminal) = Terminal::open("again") else { return };
    terminal.operate("default.toml", "");
    let first = terminal.recording();
    terminal.start();
    terminal.key_logs("C-p", "robot_held");
    terminal.see("HELD");
    // What a terminal reports when its window loses and regains the keyboard.
    for (report, event) in [("\x1b[O", "focus_lost"), ("\x1b[I", "focus_regained")] {
        terminal.tmux(&["send-keys", "-l", report]);
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
    terminal.key_logs("Enter", "\"trial_aborted\",\"reason\":\"participant stopped\"");
    terminal.see("^n repeat the trial");
    terminal.key("C-n");
    terminal.see("READY");
    let name = first.file_name().expect("a name").to_string_lossy().into_owned();
    let second = first.with_file_name(format!("{}-2", name.trim_end_matches("-1")));
    let log = |folder: &Path| fs::read_to_string(folder.join("events.jsonl")).expect("a log");
    assert!(log(&second).contains(&format!("\"redoes\":\"{name}\"")));
    assert!(log(&first).ends_with("\"session_ended\"}\n"), "the aborted recording is closed");
    terminal.start();
    terminal.see("RUNNING");
    terminal.quit();
    let orders = |log: &str| -> Vec<String> {
        let shown = log.lines().filter(|line| line.contains("order_shown")).take(2);
        shown.filter_map(|line| Some(line.split_once("\"kind\"")?.1.to_string())).collect()
    };
    assert_eq!(orders(&log(&first)), orders(&log(&second)), "it is the same trial");
    for recording in [&first, &second] {
        let output = tmux::tomcom(&["replay", &recording.display().to_string(), "--verify"]);
        assert!(output.status.success(), "{output:?}");
    }
}

#[test]
#[serial]
fn wizard_and_assistant_are_compared_live_and_from_another_terminal() {
    let Some(terminal) = Terminal::open("compare") else { return };
    let Some(beside) = Terminal::open("compare-follow") else { return };
    let (root, out) = (env!("CARGO_MANIFEST_DIR"), terminal.folder.display());
    terminal.run(&format!("{TOMCOM} compare {root}/sessions/default.toml --with tom --out {out}/recordings"));
    terminal.see("READY");
    terminal.see("Signals of wizard and assistant compared");
    terminal.start();
    // The other sees the same lanes, and writes nothing.
    beside.run(&format!("{TOMCOM} compare {} --with tom --follow", terminal.recording().display()));
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
    beside.key("q");
    beside.is_whole("0");
    terminal.quit();
    assert_eq!(terminal.count("\"kind\":\"unblinded\",\"concepts\":[\"tom-com\",\"tom\"]"), 1);
    assert!(terminal.count("signal_drawn") > 0, "when a signal was seen");
    assert!(terminal.count("\"comparison\"") > 0, "the panel is among those that were seen");
    terminal.verifies();
}

#[test]
#[serial]
fn a_wizard_is_trained_with_feedback_and_a_score_and_held_against_oneself() {
    let Some(terminal) = Terminal::open("train") else { return };
    let out = terminal.folder.join("training");
    let mut met = Vec::new();
    for time in 1..=2 {
        terminal.run(&format!(
            "{TOMCOM} train --wizard W7 --speed 1 --seconds 30 --hits 0 --wrong 1 --out {}",
            out.display()
        ));
        terminal.see("0 hit, 0 missed, 0 wrong");
        terminal.see("A hit is the first signal");
        terminal.key(".");
        terminal.see("the recording plays");
        // The orders come with the trial's first moment.
        terminal.see("0:01");
        for key in ["q", "c", "p"] {
            terminal.key(key);
            terminal.wait("feedback", || {
                let screen = terminal.screen();
                ["hit:", "already", "wrong,", "late:", "wrong:"].iter().any(|word| screen.contains(word))
            });
            std::thread::sleep(Duration::from_millis(900));
        }
        terminal.see("The training is over");
        terminal.key("Enter");
        terminal.is_whole("0");
        terminal.see("recorded in");
        let record = fs::read_to_string(out.join(format!("W7-{time}.json"))).expect("a record");
        let record: serde_json::Value = serde_json::from_str(&record).expect("a JSON object");
        let one = &record["recordings"][0];
        assert_eq!(one["complete"], true, "{record}");
        assert_eq!(one["signals"].as_array().map(Vec::len), Some(3));
        assert!(one["signals"][0]["worth"].is_string());
        assert_eq!(one["beliefs"].as_array().map(|all| all.len() as u64), one["measures"]["episodes"].as_u64());
        assert_eq!(record["speed"], 1.0, "{record}");
        assert_eq!(one["kappa_with_oneself"].is_number(), time == 2, "{record}");
        met.push(record["met"].clone());
    }
    assert_eq!(met[0], met[1], "the criterion holds for the same signals");
    // The training belongs to the wizard's figures.
    let recording =
        fs::read_dir(out.join("recordings/30s")).expect("a folder").next().expect("a recording").expect("readable");
    let arguments = ["compare", "--wizard", "W7", "--format", "json", "--training"].map(str::to_string);
    let folders = [&out, &recording.path()].map(|path| path.display().to_string());
    let output = Command::new(TOMCOM).args(arguments).args(folders).output().expect("tomcom runs");
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a JSON object");
    assert_eq!(figures["training"]["times"], 2, "{figures}");
}

#[test]
#[serial]
fn the_space_bar_stops_the_robot_whatever_came_before_and_pasted_text_is_no_keys() {
    let Some(terminal) = Terminal::open("space") else { return };
    terminal.operate("default.toml", "--participant keyboard --gaze none");
    terminal.start();
    let stop = |before: &str| {
        if !before.is_empty() {
            terminal.tmux(&["send-keys", "-l", before]);
        }
        terminal.key_logs("Space", "robot_stopped");
        terminal.key_logs("C-r", "robot_resumed");
    };
    // Alt with [ or O, and mouse reports and sequences that were cut.
    for before in ["\x1b[", "\x1bO", "\x1b[<", "\x1b[<35;12", "\x1b[1;", "\x1b[M", "\x1b]11;rgb:0", "\x1bP", "\x1b"] {
        stop(before);
    }
    let (stops, signals) = (terminal.count("robot_stopped"), terminal.count("signal_shown"));
    terminal.tmux(&["set-buffer", "please call me"]);
    terminal.tmux(&["paste-buffer", "-p"]);
    terminal.see("pasted text is not taken for keys");
    assert_eq!(
        (terminal.count("robot_stopped"), terminal.count("signal_shown")),
        (stops, signals),
        "{}",
        terminal.log()
    );
    // A paste without an end is given up, and then the next space counts.
    terminal.tmux(&["send-keys", "-l", "\x1b[200~call"]);
    terminal.see("a paste did not end");
    stop("");
    terminal.tmux(&["send-keys", "-l", "\x1b[200~please call"]);
    terminal.wait("its space counts, too", || terminal.count("robot_stopped") == stops + 2);
    terminal.quit();
    terminal.verifies();
}
