//! Files beside a closed log with later decisions about the recording: `exclusion.toml` and `correction.toml`. The log
//! of a closed recording is never changed. All decisions of a file are kept, and the last one holds.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::files::file_error::{FileError, FileResult, read_regular};
use crate::files::{WallTime, replace_file};
use crate::header::CodeCorrection;
use crate::log::reader::first_line_of;
use crate::log::{LOG_NAME, LogReader, RecordingLock, RecordingWriteError, check_continued, read_header};
use crate::{Event, LogHeader, person_code};

#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum DecisionError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    /// The decision cannot be made about this recording, or not like this.
    #[error("found {found}")]
    #[diagnostic(help("{remedy}"))]
    Unfit { found: String, remedy: String },
}

fn check_reason(reason: &str, may_be_empty: bool) -> Result<(), DecisionError> {
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

/// Decisions are about the whole recording, so no later part may continue it.
fn check_last_part(folder: &Path) -> Result<(), DecisionError> {
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

/// Empty decisions if there is no such file. `remedy`: what the file should contain.
fn read_decisions<Decisions: DeserializeOwned + Default>(path: &Path, remedy: &str) -> FileResult<Decisions> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    check_single(path.parent().unwrap_or(Path::new("")), &name)?;
    let text = match read_regular(path) {
        Ok(text) => text,
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(Decisions::default());
        }
        Err(reason) => return Err(FileError::unreadable(path, reason, "a readable text file (UTF-8)")),
    };
    toml::from_str(&text).map_err(|error| FileError::at(path, &text, error.span(), error.message().to_string(), remedy))
}

/// The folder must have no copy of this file, such as file managers and sync programs make: it could have another
/// content, which would be lost.
pub(crate) fn check_single(folder: &Path, name: &str) -> FileResult<()> {
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

fn write_decisions(path: &Path, decisions: &impl Serialize) -> Result<(), RecordingWriteError> {
    let failed = |reason| RecordingWriteError::unwritable(path, reason);
    let text = toml::to_string(decisions).map_err(|error| failed(std::io::Error::other(error)))?;
    replace_file::replace(path, text.as_bytes()).map_err(failed)
}

/// Whether the trial is excluded from the analysis, and why. Exclusions at the console are events in the log instead.
pub const EXCLUSION_NAME: &str = "exclusion.toml";

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExclusionRecord {
    /// False if it is included again.
    pub excluded: bool,
    /// May be empty for an inclusion.
    #[serde(default)]
    pub reason: String,
    /// UTC, RFC 3339.
    pub at: String,
    /// Whether it was made about all recordings of the participant at once.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub of_participant: bool,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rulings {
    #[serde(default)]
    ruling: Vec<ExclusionRecord>,
}

/// The last decision about the recording in this folder.
pub fn ruling(folder: &Path) -> FileResult<Option<ExclusionRecord>> {
    Ok(rulings(folder)?.ruling.pop())
}

fn rulings(folder: &Path) -> FileResult<Rulings> {
    let remedy = "[[ruling]] with excluded, reason and at, as tomcom exclude writes it";
    read_decisions(&folder.join(EXCLUSION_NAME), remedy)
}

/// Whether the recording is excluded, at the console or by a later ruling; without a ruling, the log is read to its end.
pub fn is_excluded(log: &mut LogReader) -> FileResult<bool> {
    if let Some(ruling) = ruling(log.folder())? {
        return Ok(ruling.excluded);
    }
    let mut is_excluded = false;
    while let Some(line) = log.next_line()? {
        match line.stamped.event {
            Event::TrialExcluded { .. } => is_excluded = true,
            Event::TrialIncluded => is_excluded = false,
            _ => {}
        }
    }
    Ok(is_excluded)
}

/// Records whether analyses count a closed recording. It is an error if the recording is being written or is continued
/// by a later part, or if it is to be included although it is not excluded.
pub fn rule(recording: &Path, excluded: bool, reason: &str) -> Result<ExclusionRecord, DecisionError> {
    decide(recording, excluded, reason, false)
}

/// Likewise, as one of all recordings of the participant.
pub fn rule_participant(recording: &Path, excluded: bool, reason: &str) -> Result<ExclusionRecord, DecisionError> {
    decide(recording, excluded, reason, true)
}

fn decide(
    recording: &Path,
    excluded: bool,
    reason: &str,
    of_participant: bool,
) -> Result<ExclusionRecord, DecisionError> {
    check_reason(reason, !excluded)?;
    let mut log = match LogReader::open(recording) {
        // A damaged header does not keep a recording from being left out.
        Err(_) if excluded && recording.join(LOG_NAME).is_file() => None,
        log => Some(log?),
    };
    let folder = &log.as_ref().map_or(recording, LogReader::folder).to_path_buf();
    let _lock = RecordingLock::take(folder)?;
    check_last_part(folder)?;
    let mut all = rulings(folder)?;
    if let Some(log) = &mut log
        && !excluded
        && !is_excluded(log)?
    {
        let found = format!("no exclusion of {}", recording.display());
        return Err(DecisionError::Unfit { found, remedy: "a recording that is excluded".to_string() });
    }
    let (reason, at) = (reason.to_string(), WallTime::now().rfc3339());
    let ruling = ExclusionRecord { excluded, reason, at, of_participant };
    all.ruling.push(ruling.clone());
    write_decisions(&folder.join(EXCLUSION_NAME), &all)?;
    Ok(ruling)
}

/// To which participant the recording belongs, if the code was typed wrong when the session began.
pub const CORRECTION_NAME: &str = "correction.toml";

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Corrections {
    #[serde(default)]
    correction: Vec<CodeCorrection>,
}

fn corrections(folder: &Path) -> FileResult<Corrections> {
    let remedy = "[[correction]] with before, after, why, by and at, as tomcom correct writes it";
    read_decisions(&folder.join(CORRECTION_NAME), remedy)
}

/// The correction that holds for the log in this folder; `None` if the recorded code is right.
pub fn corrected_code(folder: &Path, recorded: &str) -> FileResult<Option<CodeCorrection>> {
    let last = corrections(folder)?.correction.pop();
    // A correction that was taken back leads to the recorded code.
    let last = last.filter(|last| last.after != recorded);
    Ok(last.map(|last| CodeCorrection { before: recorded.to_string(), ..last }))
}

pub(crate) fn correct_header(folder: &Path, header: &mut LogHeader) -> FileResult<()> {
    let code = &mut header.session.participant.code;
    header.correction = corrected_code(folder, code)?;
    if let Some(correction) = &header.correction {
        code.clone_from(&correction.after);
    }
    Ok(())
}

/// Records that a closed recording belongs to the participant with another code; `None`: to that in its log, after all.
/// The correction stands beside the log of each part, since each part says whose it is. It is an error if the recording
/// is being written or is continued by a later part, and if the code is no code of a participant, is the present one,
/// or differs from that of a recording beside it in capital letters only.
pub fn correct(recording: &Path, code: Option<&str>, why: &str) -> Result<CodeCorrection, DecisionError> {
    check_reason(why, code.is_none())?;
    let log = LogReader::open(recording)?;
    let parts = log.logs();
    let folders: Vec<&Path> = parts.iter().map(|log| log.parent().unwrap_or(Path::new(""))).collect();
    let locks = folders.iter().map(|folder| RecordingLock::take(folder)).collect::<Result<Vec<_>, _>>()?;
    check_last_part(log.folder())?;
    let wrong = |found: String, remedy: &str| Err(DecisionError::Unfit { found, remedy: remedy.to_string() });
    if let Some((code, fault)) = code.and_then(|code| Some((code, person_code::fault(code)?))) {
        return wrong(format!("the code \"{code}\": {fault}"), person_code::REMEDY);
    }
    let parts = parts.iter().map(|log| Ok(LogReader::open(log)?.header)).collect::<FileResult<Vec<LogHeader>>>()?;
    // Later parts of a recording that was corrected before it was continued have the corrected code in their logs.
    let recorded = parts.first().map_or("", LogHeader::recorded_code);
    let (before, after) = (&log.header.session.participant.code, code.unwrap_or(recorded));
    if after == before {
        return match code {
            Some(_) => wrong(format!("the code {after}, which the recording has already"), "another code"),
            None => wrong(format!("no correction of the code {before}"), "a recording whose code was corrected"),
        };
    }
    if let Some((neighbour, other)) = code.and_then(|code| differing_neighbour(log.folder(), &folders, code)) {
        let found = format!("the code {after}, beside {neighbour}, which is a recording of {other}");
        return wrong(found, "one code of one participant, in the same capital and small letters");
    }
    let (by, after, why, at) = (account(), after.to_string(), why.to_string(), WallTime::now().rfc3339());
    let correction = CodeCorrection { before: before.clone(), after, why, by, at };
    for (folder, part) in folders.iter().zip(&parts) {
        let mut all = corrections(folder)?;
        let before = part.session.participant.code.clone();
        all.correction.push(CodeCorrection { before, ..correction.clone() });
        write_decisions(&folder.join(CORRECTION_NAME), &all)?;
    }
    drop(locks);
    Ok(correction)
}

/// A recording beside this one whose participant's code differs in capital letters only, with its code. Neighbours
/// whose headers cannot be read are reported when they are read.
fn differing_neighbour(recording: &Path, own: &[&Path], code: &str) -> Option<(String, String)> {
    let recording = recording.canonicalize().ok()?;
    let is_own = |folder: &Path| {
        folder == recording || own.iter().any(|part| part.canonicalize().is_ok_and(|part| part == folder))
    };
    let neighbours = fs::read_dir(recording.parent()?).ok()?.flatten();
    neighbours.filter(|entry| !is_own(&entry.path())).find_map(|entry| {
        let log = entry.path().join(LOG_NAME);
        let line = first_line_of(&log).ok()?;
        let other = read_header(&log, String::from_utf8_lossy(&line).trim_end()).ok()?.session.participant.code;
        person_code::differing_in_case(code, [other.as_str()])?;
        Some((entry.file_name().to_string_lossy().into_owned(), other))
    })
}

/// The account that runs the program, by its name, or else by its number; empty if neither is known.
fn account() -> String {
    let is_named = |name| std::env::var(name).ok().filter(|name| !name.is_empty());
    let named = ["USER", "LOGNAME", "USERNAME"].into_iter().find_map(is_named);
    named.or_else(account_number).unwrap_or_default()
}

/// That of the owner of a file that the program makes.
#[cfg(unix)]
fn account_number() -> Option<String> {
    use std::os::unix::fs::MetadataExt;
    let made = tempfile::tempfile().and_then(|file| file.metadata());
    made.ok().map(|data| format!("uid {}", data.uid()))
}

#[cfg(not(unix))]
fn account_number() -> Option<String> {
    None
}
