//! What came of a wizard's training: a JSON file for each time, in one folder, by the wizard's code.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::file_error::{FileError, FileResult};
use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::measures::wizard::{TrainingCriterion, WizardMeasures};

/// A wizard's training at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingRecord {
    /// The wizard's code, never a name.
    pub wizard: String,
    /// When it began (UTC, RFC 3339).
    pub at: String,
    pub minutes: f64,
    /// How many times as fast as it was it was played; null in records from before that was written down.
    #[serde(default)]
    pub speed: Option<f64>,
    pub criterion: TrainingCriterion,
    /// Over all recordings, each watched to its end.
    pub met: bool,
    pub recordings: Vec<JudgedRecording>,
}

/// A recording that was watched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedRecording {
    /// The name of its folder; of one that was simulated for the training, with its length before it.
    pub recording: String,
    /// It was watched to its end.
    pub complete: bool,
    /// Presses of the human in what was watched.
    pub presses: u32,
    pub signals: Vec<JudgedSignal>,
    /// The false beliefs that led to errors, as far as they had begun.
    #[serde(default)]
    pub beliefs: Vec<JudgedBelief>,
    pub measures: WizardMeasures,
    /// Kappa with what the same wizard signalled in the same recording the time before; null: there was none.
    pub kappa_with_oneself: Option<f64>,
}

/// A signal that was sent in training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedSignal {
    /// Presses of the human before it.
    pub press: u32,
    /// On the trial's clock.
    pub clock_ns: SessionTime,
    pub signal: Signal,
    /// What it was: "hit", "again", "harmless", "late", "wrong" or "needless"; empty in records from before that was written
    /// down.
    #[serde(default)]
    pub worth: String,
}

/// A false belief that led to errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedBelief {
    /// The state aspect.
    pub aspect: String,
    /// On the trial's clock.
    pub began_ns: SessionTime,
    /// Null: it was held until the end.
    pub corrected_ns: Option<SessionTime>,
    pub errors: u32,
    /// What was believed most, and what was true, when the participant last told while it was held.
    pub believed: String,
    pub truth: String,
    /// The signal that would have been right; null: none tells it.
    pub signal: Option<Signal>,
    /// Which of the signals hit it, 0 the first; null: it was missed.
    pub hit_by: Option<usize>,
}

/// Writes a record into the folder, in a file of its own, and returns its path.
///
/// # Errors
/// It cannot be written.
pub fn write(folder: &Path, record: &TrainingRecord) -> io::Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let text = serde_json::to_string_pretty(record).map_err(io::Error::other)? + "\n";
    for number in 1.. {
        let path = path(folder, &record.wizard, number);
        match fs::OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(mut file) => {
                io::Write::write_all(&mut file, text.as_bytes())?;
                file.sync_all()?;
                return Ok(path);
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("too many files"))
}

/// The records of a wizard in the folder, in the order in which they were made; none where there is no folder.
///
/// # Errors
/// A file cannot be read, or is no record.
pub fn read(folder: &Path, wizard: &str) -> FileResult<Vec<TrainingRecord>> {
    let remedy = "a training record of tomcom, or another folder";
    let mut records = Vec::new();
    for number in 1.. {
        let path = path(folder, wizard, number);
        let text = match fs::read_to_string(&path) {
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
