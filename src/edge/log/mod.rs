//! The recording of a session: a folder with `session.toml` (the settings as they were in force) and `events.jsonl` (the
//! log: a header line, then one event a line; the only source of truth). A recording that was cut is continued by a part
//! in a folder beside it, whose header names the one before.

pub mod codes;
mod exclusion;
mod lock;
mod reader;
mod writer;

use std::io;
use std::path::PathBuf;

use crate::session::Stamped;
pub use exclusion::{EXCLUSION_NAME, ExclusionError, ExclusionRecord, rule, ruling};
pub use lock::{LOCK_NAME, LockHolder, RecordingLock};
pub use reader::{LogEnding, LogLine, LogReader, at_line};
pub use writer::{LogWriter, check_continued, check_simulated, is_whole, is_written_settings};

/// The name of the log in its folder.
pub const LOG_NAME: &str = "events.jsonl";
/// The name of the settings in the folder of a recording.
pub const SETTINGS_NAME: &str = "session.toml";
/// The name of the stream in the folder of a recording.
pub const RRD_NAME: &str = "recording.rrd";

/// Why a recording is not written, or not on.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum WriteError {
    /// What was acknowledged before is there, nothing after it.
    #[error("{}: the recording cannot be written: {reason}{}", path.display(), rescued(.saved))]
    #[diagnostic(help("a folder that can be written to, on a disk with free space"))]
    Unwritable {
        path: PathBuf,
        reason: io::Error,
        /// Where what was recorded was saved to, if it is no longer where it was.
        saved: Option<PathBuf>,
    },
    #[error("{}: another program{} writes this recording", folder.display(), process(.pid))]
    #[diagnostic(help("end the other one first, or watch it: tomcom replay RECORDING --follow"))]
    InUse { folder: PathBuf, pid: Option<u32> },
    #[error("{}: this recording was continued already", folder.display())]
    #[diagnostic(help("its next part: tomcom operate --continue {}, if that was cut", part.display()))]
    Continued { folder: PathBuf, part: PathBuf },
    #[error("{}: {what} is there already", folder.display())]
    #[diagnostic(help("another folder, or remove that one first: only the same session replaces its recording"))]
    Taken { folder: PathBuf, what: &'static str },
}

impl WriteError {
    fn unwritable(path: impl Into<PathBuf>, reason: io::Error) -> WriteError {
        WriteError::Unwritable { path: path.into(), reason, saved: None }
    }
}

fn rescued(saved: &Option<PathBuf>) -> String {
    saved.as_ref().map_or(String::new(), |saved| format!("; what was recorded until then is in {}", saved.display()))
}

fn process(pid: &Option<u32>) -> String {
    pid.map_or(String::new(), |pid| format!(" (process {pid})"))
}

/// The line of the log for an event, without its end.
pub fn event_line(stamped: &Stamped) -> String {
    serde_json::to_string(stamped).expect("events have no maps with other keys than strings")
}
