//! Files beside a closed log with later decisions about the recording. The log of a closed recording is never changed.
//! All decisions of a file are kept, and the last one holds.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{RecordingWriteError, check_continued};
use crate::files::file_error::{FileError, FileResult, read_regular};
use crate::files::replace_file;

/// Why a decision about a recording cannot be recorded.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum DecisionError {
    /// The recording, or an earlier decision, cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    /// The decision about the recording cannot be written to its folder.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    /// The decision cannot be made about this recording, or not like this.
    #[error("found {found}")]
    #[diagnostic(help("{remedy}"))]
    Unfit {
        /// What is wrong with the decision, in words.
        found: String,
        /// What would be right instead.
        remedy: String,
    },
}

impl From<FileError> for DecisionError {
    fn from(error: FileError) -> DecisionError {
        DecisionError::File(Box::new(error))
    }
}

/// Checks the reason that somebody gave for a decision; an empty one only where it `may_be_empty`.
pub(super) fn check_reason(reason: &str, may_be_empty: bool) -> Result<(), DecisionError> {
    let length = reason.chars().count();
    let found = if reason.chars().any(char::is_control) {
        "a reason with a line break or another control character".to_string()
    } else if length > 200 {
        format!("a reason of {length} characters")
    } else if !may_be_empty && reason.trim().is_empty() {
        "an empty reason".to_string()
    } else {
        return Ok(());
    };
    Err(DecisionError::Unfit { found, remedy: "a reason of 1 to 200 characters, on one line".to_string() })
}

/// Checks that no later part continues the recording in a folder: decisions are about the whole recording.
pub(super) fn check_last_part(folder: &Path) -> Result<(), DecisionError> {
    let mut last = folder.to_path_buf();
    while let Err(RecordingWriteError::Continued { part, .. }) = check_continued(&last) {
        last = part;
    }
    if last == folder {
        return Ok(());
    }
    let found = format!("{}, a part of a recording that was continued already", folder.display());
    Err(DecisionError::Unfit { found, remedy: format!("the last part of the recording: {}", last.display()) })
}

/// Reads a file with decisions; empty decisions if there is no such file. `remedy`: what the file should contain.
pub(super) fn read<Decisions: DeserializeOwned + Default>(path: &Path, remedy: &str) -> FileResult<Decisions> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    check_single(path.parent().unwrap_or(Path::new("")), &name)?;
    let text = match read_regular(path) {
        Ok(text) => text,
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(Decisions::default());
        }
        Err(reason) => return Err(FileError::unreadable(path, reason, "a readable text file (UTF-8)")),
    };
    toml::from_str(&text)
        .map_err(|error| FileError::at(path, &text, error.span(), error.message().to_string(), remedy.to_string()))
}

/// Checks that the folder of a recording has no copy of the file with this name, such as those that file managers and
/// sync programs make: it could have another content, and what it says would be lost.
///
/// # Errors
/// There is such a copy.
pub(super) fn check_single(folder: &Path, name: &str) -> FileResult<()> {
    // A folder that cannot be read is reported by the reader of the file.
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    for entry in entries.flatten() {
        let other = entry.file_name().to_string_lossy().to_ascii_lowercase();
        if other != name && other.contains(stem) && other.ends_with(&format!(".{extension}")) {
            let remedy =
                format!("{name} alone: compare the two, keep the one that holds, and move the other elsewhere");
            let found = format!("what looks like a copy of {name}, which is not read");
            return Err(FileError::from_finding(&entry.path(), found, remedy));
        }
    }
    Ok(())
}

/// Writes a file with decisions, completely or not at all.
pub(super) fn write(path: &Path, decisions: &impl Serialize) -> Result<(), RecordingWriteError> {
    let failed = |reason| RecordingWriteError::unwritable(path, reason);
    let text = toml::to_string(decisions).map_err(|error| failed(std::io::Error::other(error)))?;
    replace_file::replace(path, text.as_bytes()).map_err(failed)
}
