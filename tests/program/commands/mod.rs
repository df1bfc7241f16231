//! The commands as they are typed: exit codes, what is on stdout, and what is said about wrong files.

mod doctor;
mod key_files;
mod recordings;
mod simulate;
mod wrong;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::tmux::TOMCOM;

/// Runs the program with these arguments and demands the exit code.
fn check(arguments: &[&str], code: i32) -> Output {
    let output = Command::new(TOMCOM).args(arguments).output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "tomcom {arguments:?}\n{told}");
    output
}

/// The one JSON object on stdout.
fn figures(arguments: &[&str], code: i32) -> Value {
    let output = check(arguments, code);
    serde_json::from_slice(&output.stdout).expect("one JSON object on stdout")
}

/// What is said on stderr about something wrong.
fn complaint(arguments: &[&str]) -> String {
    let output = check(arguments, 2);
    assert!(output.stdout.is_empty(), "{arguments:?} prints something although it is wrong");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("commands").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}
