//! The terminal is given back after signals and panics.

use std::process::Command;

use serial_test::serial;
use tomcom::edge::terminal::TerminalScreen;

use crate::tmux::Terminal;

#[test]
#[serial]
fn a_signal_to_the_program_closes_the_recording_and_gives_the_terminal_back() {
    for signal in ["TERM", "INT", "HUP"] {
        let Some(terminal) = Terminal::open(&format!("signal-{signal}")) else { return };
        terminal.operate("default.toml", "--participant keyboard --gaze mouse");
        terminal.start();
        let pid = terminal.read("pid");
        let killed = Command::new("kill").args([&format!("-{signal}"), pid.trim()]).status().expect("kill runs");
        assert!(killed.success());
        terminal.is_whole("0");
        assert_eq!(terminal.count("session_ended"), 1);
        terminal.verifies();
    }
}

/// Not a test by itself: what the next one runs in a terminal.
#[test]
#[serial]
#[ignore = "panics on purpose, inside of the terminal of another test"]
fn a_program_that_panics() {
    let _screen = TerminalScreen::take().expect("a terminal");
    panic!("on purpose");
}

#[test]
#[serial]
fn a_panic_gives_the_terminal_back_and_its_message_can_be_read() {
    let Some(terminal) = Terminal::open("panic") else { return };
    let this = std::env::current_exe().expect("a path");
    terminal.run(&format!("{} --ignored --exact terminal::leaving::a_program_that_panics --nocapture", this.display()));
    terminal.is_whole("101");
    terminal.see("on purpose");
}
