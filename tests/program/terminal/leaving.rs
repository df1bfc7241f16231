//! The terminal is given back after signals and panics.

use std::fs;
use std::path::Path;
use std::process::Command;

use rustix::process::Signal;
use tomcom::run::terminal::TerminalScreen;

use crate::program::{folder, refused, tomcom, verified};
use crate::pseudo_terminal::Terminal;

#[test]
fn a_signal_to_the_program_closes_the_recording_and_gives_the_terminal_back() {
    for (name, signal) in [("TERM", Signal::TERM), ("INT", Signal::INT), ("HUP", Signal::HUP)] {
        let terminal = Terminal::open(&format!("signal-{name}"));
        terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "mouse"]);
        terminal.begin();
        terminal.signal(signal);
        terminal.is_whole(0);
        assert_eq!(terminal.count("session_ended"), 1);
        terminal.verifies();
    }
}

/// By hand and by a signal, without a plan: the list, `--continue` and the study agree about the recording.
#[test]
fn a_trial_that_was_left_ended_early_and_goes_on() {
    for (name, leave) in [
        ("by hand", Terminal::quit as fn(&Terminal)),
        ("by signal", |terminal| {
            terminal.signal(Signal::TERM);
            terminal.is_whole(0);
        }),
    ] {
        let terminal = Terminal::open(&format!("early-{}", name.replace(' ', "-")));
        terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "mouse"]);
        terminal.begin();
        leave(&terminal);
        assert_eq!(
            (terminal.listed("state"), terminal.listed("kind")),
            ("ended_early".into(), "trial".into()),
            "{name}"
        );
        refused(&["study", &terminal.recordings(), "--skip", "concepts"], "(ended early, before the trial's end)");
        let first = terminal.recording().display().to_string();
        terminal.run(&["operate", "--continue", &first]);
        terminal.see("PAUSED");
        terminal.key(".");
        terminal.see("RUNNING");
        terminal.key("C-e");
        terminal.see("End the trial?");
        terminal.key("y");
        terminal.see("close the session");
        terminal.quit();
        assert_eq!(terminal.listed("state"), "ended_by_wizard", "{name}");
        let second = format!("{first}-part2");
        verified(Path::new(&second));
        let again = tomcom(&["operate", "--continue", &second]);
        assert!(String::from_utf8_lossy(&again.stderr).contains("everything in this recording was done"), "{again:?}");
    }
}

#[test]
fn a_session_in_which_nothing_happened_leaves_no_recording() {
    let terminal = Terminal::open("empty");
    terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "mouse"]);
    // One step back from the first screen leaves, as it does everywhere.
    terminal.key("Escape");
    terminal.see("nothing is kept");
    terminal.key("y");
    terminal.is_whole(0);
    terminal.see("nothing was recorded: no trial was begun");
    assert_eq!(fs::read_dir(terminal.recordings()).expect("the folder of recordings").count(), 0);
    // Who is killed leaves one behind, and the list says what it is.
    terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "mouse"]);
    terminal.kill();
    assert_eq!(terminal.listed("state"), "empty");
}

#[test]
fn a_stopped_program_gives_the_terminal_back_and_draws_when_it_goes_on() {
    let terminal = Terminal::open("stopped");
    terminal.operate("default.toml", &["--participant", "keyboard", "--gaze", "mouse"]);
    terminal.begin();
    let is_stopped = || {
        let state = fs::read_to_string(format!("/proc/{}/stat", terminal.pid())).expect("it is there");
        state.rsplit(") ").next().is_some_and(|rest| rest.starts_with('T'))
    };
    terminal.signal(Signal::TSTP);
    terminal.wait("a stopped program", is_stopped);
    terminal.is_given_back();
    terminal.signal(Signal::CONT);
    terminal.see("PAUSED");
    assert_eq!(terminal.count("trial_paused"), 1, "nobody watches a stopped session");
    // Also a program that was stopped without being asked may find another one's words on its screen.
    terminal.signal(Signal::STOP);
    terminal.wait("a stopped program", is_stopped);
    terminal.writes_over("words of another program");
    terminal.signal(Signal::CONT);
    terminal.wait("a clean screen", || !terminal.screen().contains("words of another program"));
    terminal.key(".");
    terminal.see("RUNNING");
    terminal.quit();
    terminal.verifies();
}

#[test]
fn without_a_terminal_the_console_says_what_to_run_instead() {
    let output = tomcom(&["operate", "sessions/default.toml", "--out", &folder("no-terminal").display().to_string()]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("tomcom simulate sessions/default.toml"), "{told}");
}

/// Not a test by itself: what the next one runs in a terminal.
#[test]
#[ignore = "panics on purpose, inside of the terminal of another test"]
fn a_program_that_panics() {
    let _screen = TerminalScreen::take().expect("a terminal");
    panic!("on purpose");
}

#[test]
fn a_panic_gives_the_terminal_back_and_its_message_can_be_read() {
    let terminal = Terminal::open("panic");
    let this = std::env::current_exe().expect("a path");
    let panics = ["--ignored", "--exact", "terminal::leaving::a_program_that_panics", "--nocapture"];
    terminal.start(Command::new(this).args(panics));
    terminal.is_whole(101);
    terminal.see("on purpose");
}
