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
mod writer;

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::TimestampedEvent;
use crate::files::file_error::FileError;

pub use decisions::{
    CORRECTION_NAME, DecisionError, EXCLUSION_NAME, ExclusionRecord, correct, corrected_code, rule, ruling,
};
pub use lock::{CODES_LOCK, LOCK_NAME, LockHolder, RecordingLock};
pub use reader::{LogEnding, LogLine, LogPlace, LogReader, MAX_LINE, at_line, first_line, read_header};
pub use same_log::{SameLogs, code_files, differing_codes, header_digest};
pub use simulated_log::{SimulatedLogState, check_simulated};
pub use writer::{LogWriter, check_continued, is_written_settings};

/// File name of the log in the folder of a recording.
pub const LOG_NAME: &str = "events.jsonl";
/// Suffix of the name of an unusable log that was renamed; from the second one on, a number follows.
const DAMAGED: &str = ".damaged";
/// File name of the settings in the folder of a recording.
pub const SETTINGS_NAME: &str = "session.toml";
/// File name of the Rerun stream in the folder of a recording.
pub const RRD_NAME: &str = "recording.rrd";
/// File name of the recording's MCAP version in the folder of a recording.
pub const MCAP_NAME: &str = "recording.mcap";

/// Why a recording cannot be written, or not any further.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RecordingWriteError {
    /// The recording cannot be written any further; events that were acknowledged before are in the recording.
    #[error("{}: the recording cannot be written: {reason}{}", path.display(), rescued(.saved))]
    #[diagnostic(help("a folder that can be written to, on a disk with free space"))]
    Unwritable {
        /// File or folder that cannot be written.
        path: PathBuf,
        /// Why the recording's file or folder cannot be written.
        reason: io::Error,
        /// Folder to which the recording was saved, if the recording is no longer at its original place.
        saved: Option<PathBuf>,
    },
    /// Another program changed the log; the saved log, if there is one, contains every acknowledged event.
    #[error("{}: the log {found}{}", path.display(), rescued(.saved))]
    #[diagnostic(help(
        "other programs may read the log of a running session, but not change it; the changed log is kept beside the \
         saved one as {LOG_NAME}.damaged"
    ))]
    Damaged {
        /// Path of the damaged log.
        path: PathBuf,
        /// Damage of the log that was found, in words.
        found: String,
        /// Folder to which the recording was saved; `None` if the recording could not be saved.
        saved: Option<PathBuf>,
    },
    /// Another program is writing this recording.
    #[error("{}: another program{} writes this recording", folder.display(), process(.pid))]
    #[diagnostic(help("end the other program first, or watch its session: tomcom replay RECORDING --follow"))]
    InUse {
        /// Folder of the recording.
        folder: PathBuf,
        /// Process id of the program that writes the recording; `None` if not known.
        pid: Option<u32>,
    },
    /// Another program is coding the errors of this recording as the same rater.
    #[error("{}: another program{} codes its errors as {raters}", folder.display(), process(.pid))]
    #[diagnostic(help("go on coding there, or quit that program first; every rater has a code of their own"))]
    Coded {
        /// Folder of the recording.
        folder: PathBuf,
        /// Name of the rater, or of the two raters who settle their differences.
        raters: String,
        /// Process id of the program that codes the errors; `None` if not known.
        pid: Option<u32>,
    },
    /// Another program is recording this participant of a study plan.
    #[error("{}: another program{} records {code} of the plan {plan}", folder.display(), process(.pid))]
    #[diagnostic(help(
        "go on there, or quit that program first; tomcom replay RECORDING --follow watches its session"
    ))]
    Attended {
        /// Folder with the recordings of the study.
        folder: PathBuf,
        /// Name of the study plan.
        plan: String,
        /// Code of the participant.
        code: String,
        /// Process id of the program that records the participant; `None` if not known.
        pid: Option<u32>,
    },
    /// The recording has already been continued.
    #[error("{}: this recording was continued already", folder.display())]
    #[diagnostic(help("continue its next part, if that was cut: tomcom operate --continue {}", part.display()))]
    Continued {
        /// Folder of the recording.
        folder: PathBuf,
        /// Folder of the part that continues the recording.
        part: PathBuf,
    },
    /// The folder that a new recording needs already contains something else.
    #[error("{}: {what} is there already", folder.display())]
    #[diagnostic(help(
        "use another folder, or remove that recording first: only the same session replaces its \
                       recording"
    ))]
    Taken {
        /// Folder in which the recording was to be made.
        folder: PathBuf,
        /// What the folder contains instead.
        what: String,
    },
}

impl RecordingWriteError {
    /// Whether the recording cannot be written because the disk is full, so that it can be as soon as there is room.
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

/// Whether a file of this name in the folder of a recording is an unusable log that was renamed.
pub fn is_damaged_log(name: &str) -> bool {
    let number = name.strip_prefix(LOG_NAME).and_then(|rest| rest.strip_prefix(DAMAGED));
    number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Renames an unusable log to the first free name of `events.jsonl.damaged`, `events.jsonl.damaged2`, …; returns the
/// log's new path, or `None` if there was no log.
fn move_aside(log: &Path) -> io::Result<Option<PathBuf>> {
    let named = |n: u32| {
        let number = if n == 1 { String::new() } else { n.to_string() };
        log.with_file_name(format!("{LOG_NAME}{DAMAGED}{number}"))
    };
    let aside = (1..).map(named).find(|path| fs::symlink_metadata(path).is_err());
    let Some(aside) = aside.filter(|_| fs::symlink_metadata(log).is_ok()) else { return Ok(None) };
    fs::rename(log, &aside).map(|()| Some(aside))
}

/// The line of the log for an event, without its line end.
pub fn event_line(stamped: &TimestampedEvent) -> String {
    serde_json::to_string(stamped).expect("events have no maps with other keys than strings")
}

/// Error of work on recordings: a file cannot be read, or a result cannot be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RecordingError {
    /// A file cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    /// A recording cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
}

impl From<FileError> for RecordingError {
    fn from(error: FileError) -> RecordingError {
        RecordingError::File(Box::new(error))
    }
}
