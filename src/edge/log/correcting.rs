//! Corrects the code of a closed recording's participant, in the file that [`super::correction`] reads.

use std::path::Path;

use super::correction::{CORRECTION_NAME, corrections};
use super::decision_file::{self, DecisionError, check_reason};
use super::{LogReader, RecordingLock, check_continued};
use crate::edge::clock::WallTime;
use crate::edge::file_error::FileResult;
use crate::session::LogHeader;
use crate::session::code_correction::CodeCorrection;
use crate::session::person_code;

/// Records that a closed recording belongs to the participant with another code; `None`: to that with the code in its
/// log, after all. The correction is written beside the log of each part, since each part says whose it is. Returns the
/// correction.
///
/// # Errors
/// The folder is not a recording, the recording is being written or is continued by a later part, its folder cannot be
/// written to, the code is no code of a participant or is the present one.
pub fn correct(recording: &Path, code: Option<&str>, why: &str) -> Result<CodeCorrection, DecisionError> {
    check_reason(why, code.is_none())?;
    let log = LogReader::open(recording)?;
    let parts = log.logs();
    let folders: Vec<&Path> = parts.iter().map(|log| log.parent().unwrap_or(Path::new(""))).collect();
    let locks = folders.iter().map(|folder| RecordingLock::take(folder)).collect::<Result<Vec<_>, _>>()?;
    check_continued(log.folder())?;
    let wrong = |found: String, remedy: &str| Err(DecisionError::Code { found, remedy: remedy.to_string() });
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
    let by = ["USER", "LOGNAME", "USERNAME"].into_iter().find_map(|name| std::env::var(name).ok()).unwrap_or_default();
    let (after, why, at) = (after.to_string(), why.to_string(), WallTime::now().rfc3339());
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
