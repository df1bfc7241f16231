//! Corrects the code of a closed recording's participant, in the file that [`super::correction`] reads.

use std::fs;
use std::io::BufReader;
use std::path::Path;

use super::correction::{CORRECTION_NAME, corrections};
use super::decision_file::{self, DecisionError, check_last_part, check_reason};
use super::{LOG_NAME, LogReader, RecordingLock, first_line, read_header};
use crate::LogHeader;
use crate::code_correction::CodeCorrection;
use crate::files::file_error::{FileResult, open_regular};
use crate::files::wall_time::WallTime;
use crate::person_code;

/// Records that a closed recording belongs to the participant with another code; `None`: to that with the code in its
/// log, after all. The correction is written beside the log of each part, since each part says whose it is. Returns the
/// correction.
///
/// # Errors
/// The folder is not a recording, the recording is being written or is continued by a later part, its folder cannot be
/// written to; the code is no code of a participant, is the present one, or differs from that of a recording in the same
/// folder in capital letters only.
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
        decision_file::write(&folder.join(CORRECTION_NAME), &all)?;
    }
    drop(locks);
    Ok(correction)
}

/// A recording beside this one whose participant's code differs from a code in capital letters only, with its code.
/// Neighbours whose headers cannot be read are reported when they are read.
fn differing_neighbour(recording: &Path, own: &[&Path], code: &str) -> Option<(String, String)> {
    let recording = recording.canonicalize().ok()?;
    let is_own = |folder: &Path| {
        folder == recording || own.iter().any(|part| part.canonicalize().is_ok_and(|part| part == folder))
    };
    let neighbours = fs::read_dir(recording.parent()?).ok()?.flatten();
    neighbours.filter(|entry| !is_own(&entry.path())).find_map(|entry| {
        let log = entry.path().join(LOG_NAME);
        let line = open_regular(&log).and_then(|file| first_line(&mut BufReader::new(file))).ok()?;
        let other = read_header(&log, String::from_utf8_lossy(&line).trim_end()).ok()?.session.participant.code;
        person_code::differing_in_case(code, [other.as_str()])?;
        Some((entry.file_name().to_string_lossy().into_owned(), other))
    })
}

/// The account on this computer that runs the program, by its name, or else by its number; empty if neither is known.
fn account() -> String {
    let is_named = |name| std::env::var(name).ok().filter(|name| !name.is_empty());
    let named = ["USER", "LOGNAME", "USERNAME"].into_iter().find_map(is_named);
    named.or_else(account_number).unwrap_or_default()
}

/// The number of the account: that of the owner of a file that the program makes.
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
