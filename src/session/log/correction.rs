//! The file `correction.toml` beside a closed log: to which participant the recording belongs, if the code was typed
//! wrong when the session began.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::decision_file;
use crate::LogHeader;
use crate::code_correction::CodeCorrection;
use crate::files::file_error::FileResult;

/// Name of the file with corrections in the folder of a recording.
pub const CORRECTION_NAME: &str = "correction.toml";

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Corrections {
    #[serde(default)]
    pub correction: Vec<CodeCorrection>,
}

/// All corrections in the folder of a log; none if there is no file with corrections.
///
/// # Errors
/// The file exists but cannot be read, or has other content.
pub(super) fn corrections(folder: &Path) -> FileResult<Corrections> {
    let remedy = "[[correction]] with before, after, why, by and at, as tomcom correct writes it";
    decision_file::read(&folder.join(CORRECTION_NAME), remedy)
}

/// The participant's code in a log's header after the corrections in the folder of the log, and the correction that
/// holds; `None` if the recorded code is right.
///
/// # Errors
/// The file with corrections exists but cannot be read, or has other content.
pub fn corrected_code(folder: &Path, recorded: &str) -> FileResult<Option<CodeCorrection>> {
    let last = corrections(folder)?.correction.pop();
    // A correction that was taken back leads to the recorded code.
    let last = last.filter(|last| last.after != recorded);
    Ok(last.map(|last| CodeCorrection { before: recorded.to_string(), ..last }))
}

/// Applies the corrections in the folder of a log to the log's header.
pub(super) fn correct_header(folder: &Path, header: &mut LogHeader) -> FileResult<()> {
    let code = &mut header.session.participant.code;
    header.correction = corrected_code(folder, code)?;
    if let Some(correction) = &header.correction {
        code.clone_from(&correction.after);
    }
    Ok(())
}
