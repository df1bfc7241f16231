//! The file `exclusion.toml` beside a closed log: whether the trial is excluded from the analysis, and why. Exclusions
//! at the console are events in the log instead.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::decision_file::{self, DecisionError, check_last_part, check_reason};
use super::{LogReader, RecordingLock};
use crate::Event;
use crate::files::file_error::FileResult;
use crate::files::wall_time::WallTime;

/// Name of the exclusion file in the folder of a recording.
pub const EXCLUSION_NAME: &str = "exclusion.toml";

/// Decision to exclude a closed recording from the analysis, or to include it again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExclusionRecord {
    /// Whether the recording is excluded from the analysis; false if it is included again.
    pub excluded: bool,
    /// Reason of the decision; may be empty if the decision includes the recording again.
    #[serde(default)]
    pub reason: String,
    /// Time of the decision about the recording (UTC, RFC 3339).
    pub at: String,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rulings {
    #[serde(default)]
    ruling: Vec<ExclusionRecord>,
}

/// The last decision about the recording in this folder, if there is any.
///
/// # Errors
/// The file exists but cannot be read, or has other content.
pub fn ruling(folder: &Path) -> FileResult<Option<ExclusionRecord>> {
    Ok(rulings(folder)?.ruling.pop())
}

fn rulings(folder: &Path) -> FileResult<Rulings> {
    let remedy = "[[ruling]] with excluded, reason and at, as tomcom exclude writes it";
    decision_file::read(&folder.join(EXCLUSION_NAME), remedy)
}

/// Records a decision about whether analyses count a closed recording, and returns the decision.
///
/// # Errors
/// The folder is not a recording, the recording is being written or is continued by a later part, or its folder cannot
/// be written to; or a recording is to be included again that is not excluded.
pub fn rule(recording: &Path, excluded: bool, reason: &str) -> Result<ExclusionRecord, DecisionError> {
    check_reason(reason, !excluded)?;
    let mut log = LogReader::open(recording)?;
    let folder = &log.folder().to_path_buf();
    let _lock = RecordingLock::take(folder)?;
    check_last_part(folder)?;
    let mut all = rulings(folder)?;
    if !excluded {
        let mut is_excluded = false;
        while let Some(line) = log.next_line()? {
            match line.stamped.event {
                Event::TrialExcluded { .. } => is_excluded = true,
                Event::TrialIncluded => is_excluded = false,
                _ => {}
            }
        }
        if !all.ruling.last().map_or(is_excluded, |ruling| ruling.excluded) {
            let found = format!("no exclusion of {}", recording.display());
            return Err(DecisionError::Unfit { found, remedy: "a recording that is excluded".to_string() });
        }
    }
    let ruling = ExclusionRecord { excluded, reason: reason.to_string(), at: WallTime::now().rfc3339() };
    all.ruling.push(ruling.clone());
    decision_file::write(&folder.join(EXCLUSION_NAME), &all)?;
    Ok(ruling)
}
