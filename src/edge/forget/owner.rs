//! Which participant the recording in a folder belongs to.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use serde_json::Value;

use crate::edge::file_error::read_regular;
use crate::edge::log::{
    LOCK_NAME, LOG_NAME, RRD_NAME, SETTINGS_NAME, corrected_code, first_line, is_begun, is_written_settings,
};
use crate::edge::stream_head;
use crate::session::header::FORMAT;

/// Which participant the recording in a folder belongs to.
pub(super) enum RecordingOwner {
    Participant {
        code: String,
        /// Time at which the recording began, as the identity of a Rerun stream states it; `None` without a readable
        /// header.
        began: Option<String>,
    },
    /// A recording whose participant cannot be determined, with the reason.
    Unknown(&'static str),
    NoRecording,
}

/// Content of the first line of a log.
enum FirstLine {
    /// The folder contains no log.
    Missing,
    /// The first line belongs to a log of another program.
    Foreign,
    Damaged,
    Header {
        code: String,
        began: Option<String>,
    },
}

impl RecordingOwner {
    /// Determines the participant of the recording in a folder from the header of its log. If the header is damaged or
    /// the log is gone, the settings beside it tell the participant's code. A settings file alone counts as a recording
    /// only if this program wrote it: a program that is killed before it writes the log leaves such a file behind.
    pub(super) fn read(folder: &Path) -> RecordingOwner {
        let settings = || read_settings(folder);
        match first_line_in(folder) {
            FirstLine::Header { code, began } => match corrected_code(folder, &code) {
                Ok(correction) => {
                    let code = correction.map_or(code, |correction| correction.after);
                    RecordingOwner::Participant { code, began }
                }
                Err(_) => RecordingOwner::Unknown(
                    "a recording that does not say whose it is: correction.toml is damaged; it is to be deleted by hand, if it \
                     is the participant's",
                ),
            },
            FirstLine::Foreign => RecordingOwner::NoRecording,
            FirstLine::Damaged => match settings() {
                Some((code, _)) => RecordingOwner::Participant { code, began: None },
                None => RecordingOwner::Unknown(
                    "a recording that does not say whose it is: events.jsonl has no readable header, and session.toml is missing \
                     or damaged; it is to be deleted by hand, if it is the participant's",
                ),
            },
            FirstLine::Missing => {
                let is_streamed = || stream_head::identity(&folder.join(RRD_NAME)).is_ok_and(|found| found.is_some());
                let is_begun = || is_file(&folder.join(LOCK_NAME)) || holds_begun(folder);
                match settings() {
                    Some((code, is_own)) if is_own || is_begun() || is_streamed() => {
                        RecordingOwner::Participant { code, began: None }
                    }
                    None if is_streamed() => RecordingOwner::Unknown(
                        "a recording that does not say whose it is: recording.rrd, without events.jsonl and session.toml; it is to \
                         be deleted by hand, if it is the participant's",
                    ),
                    _ => RecordingOwner::NoRecording,
                }
            }
        }
    }
}

/// Whether this path is a regular file: the targets of symbolic links must not be touched, and opening a named pipe
/// would block.
fn is_file(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|data| data.is_file())
}

/// Whether the folder has a log or settings that a program was writing when it was killed.
fn holds_begun(folder: &Path) -> bool {
    let mut entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.any(|entry| is_file(&entry.path()) && entry.file_name().to_str().is_some_and(is_begun))
}

fn first_line_in(folder: &Path) -> FirstLine {
    let path = folder.join(LOG_NAME);
    if !is_file(&path) {
        return FirstLine::Missing;
    }
    let line = File::open(path).and_then(|file| first_line(&mut BufReader::new(file)));
    let Some(Value::Object(header)) = line.ok().and_then(|line| serde_json::from_slice(&line).ok()) else {
        return FirstLine::Damaged;
    };
    if header.get("format").and_then(Value::as_str) != Some(FORMAT) {
        // The first line of the log is an event, so the header before it is lost.
        let is_event = header.contains_key("seq") && header.contains_key("t_ns");
        return if is_event { FirstLine::Damaged } else { FirstLine::Foreign };
    }
    let session = header.get("session");
    let code = session.and_then(|session| session.get("participant")?.get("code")?.as_str());
    let seed = session.and_then(|session| session.get("seed")?.as_u64());
    let began = match (header.get("started").and_then(Value::as_str), seed, header.get("trial").and_then(Value::as_u64))
    {
        (Some(started), ..) => Some(started.to_string()),
        (None, Some(seed), Some(trial)) => Some(format!("seed {seed} trial {trial}")),
        _ => None,
    };
    code.map_or(FirstLine::Damaged, |code| FirstLine::Header { code: code.to_string(), began })
}

/// The participant's code in the settings file of a folder, and whether this program wrote that file (then it has all
/// settings and nothing else).
fn read_settings(folder: &Path) -> Option<(String, bool)> {
    let path = folder.join(SETTINGS_NAME);
    let text = is_file(&path).then(|| read_regular(&path).ok()).flatten()?;
    let settings: toml::Table = text.parse().ok()?;
    let code = settings.get("participant")?.get("code")?.as_str()?.to_string();
    Some((code, is_written_settings(&text)))
}
