//! An external mind as a child process, which ends with the session.

use std::io::{BufRead, BufReader, Read};
use std::process::{ChildStderr, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use tomcom_session::external::MindConnection;

use super::lines::{LineReceiver, LineSender};
use crate::child_process::ChildProcess;
use crate::lock;

/// Time in which a child ends by itself after it was told that the trial is over.
const ENDS_WITHIN: Duration = Duration::from_secs(1);
/// Time in which the reason of a child's end is found out.
const EXPLAINED_WITHIN: Duration = Duration::from_millis(500);
const STEP: Duration = Duration::from_millis(5);
/// Longest line of a child's error output that is told, in bytes.
const LONGEST_WORDS: u64 = 2048;

pub(super) fn start(command: &str) -> Result<MindConnection, String> {
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // Python would keep its lines back until it has many of them.
    shell.env("PYTHONUNBUFFERED", "1");
    let mut process = ChildProcess::start(&mut shell).map_err(|error| format!("sh -c '{command}': {error}"))?;
    let child = process.child();
    let (Some(stdin), Some(stdout), Some(stderr)) = (child.stdin.take(), child.stdout.take(), child.stderr.take())
    else {
        return Err("it has no pipes".to_string());
    };
    // The child ends with the way to it: why it ended is looked up only while it is there.
    let child = Arc::new(Mutex::new(Some(process)));
    let words = last_words(stderr);
    let ended = child.clone();
    let from = LineReceiver::start(stdout, move || explained(&ended, &words));
    let to = LineSender::start(stdin, move || {
        let child = lock(&child).take();
        if let Some(mut child) = child {
            child.ends_within(ENDS_WITHIN);
        }
    });
    Ok(MindConnection { to: Box::new(to), from: Box::new(from) })
}

/// The last line of a child's error output, once that output has ended.
fn last_words(stderr: ChildStderr) -> Receiver<String> {
    let (sender, words) = channel();
    thread::spawn(move || {
        let mut stderr = BufReader::new(stderr);
        let mut last = String::new();
        loop {
            let mut line = Vec::new();
            match stderr.by_ref().take(LONGEST_WORDS).read_until(b'\n', &mut line) {
                Ok(0) | Err(_) => break,
                Ok(_) => {
                    let line = String::from_utf8_lossy(&line);
                    if !line.trim().is_empty() {
                        last = line.trim().to_string();
                    }
                }
            }
        }
        let _ = sender.send(last);
    });
    words
}

/// Why a child that closed its output has ended: its exit code, and the last line of its error output.
fn explained(child: &Mutex<Option<ChildProcess>>, words: &Receiver<String>) -> String {
    let mut waited = Duration::ZERO;
    let status = loop {
        // The lock is not held for long: whoever ends the session needs it.
        let mut child = lock(child);
        let status = child.as_mut().and_then(|child| child.child().try_wait().ok()).flatten();
        if status.is_some() || child.is_none() || waited >= EXPLAINED_WITHIN {
            break status;
        }
        drop(child);
        thread::sleep(STEP);
        waited += STEP;
    };
    let how = match status.map(|status| status.code()) {
        Some(Some(code)) => format!("exit code {code}"),
        Some(None) => "it was killed".to_string(),
        None => "it closed its output".to_string(),
    };
    match words.recv_timeout(EXPLAINED_WITHIN) {
        Ok(last) if !last.is_empty() => format!("{how}: {last}"),
        _ => how,
    }
}
