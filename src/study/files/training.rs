//! Records of wizard training: one JSON file per training in a folder, named by the wizard's code.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::analysis::lesson_report::WizardTrainingRecord;
use tomcom_session::files::file_error::{FileError, FileResult, read_regular};
use tomcom_session::files::replace_file;

pub fn write(folder: &Path, record: &WizardTrainingRecord) -> io::Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let text = serde_json::to_string_pretty(record).map_err(io::Error::other)? + "\n";
    for number in 1.. {
        let path = path(folder, &record.wizard, number);
        match replace_file::create(&path, text.as_bytes()) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("too many files"))
}

/// In the order of time; empty without the folder. Errors: a file cannot be read or is no training record.
pub fn read(folder: &Path, wizard: &str) -> FileResult<Vec<WizardTrainingRecord>> {
    let remedy = "a training record of tomcom, or another folder";
    let mut records = Vec::new();
    for number in 1.. {
        let path = path(folder, wizard, number);
        let text = match read_regular(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => break,
            Err(error) => return Err(FileError::unreadable(&path, error, remedy)),
        };
        let record = serde_json::from_str(&text).map_err(|error| {
            let before = text.lines().take(error.line().saturating_sub(1)).map(|line| line.len() + 1).sum::<usize>();
            let at = (before + error.column().saturating_sub(1)).min(text.len());
            FileError::at(&path, &text, Some(at..at), error.to_string(), remedy.to_string())
        })?;
        records.push(record);
    }
    Ok(records)
}

fn path(folder: &Path, wizard: &str, number: u32) -> PathBuf {
    folder.join(format!("{wizard}-{number}.json"))
}
