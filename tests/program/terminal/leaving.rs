//! The terminal is given back after signals and panics.

use std::process::Command;

use rustix::process::Signal;
use tomcom::run::terminal::TerminalScreen;

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
