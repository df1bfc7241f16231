//! The commands as they are typed: exit codes, what is on stdout, and what is said about wrong files.

mod doctor;
mod lab;
mod recordings;
mod simulate;
mod video;
mod wrong;

use std::process::Output;

use serde_json::Value;

use crate::program::tomcom;

/// Runs the program with these arguments and demands the exit code.
fn check(arguments: &[&str], code: i32) -> Output {
    let output = tomcom(arguments);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "tomcom {arguments:?}\n{told}");
    output
}

/// The one JSON object of a command whose check fails, which the exit code 1 says.
fn failed(arguments: &[&str]) -> Value {
    let output = check(&[arguments, &["--format", "json"]].concat(), 1);
    serde_json::from_slice(&output.stdout).expect("one JSON object on stdout")
}

/// What is said on stderr about something wrong.
fn complaint(arguments: &[&str]) -> String {
    let output = check(arguments, 2);
    assert!(output.stdout.is_empty(), "{arguments:?} prints something although it is wrong");
    String::from_utf8_lossy(&output.stderr).into_owned()
}
