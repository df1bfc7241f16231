//! The file `consensus.csv` beside a log: codes of errors on which two raters agree, or which they decided together,
//! each with the code that each rater had given before. The raters' own files are not changed.

use std::io::ErrorKind;
use std::path::Path;

use crate::files::file_error::{FileError, FileResult, MAX_TEXT, read_bytes};
use crate::files::replace_file;
use crate::log::RecordingWriteError;
use crate::log::decisions::check_single;
use crate::log::rater_codes::{cells, code_of, rows, table_bytes, text_of, wrong_line};
use crate::person_code;
use tomcom_core::measures::raters::{CodableErrors, ConsensusCode, ErrorCauseCode, RaterConsensus};

pub const CONSENSUS_NAME: &str = "consensus.csv";

/// The code of each rater, then the press and the shared code.
const COLUMNS: [&str; 9] =
    ["rater_1", "cause_1", "aspect_1", "rater_2", "cause_2", "aspect_2", "press", "cause", "aspect"];

/// `None` if nothing is settled; an error if the file has what cannot be about this recording.
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
        let own = |at: usize| own(&before[at], &before[at + 1]).map_err(|(found, remedy)| wrong(found, remedy));
        let settled = ConsensusCode { code, from: [own(1)?, own(4)?] };
        if let Some(remedy) = settled.fault() {
            return Err(wrong(format!("press {press} with another cause than the one that both raters gave"), remedy));
        }
        if into.settled.insert(press, settled).is_some() {
            return Err(wrong(format!("press {press} again"), "one line for a press"));
        }
    }
    Ok(consensus)
}

/// `None` if the cells are empty.
fn own(cause: &str, aspect: &str) -> Result<Option<ErrorCauseCode>, (String, &'static str)> {
    match (cause, aspect) {
        ("", "") => Ok(None),
        _ => code_of(cause, aspect).map(Some),
    }
}

/// Programs that read the file meanwhile find the old one or the new one.
pub fn write(folder: &Path, consensus: &RaterConsensus) -> Result<(), RecordingWriteError> {
    let rows = consensus.settled.iter().map(|(press, settled)| {
        let [one, other] = consensus.raters.clone();
        let from = settled.from.each_ref().map(|code| code.as_ref().map(cells).unwrap_or_default());
        let ([[cause_1, aspect_1], [cause_2, aspect_2]], [cause, aspect]) = (from, cells(&settled.code));
        [one, cause_1, aspect_1, other, cause_2, aspect_2, press.to_string(), cause, aspect]
    });
    let path = folder.join(CONSENSUS_NAME);
    let written = table_bytes(COLUMNS, rows).and_then(|bytes| replace_file::replace(&path, &bytes));
    written.map_err(|reason| RecordingWriteError::unwritable(&path, reason))
}
