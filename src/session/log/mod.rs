//! Recordings of sessions. A recording is a folder with `session.toml` (the session's settings) and `events.jsonl` (the
//! log: a header line, then one event per line; the only source of truth). A recording that was cut off is continued by
//! a further part in a folder beside it, whose header names the previous part.

pub mod consensus_file;
mod decisions;
mod lock;
pub mod rater_codes;
mod reader;
mod same_log;
mod simulated_log;
pub mod video_file;
mod writer;

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::TimestampedEvent;
use crate::files::file_error::FileError;

pub use decisions::{
    CORRECTION_NAME, DecisionError, EXCLUSION_NAME, ExclusionRecord, correct, corrected_code, is_excluded, rule,
    rule_participant, ruling,
};
pub use lock::{CODES_LOCK, LOCK_NAME, LockHolder, RecordingLock};
pub use reader::{LogEnding, LogLine, LogPlace, LogReader, MAX_LINE, at_line, first_line, read_header};
pub use same_log::{SameLogs, code_files, differing_codes, header_digest};
pub use simulated_log::{SimulatedLogState, check_simulated};
pub use writer::{LogWriter, check_continued, is_written_settings};

pub const LOG_NAME: &str = "events.jsonl";
/// An unusable log is renamed with this suffix; from the second one on, a number follows.
const DAMAGED: &str = ".damaged";
pub const SETTINGS_NAME: &str = "session.toml";
pub const RRD_NAME: &str = "recording.rrd";
pub const MCAP_NAME: &str = "recording.mcap";
/// Annotations for ELAN and BORIS, and subtitles.
pub const ANNOTATION_NAMES: [&str; 3] = ["recording.eaf", "recording.boris", "recording.vtt"];

#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RecordingWriteError {
    /// Events that were acknowledged before are in the recording.
    #[error("{}: the recording cannot be written: {reason}{}", path.display(), rescued(.saved))]
    #[diagnostic(help("a folder that can be written to, on a disk with free space"))]
    Unwritable {
        path: PathBuf,
        reason: io::Error,
        /// Folder to which the recording was saved, if it is no longer at its place.
        saved: Option<PathBuf>,
    },
    /// Another program changed the log; the saved one, if there is one, contains every acknowledged event.
    #[error("{}: the log {found}{}", path.display(), rescued(.saved))]
    #[diagnostic(help(
        "other programs may read the log of a running session, but not change it; the changed log is kept beside the \
         saved one as {LOG_NAME}.damaged"
    ))]
    Damaged {
        path: PathBuf,
        found: String,
        /// `None` if it could not be saved.
        saved: Option<PathBuf>,
    },
    #[error("{}: another program{} writes this recording", folder.display(), process(.pid))]
    #[diagnostic(help("end the other program first, or watch its session: tomcom replay RECORDING --follow"))]
    InUse { folder: PathBuf, pid: Option<u32> },
    #[error("{}: another program{} codes its errors as {raters}", folder.display(), process(.pid))]
    #[diagnostic(help("go on coding there, or quit that program first; every rater has a code of their own"))]
    Coded {
        folder: PathBuf,
        /// The rater, or the two who settle their differences.
        raters: String,
        pid: Option<u32>,
    },
    #[error("{}: another program{} records {code} of the plan {plan}", folder.display(), process(.pid))]
    #[diagnostic(help(
        "go on there, or quit that program first; tomcom replay RECORDING --follow watches its session"
    ))]
    Attended {
        /// Folder with the recordings of the study.
        folder: PathBuf,
        plan: String,
        code: String,
        pid: Option<u32>,
    },
    #[error("{}: this recording was continued already", folder.display())]
    #[diagnostic(help("continue its next part, if that was cut: tomcom operate --continue {}", part.display()))]
    Continued {
        folder: PathBuf,
        /// The part that continues it.
        part: PathBuf,
    },
    /// The folder that a new recording needs contains something else.
    #[error("{}: {what} is there already", folder.display())]
    #[diagnostic(help(
        "use another folder (--out), or remove that recording first: only the same session, with the same settings, replaces \
         its recording"
    ))]
    Taken { folder: PathBuf, what: String },
}

impl RecordingWriteError {
    /// Whether the recording can be written as soon as there is room.
    pub fn is_disk_full(&self) -> bool {
        let is_full =
            |reason: &io::Error| matches!(reason.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded);
        matches!(self, RecordingWriteError::Unwritable { reason, .. } if is_full(reason))
    }

    fn unwritable(path: impl Into<PathBuf>, reason: io::Error) -> RecordingWriteError {
        RecordingWriteError::Unwritable { path: path.into(), reason, saved: None }
    }
}

fn rescued(saved: &Option<PathBuf>) -> String {
    saved.as_ref().map_or(String::new(), |saved| format!("; everything recorded until then is in {}", saved.display()))
}

fn process(pid: &Option<u32>) -> String {
    pid.map_or(String::new(), |pid| format!(" (process {pid})"))
}

/// Whether a file of this name is an unusable log that was renamed.
pub fn is_damaged_log(name: &str) -> bool {
    let number = name.strip_prefix(LOG_NAME).and_then(|rest| rest.strip_prefix(DAMAGED));
    number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Renames an unusable log to the first free name of `events.jsonl.damaged`, `events.jsonl.damaged2`, …; returns its
/// new path, or `None` if there was no log.
fn move_aside(log: &Path) -> io::Result<Option<PathBuf>> {
    let named = |n: u32| {
        let number = if n == 1 { String::new() } else { n.to_string() };
        log.with_file_name(format!("{LOG_NAME}{DAMAGED}{number}"))
    };
    let aside = (1..).map(named).find(|path| fs::symlink_metadata(path).is_err());
    let Some(aside) = aside.filter(|_| fs::symlink_metadata(log).is_ok()) else { return Ok(None) };
    fs::rename(log, &aside).map(|()| Some(aside))
}

/// Without its line end.
pub fn event_line(stamped: &TimestampedEvent) -> String {
    serde_json::to_string(stamped).expect("events have no maps with other keys than strings")
}

#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RecordingError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
}
