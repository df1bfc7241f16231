//! The file `exclusion.toml` beside a closed log: whether the trial is excluded from the analysis, and why. The log of
//! a closed recording is never changed; exclusions at the console are events in the log instead. All entries of the
//! file are kept, and the last entry holds.

use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{LogReader, RecordingLock, RecordingWriteError, check_continued};
use crate::edge::clock::WallTime;
use crate::edge::file_error::{FileError, FileResult, read_regular};
use crate::edge::replace_file;

/// Name of the exclusion file in the folder of a recording.
pub const EXCLUSION_NAME: &str = "exclusion.toml";

/// Decision to exclude a closed recording from the analysis, or to include it again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExclusionRecord {
    /// Whether the recording is excluded from the analysis; false if it is included again.
    pub excluded: bool,
    /// Reason of the decision; may be empty if the decision includes the recording again.
    #[serde(default)]
    pub reason: String,
    /// Time of the decision about the recording (UTC, RFC 3339).
    pub at: String,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rulings {
    #[serde(default)]
    ruling: Vec<ExclusionRecord>,
}

/// Why a decision about a recording cannot be recorded.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ExclusionError {
    /// The recording, or an earlier decision, cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    /// The decision about the recording cannot be written to its folder.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    /// The reason of a decision does not have 1 to 200 characters; the number is its length.
    #[error("found a reason of {0} characters")]
    #[diagnostic(help("a reason of 1 to 200 characters, on one line"))]
    Reason(usize),
}

impl From<FileError> for ExclusionError {
    fn from(error: FileError) -> ExclusionError {
        ExclusionError::File(Box::new(error))
    }
}

/// The last decision about the recording in this folder, if there is any.
///
/// # Errors
/// The file exists but cannot be read, or has other content.
pub fn ruling(folder: &Path) -> FileResult<Option<ExclusionRecord>> {
    Ok(rulings(folder)?.ruling.pop())
}

fn rulings(folder: &Path) -> FileResult<Rulings> {
    let path = folder.join(EXCLUSION_NAME);
    let text = match read_regular(&path) {
        Ok(text) => text,
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(Rulings::default());
        }
        Err(reason) => return Err(FileError::unreadable(&path, reason, "a readable text file (UTF-8)")),
    };
    toml::from_str(&text).map_err(|error| {
        let remedy = "[[ruling]] with excluded, reason and at, as tomcom exclude writes it".to_string();
        FileError::at(&path, &text, error.span(), error.message().to_string(), remedy)
    })
}

/// Records a decision about whether analyses count a closed recording, and returns the decision.
///
/// # Errors
/// The folder is not a recording, the recording is being written or is continued by a later part, or its folder cannot
/// be written to.
pub fn rule(recording: &Path, excluded: bool, reason: &str) -> Result<ExclusionRecord, ExclusionError> {
    let length = reason.chars().count();
    if length > 200 || (excluded && reason.trim().is_empty()) || reason.chars().any(char::is_control) {
        return Err(ExclusionError::Reason(length));
    }
    let log = LogReader::open(recording)?;
    let folder = log.folder();
    let _lock = RecordingLock::take(folder)?;
    check_continued(folder)?;
    let mut all = rulings(folder)?;
    let ruling = ExclusionRecord { excluded, reason: reason.to_string(), at: WallTime::now().rfc3339() };
    all.ruling.push(ruling.clone());
    let path = folder.join(EXCLUSION_NAME);
    let failed = |reason| RecordingWriteError::unwritable(&path, reason);
    let text = toml::to_string(&all).map_err(|error| failed(std::io::Error::other(error)))?;
    replace_file::replace(&path, text.as_bytes()).map_err(failed)?;
    Ok(ruling)
}
