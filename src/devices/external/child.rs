//! An external mind as a child process, in a process group of its own, which ends with the session.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use tomcom_session::external::{MindConnection, MindWriter};

use super::lines::{LineReceiver, LineSender};

/// Time in which a child ends by itself after it was told that the trial is over.
const ENDS_WITHIN: Duration = Duration::from_secs(1);
/// Time in which the reason of a child's end is found out.
const EXPLAINED_WITHIN: Duration = Duration::from_millis(500);
const STEP: Duration = Duration::from_millis(5);
/// Longest line of a child's error output that is told, in bytes.
const LONGEST_WORDS: u64 = 2048;

/// The way to a child, which is ended with it.
#[derive(Debug)]
struct ChildWriter {
    lines: LineSender,
    child: Arc<Mutex<Child>>,
}

impl MindWriter for ChildWriter {
    fn send(&mut self, line: String) -> Result<(), String> {
        self.lines.send(line)
    }
}

impl Drop for ChildWriter {
    fn drop(&mut self) {
        self.lines.close();
        let mut child = self.child.lock().unwrap_or_else(PoisonError::into_inner);
        wait_for_end(&child, ENDS_WITHIN);
        // Also what the child started, and before the child is forgotten: its number can then be another's.
        kill_group(&mut child);
        let _ = child.wait();
    }
}

pub(super) fn start(command: &str) -> Result<MindConnection, String> {
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // Python would keep its lines back until it has many of them.
    shell.env("PYTHONUNBUFFERED", "1");
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut shell, 0);
    let mut child = shell.spawn().map_err(|error| format!("sh -c '{command}': {error}"))?;
    let (Some(stdin), Some(stdout), Some(stderr)) = (child.stdin.take(), child.stdout.take(), child.stderr.take())
    else {
        return Err("it has no pipes".to_string());
    };
    let child = Arc::new(Mutex::new(child));
    let words = last_words(stderr);
    let ended = child.clone();
    let why = move || explained(&ended, &words);
    let from = LineReceiver::start(stdout, why);
    Ok(MindConnection { to: Box::new(ChildWriter { lines: LineSender::start(stdin), child }), from: Box::new(from) })
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
fn explained(child: &Mutex<Child>, words: &Receiver<String>) -> String {
    let mut waited = Duration::ZERO;
    let code = loop {
        // The lock is not held for long: whoever ends the session needs it.
        let code = exit_code(&child.lock().unwrap_or_else(PoisonError::into_inner));
        if code.is_some() || waited >= EXPLAINED_WITHIN {
            break code;
        }
        thread::sleep(STEP);
        waited += STEP;
    };
    let how = match code {
        Some(Some(code)) => format!("exit code {code}"),
        Some(None) => "it was killed".to_string(),
        None => "it closed its output".to_string(),
    };
    match words.recv_timeout(EXPLAINED_WITHIN) {
        Ok(last) if !last.is_empty() => format!("{how}: {last}"),
        _ => how,
    }
}

fn wait_for_end(child: &Child, longest: Duration) {
    let mut waited = Duration::ZERO;
    while exit_code(child).is_none() && waited < longest {
        thread::sleep(STEP);
        waited += STEP;
    }
}

/// The exit code of a child that has ended, or `Some(None)` if it was killed. The child's number stays its own.
#[cfg(unix)]
fn exit_code(child: &Child) -> Option<Option<i32>> {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let pid = Pid::from_child(child);
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    match waitid(WaitId::Pid(pid), options) {
        Ok(None) => None,
        Ok(Some(status)) => Some(status.exit_status()),
        Err(_) => Some(None),
    }
}

#[cfg(unix)]
fn kill_group(child: &mut Child) {
    use rustix::process::{Pid, Signal, kill_process_group};
    let _ = kill_process_group(Pid::from_child(child), Signal::KILL);
}

#[cfg(not(unix))]
fn exit_code(_: &Child) -> Option<Option<i32>> {
    None
}

#[cfg(not(unix))]
fn kill_group(child: &mut Child) {
    let _ = child.kill();
}
