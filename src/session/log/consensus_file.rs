//! The file `consensus.csv` beside a log: codes of errors on which two raters agree, or which they decided together,
//! each with the code that each rater had given before. The raters' own files are not changed.

use std::io::ErrorKind;
use std::path::Path;

use super::RecordingWriteError;
use super::decision_file::check_single;
use super::rater_codes::{code_of, rows, text_of, wrong_line};
use crate::files::file_error::{FileError, FileResult, MAX_TEXT, read_bytes};
use crate::files::replace_file;
use crate::person_code;
use tomcom_core::measures::raters::{CodableErrors, ErrorCauseCode};
use tomcom_core::measures::raters::{ConsensusCode, RaterConsensus};

/// Name of the consensus file in the folder of a recording.
pub const CONSENSUS_NAME: &str = "consensus.csv";

/// Columns of the consensus file: the code of each rater, then the press and the shared code.
const COLUMNS: [&str; 9] =
    ["rater_1", "cause_1", "aspect_1", "rater_2", "cause_2", "aspect_2", "press", "cause", "aspect"];

/// The raters' consensus about the recording in this folder; `None` if nothing is settled.
///
/// # Errors
/// The file exists but cannot be read, or contains something that cannot be about this recording.
pub fn read(folder: &Path, codable: &CodableErrors) -> FileResult<Option<RaterConsensus>> {
    let path = folder.join(CONSENSUS_NAME);
    check_single(folder, CONSENSUS_NAME)?;
    let bytes = match read_bytes(&path, MAX_TEXT) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(reason) => return Err(FileError::unreadable(&path, reason, "a readable text file (UTF-8)")),
    };
    let text = text_of(&path, bytes)?;
    let mut consensus: Option<RaterConsensus> = None;
    for (line, before, press, code) in rows(&path, &text, &COLUMNS)? {
        let wrong = |found: String, remedy: &str| wrong_line(&path, &text, line, found, remedy);
        if let Some((found, remedy)) = codable.fault(press, &code) {
            return Err(wrong(found, &remedy));
        }
        let raters = [before[0].as_str(), before[3].as_str()];
        let into = consensus.get_or_insert_with(|| RaterConsensus::new(raters[0], raters[1]));
        if raters.iter().any(|rater| person_code::fault(rater).is_some()) || raters[0] >= raters[1] {
            let found = format!("the raters \"{}\" and \"{}\"", raters[0], raters[1]);
            return Err(wrong(found, "the codes of two raters, in the order of the alphabet"));
        }
        if into.raters != raters {
            let found = format!("the raters {} and {}", raters[0], raters[1]);
            return Err(wrong(found, &format!("{} and {}, as in the lines before", into.raters[0], into.raters[1])));
        }
        let from = [own(&before[1], &before[2]), own(&before[4], &before[5])];
        let from = match from {
            [Ok(one), Ok(other)] => [one, other],
            [Err((found, remedy)), _] | [_, Err((found, remedy))] => return Err(wrong(found, remedy)),
        };
        let settled = ConsensusCode { code, from };
        if let Some(remedy) = settled.fault() {
            return Err(wrong(format!("press {press} with another cause than the one that both raters gave"), remedy));
        }
        if into.settled.insert(press, settled).is_some() {
            return Err(wrong(format!("press {press} again"), "one line for a press"));
        }
    }
    Ok(consensus)
}

/// A rater's own code in a row of the consensus file; `None` if its cells are empty.
fn own(cause: &str, aspect: &str) -> Result<Option<ErrorCauseCode>, (String, &'static str)> {
    match (cause, aspect) {
        ("", "") => Ok(None),
        _ => code_of(cause, aspect).map(Some),
    }
}

/// Writes the consensus file to the disk; programs that read it meanwhile find the old file or the new one.
///
/// # Errors
/// The folder cannot be written to.
pub fn write(folder: &Path, consensus: &RaterConsensus) -> Result<(), RecordingWriteError> {
    let path = folder.join(CONSENSUS_NAME);
    let failed = |reason| RecordingWriteError::unwritable(&path, reason);
    let mut table = csv::Writer::from_writer(Vec::new());
    let mut put = |fields: [&str; 9]| table.write_record(fields).map_err(std::io::Error::from);
    put(COLUMNS).map_err(failed)?;
    let fields = |code: &Option<ErrorCauseCode>| {
        let kind = code.as_ref().map_or("", |code| code.kind().name());
        let aspect = code.as_ref().and_then(ErrorCauseCode::aspect).unwrap_or_default();
        [kind.to_string(), aspect.to_string()]
    };
    for (press, settled) in &consensus.settled {
        let [one, other] = &consensus.raters;
        let [[cause_1, aspect_1], [cause_2, aspect_2]] = settled.from.each_ref().map(fields);
        let [cause, aspect] = fields(&Some(settled.code.clone()));
        let press = press.to_string();
        put([one, &cause_1, &aspect_1, other, &cause_2, &aspect_2, &press, &cause, &aspect]).map_err(failed)?;
    }
    let bytes = table.into_inner().map_err(|error| failed(std::io::Error::other(error.to_string())))?;
    replace_file::replace(&path, &bytes).map_err(failed)
}
