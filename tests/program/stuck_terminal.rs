//! A terminal that nobody reads any more (a suspended multiplexer, a dead connection) keeps the program neither from closing
//! the recording nor from ending.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use rustix::process::Signal;

use crate::program::{TOMCOM, done, end, verified};
use crate::pseudo_terminal::{Terminal, own_session};

/// How often the program is asked to end before it counts as stuck: on a machine so busy that closing a recording takes longer
/// than two seconds, it is ended by its own limit, with exit code 1.
const ATTEMPTS: usize = 6;

/// Runs the program until it is so far, reads no further, and asks it to end. It must end by itself, and leave the
/// terminal as it should be.
fn check(terminal: &Terminal, arguments: &[&str], is_so_far: impl Fn(&Terminal), ask: impl Fn(&Terminal)) {
    let attempt = |_| {
        let _ = fs::remove_dir_all(terminal.recordings());
        terminal.run(arguments);
        is_so_far(terminal);
        terminal.unread(|| {
            ask(terminal);
            terminal.end() != Some(1)
        })
    };
    (0..ATTEMPTS).any(attempt);
    // On the way out that it takes in every terminal, not because its time was over.
    terminal.is_whole(0);
}

/// The only recording in a folder is closed, and verifies.
fn check_closed(out: &str) {
    let recordings: Vec<PathBuf> = fs::read_dir(out).expect("recordings").flatten().map(|entry| entry.path()).collect();
    let [recording] = &recordings[..] else { panic!("{recordings:?}") };
    assert_eq!(verified(recording)["cut"], false);
    assert!(!recording.join("lock").exists(), "the lock is given back");
}

/// A session at the console; its recording is closed, and verifies.
fn check_session(name: &str, command: &str, ask: impl Fn(&Terminal)) {
    let terminal = Terminal::open(&format!("stuck-{name}"));
    let out = terminal.recordings();
    let arguments = [command, "sessions/default.toml", "--participant", "keyboard", "--gaze", "none", "--out", &out];
    // A note: a session in which nothing happened leaves no recording.
    let is_so_far = |terminal: &Terminal| {
        terminal.see("READY");
        terminal.key_logs("1", "\"kind\":\"marker\"");
    };
    check(&terminal, &arguments, is_so_far, ask);
    check_closed(&out);
}

/// Input and output are two terminals, of which the second is closed: the program cannot find out how large it is, so its next
/// frame fails.
#[test]
fn a_session_whose_console_fails_is_closed() {
    let (keys, screen) = (Terminal::open("hung-up-keys"), Terminal::open("hung-up-screen"));
    let out = keys.recordings();
    let mut command = Command::new(TOMCOM);
    command.args(["operate", "sessions/default.toml", "--participant", "keyboard", "--gaze", "none", "--out", &out]);
    command.stdin(keys.line()).stdout(screen.line()).stderr(Stdio::piped()).env("TERM", "xterm-256color");
    // Without a terminal that controls it, the program asks its output; without PATH it finds no other program to ask.
    own_session(command.env("PATH", "/nonexistent"), false);
    let program = command.spawn().expect("it starts");
    drop(command);
    screen.see("READY");
    // The rest of the frame: where its writing fails, the program takes the terminal for closed, and draws no other.
    let (mut last, mut unchanged) = (String::new(), 0);
    screen.wait("a whole frame", || {
        let now = screen.screen();
        unchanged = if now == last { unchanged + 1 } else { 0 };
        last = now;
        unchanged > 5
    });
    keys.key_logs("1", "\"kind\":\"marker\"");
    drop(screen);
    let output = end("a session", program);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && told.contains("terminal"), "{output:?}");
    check_closed(&out);
}

#[test]
fn a_session_ends_by_a_signal_when_nobody_reads_its_terminal() {
    for (name, signal) in [("TERM", Signal::TERM), ("HUP", Signal::HUP), ("INT", Signal::INT)] {
        check_session(name, "operate", |terminal| terminal.signal(signal));
    }
}

#[test]
fn a_second_signal_changes_nothing() {
    check_session("twice", "operate", |terminal| {
        [Signal::TERM, Signal::TERM, Signal::HUP].into_iter().for_each(|signal| terminal.signal(signal));
    });
}

#[test]
fn a_session_ends_by_its_keys_when_nobody_reads_its_terminal() {
    check_session("keys", "operate", |terminal| ["C-c", "y"].into_iter().for_each(|key| terminal.key(key)));
}

#[test]
fn a_comparison_ends_when_nobody_reads_its_terminal() {
    check_session("compare", "compare", |terminal| terminal.signal(Signal::TERM));
}

#[test]
fn a_replay_and_a_training_end_when_nobody_reads_their_terminal() {
    let terminal = Terminal::open("stuck-replay");
    let home = terminal.folder.display().to_string();
    done(&["simulate", "sessions/default.toml", "--seed", "7", "--arm", "timed", "--out", &home]);
    let (recording, out) = (format!("{home}/seed7-S001"), format!("{home}/training"));
    check(
        &terminal,
        &["replay", &recording],
        |terminal| terminal.see("paused 1x"),
        |terminal| terminal.signal(Signal::TERM),
    );
    check(&terminal, &["replay", &recording], |terminal| terminal.see("paused 1x"), |terminal| terminal.key("Escape"));
    let training = ["train", &recording, "--wizard", "W7", "--out", &out];
    check(
        &terminal,
        &training,
        |terminal| terminal.see("A hit is the first signal"),
        |terminal| terminal.signal(Signal::TERM),
    );
}
