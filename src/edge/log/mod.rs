//! The recording of a session: a folder with `session.toml` (the settings as they were in force) and `events.jsonl` (the
//! log: a header line, then one event a line; the only source of truth). A recording that was cut is continued by a part
//! in a folder beside it, whose header names the one before.

pub mod consensus_file;
mod exclusion;
mod guarded;
mod lock;
pub mod rater_codes;
mod reader;
mod simulated_log;
mod writer;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::session::Stamped;
pub use exclusion::{EXCLUSION_NAME, ExclusionError, ExclusionRecord, rule, ruling};
pub use lock::{CODES_LOCK, LOCK_NAME, LockHolder, RecordingLock};
pub use reader::{LogEnding, LogLine, LogReader, at_line};
pub use simulated_log::{SimulatedLog, check_simulated};
pub use writer::{LogWriter, check_continued, is_written_settings};

/// The name of the log in its folder.
pub const LOG_NAME: &str = "events.jsonl";
/// Suffix of the name of an unusable log; from the second on a number follows.
const DAMAGED: &str = ".damaged";
/// The name of the settings in the folder of a recording.
pub const SETTINGS_NAME: &str = "session.toml";
/// The name of the stream in the folder of a recording.
pub const RRD_NAME: &str = "recording.rrd";
/// The name of the MCAP in the folder of a recording.
pub const MCAP_NAME: &str = "recording.mcap";

/// Why a recording is not written, or not on.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum WriteError {
    /// What was acknowledged before is there, nothing after it.
    #[error("{}: the recording cannot be written: {reason}{}", path.display(), rescued(.saved))]
    #[diagnostic(help("a folder that can be written to, on a disk with free space"))]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// Why not.
        reason: io::Error,
        /// Where what was recorded was saved to, if it is no longer where it was.
        saved: Option<PathBuf>,
    },
    /// The saved log, if there is one, has every acknowledged event.
    #[error("{}: the log {found}{}", path.display(), rescued(.saved))]
    #[diagnostic(help(
        "other programs may read the log of a running session, and change nothing; as they left it, it is kept beside the \
         saved one as {LOG_NAME}.damaged"
    ))]
    Damaged {
        /// The log.
        path: PathBuf,
        /// The damage.
        found: String,
        /// Where what was recorded was saved to, if it could be saved.
        saved: Option<PathBuf>,
    },
    /// Another program writes this recording.
    #[error("{}: another program{} writes this recording", folder.display(), process(.pid))]
    #[diagnostic(help("end the other one first, or watch it: tomcom replay RECORDING --follow"))]
    InUse {
        /// The recording's folder.
        folder: PathBuf,
        /// That program's process id, if it is known.
        pid: Option<u32>,
    },
    /// Another program codes the errors of this recording as the same rater.
    #[error("{}: another program{} codes its errors as {raters}", folder.display(), process(.pid))]
    #[diagnostic(help("go on there, or leave it first; every rater has a name of its own"))]
    Coded {
        /// The recording's folder.
        folder: PathBuf,
        /// The rater, or the two who settle their differences.
        raters: String,
        /// That program's process id, if it is known.
        pid: Option<u32>,
    },
    /// The recording was continued already.
    #[error("{}: this recording was continued already", folder.display())]
    #[diagnostic(help("its next part: tomcom operate --continue {}, if that was cut", part.display()))]
    Continued {
        /// The recording's folder.
        folder: PathBuf,
        /// The folder of its next part.
        part: PathBuf,
    },
    /// The folder holds something else already.
    #[error("{}: {what} is there already", folder.display())]
    #[diagnostic(help("another folder, or remove that one first: only the same session replaces its recording"))]
    Taken {
        /// The folder.
        folder: PathBuf,
        /// What is there.
        what: &'static str,
    },
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

/// Whether a file of this name in the folder of a recording is a log that was renamed because it was unusable.
pub fn is_damaged_log(name: &str) -> bool {
    let number = name.strip_prefix(LOG_NAME).and_then(|rest| rest.strip_prefix(DAMAGED));
    number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Renames an unusable log to the first free one of `events.jsonl.damaged`, `events.jsonl.damaged2`, …; returns its new path, or
/// `None` if there was no log.
fn move_aside(log: &Path) -> io::Result<Option<PathBuf>> {
    let named = |n: u32| {
        let number = if n == 1 { String::new() } else { n.to_string() };
        log.with_file_name(format!("{LOG_NAME}{DAMAGED}{number}"))
    };
    let aside = (1..).map(named).find(|path| fs::symlink_metadata(path).is_err());
    let Some(aside) = aside.filter(|_| fs::symlink_metadata(log).is_ok()) else { return Ok(None) };
    fs::rename(log, &aside).map(|()| Some(aside))
}

/// The line of the log for an event, without its end.
pub fn event_line(stamped: &Stamped) -> String {
    serde_json::to_string(stamped).expect("events have no maps with other keys than strings")
}
