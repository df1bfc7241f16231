//! Finds and deletes everything about one participant (or one wizard) below a folder: recordings with all that is beside
//! their logs, rows of tables, reports, records of training.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::file_error::{FileError, FileResult, open_regular, read_regular};
use super::log::{LOG_NAME, RecordingLock, SETTINGS_NAME, WriteError};
use crate::analysis::training_record::{JudgedRecording, TrainingRecord};

/// Files that are made of recordings, and made again: they are deleted whole where they name the participant.
const MADE: [&str; 5] = ["html", "json", "svg", "md", "txt"];

/// What there is about a code.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ParticipantData {
    /// Folders of recordings, their later parts among them.
    pub recordings: Vec<PathBuf>,
    /// Files that go as a whole.
    pub files: Vec<PathBuf>,
    /// Tables, and how many of their rows go.
    pub tables: Vec<(PathBuf, u64)>,
    /// Records of a wizard's training in which watching these recordings is left out.
    pub trainings: Vec<PathBuf>,
}

impl ParticipantData {
    pub fn is_empty(&self) -> bool {
        self.recordings.is_empty() && self.files.is_empty() && self.tables.is_empty() && self.trainings.is_empty()
    }
}

/// Looks for everything with this code below a folder. Session files, and what symbolic links lead to, are left alone.
///
/// # Errors
/// A folder or a file in it cannot be read.
pub fn find(root: &Path, code: &str) -> FileResult<ParticipantData> {
    let (mut found, mut others) = (ParticipantData::default(), Vec::new());
    walk(root, code, &mut found, &mut others)?;
    let names = found.recordings.iter().filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    let about = About { code: code.to_string(), recordings: names.collect() };
    for path in others {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let readable = |path: &Path| {
            fs::read(path).map_err(|reason| FileError::unreadable(path, reason, "a readable file, or another folder"))
        };
        match extension.as_str() {
            "csv" => {
                let text = String::from_utf8_lossy(&readable(&path)?).into_owned();
                let gone = lines(&text).skip(1).filter(|row| about.is_in(row)).count() as u64;
                if about.is_in(&stem) {
                    found.files.push(path);
                } else if gone > 0 {
                    found.tables.push((path, gone));
                }
            }
            "json" if let Ok(record) = serde_json::from_slice::<TrainingRecord>(&readable(&path)?) => {
                let left = left(&record, &about).len();
                if record.wizard == code || (left == 0 && !record.recordings.is_empty()) {
                    found.files.push(path);
                } else if left < record.recordings.len() {
                    found.trainings.push(path);
                }
            }
            extension if MADE.contains(&extension) => {
                let text = String::from_utf8_lossy(&readable(&path)?).into_owned();
                if about.is_in(&stem) || about.is_in(&text) {
                    found.files.push(path);
                }
            }
            "toml" => {}
            _ if about.is_in(&stem) => found.files.push(path),
            _ => {}
        }
    }
    Ok(found)
}

/// Deletes what was found. Nothing is deleted if one of the recordings is being written.
///
/// # Errors
/// A recording is being written, or something cannot be deleted.
pub fn delete(found: &ParticipantData, code: &str) -> Result<(), WriteError> {
    let locks =
        found.recordings.iter().map(|folder| RecordingLock::take(folder)).collect::<Result<Vec<RecordingLock>, _>>()?;
    let names = found.recordings.iter().filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    let about = About { code: code.to_string(), recordings: names.collect() };
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        |reason| WriteError::Unwritable { path, reason, saved: None }
    };
    for (path, _) in &found.tables {
        let text = fs::read_to_string(path).map_err(failed(path))?;
        let (head, rows) = (lines(&text).take(1), lines(&text).skip(1).filter(|row| !about.is_in(row)));
        replace(path, head.chain(rows).collect::<String>().as_bytes()).map_err(failed(path))?;
    }
    for path in &found.trainings {
        let rewritten = fs::read(path).and_then(|bytes| {
            let record: TrainingRecord = serde_json::from_slice(&bytes).map_err(std::io::Error::other)?;
            let record = TrainingRecord { recordings: left(&record, &about), ..record };
            replace(path, (serde_json::to_string_pretty(&record).map_err(std::io::Error::other)? + "\n").as_bytes())
        });
        rewritten.map_err(failed(path))?;
    }
    for path in &found.files {
        fs::remove_file(path).map_err(failed(path))?;
    }
    for folder in &found.recordings {
        fs::remove_dir_all(folder).map_err(failed(folder))?;
    }
    drop(locks);
    Ok(())
}

/// Whom it is about, by code and by the names of the recordings.
struct About {
    code: String,
    recordings: Vec<String>,
}

impl About {
    /// Whether a text names the participant or one of the recordings, as a whole word: codes have letters, digits, - and _.
    fn is_in(&self, text: &str) -> bool {
        let mut words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '_'));
        words.any(|word| word == self.code || self.recordings.iter().any(|name| name == word))
    }
}

/// What a wizard watched beside these recordings.
fn left(record: &TrainingRecord, about: &About) -> Vec<JudgedRecording> {
    record.recordings.iter().filter(|one| !about.recordings.contains(&one.recording)).cloned().collect()
}

/// The records of a table, each with its end of line; one may go over several lines between quotes.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let mut quoted = false;
        let end = rest.char_indices().find(|&(_, c)| {
            quoted ^= c == '"';
            c == '\n' && !quoted
        });
        let end = end.map_or(rest.len(), |(at, _)| at + 1);
        let (line, after) = rest.split_at(end);
        rest = after;
        (!line.is_empty()).then_some(line)
    })
}

fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let new = path.with_extension("new");
    fs::write(&new, bytes)?;
    fs::rename(&new, path)
}

fn walk(folder: &Path, code: &str, found: &mut ParticipantData, others: &mut Vec<PathBuf>) -> FileResult<()> {
    let unreadable = |reason| FileError::unreadable(folder, reason, "the folder with the recordings");
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        entries.push((entry.path(), entry.file_type().map_err(unreadable)?));
    }
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    for (path, kind) in entries {
        if kind.is_file() {
            others.push(path);
        } else if kind.is_dir() {
            match code_of(&path) {
                Some(other) if other == code => found.recordings.push(path),
                Some(_) => {}
                None => walk(&path, code, found, others)?,
            }
        }
    }
    Ok(())
}

/// The participant of the recording in a folder; none where there is no recording. Settings are written before the log, and
/// tell it where a kill left nothing else.
fn code_of(folder: &Path) -> Option<String> {
    let of_log = || -> Option<String> {
        let mut line = String::new();
        BufReader::new(open_regular(&folder.join(LOG_NAME)).ok()?).read_line(&mut line).ok()?;
        let header: serde_json::Value = serde_json::from_str(&line).ok()?;
        Some(header.get("session")?.get("participant")?.get("code")?.as_str()?.to_string())
    };
    let of_settings = || -> Option<String> {
        let settings: toml::Table = read_regular(&folder.join(SETTINGS_NAME)).ok()?.parse().ok()?;
        Some(settings.get("participant")?.get("code")?.as_str()?.to_string())
    };
    of_log().or_else(of_settings)
}
