//! Whether analyses count a recording: its trial can be aborted or excluded at the console, or excluded later from the
//! command line.

use std::path::Path;

use crate::analysis::recording_summary::ExclusionStatus;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::{ExclusionRecord, LogReader, ruling};
use tomcom_session::{Event, Session, apply};

/// Reason for which the trial of a recording was aborted; `None` if the trial was not aborted.
pub fn aborted(recording: &Path) -> FileResult<Option<String>> {
    let mut log = LogReader::open(recording)?;
    while let Some(line) = log.next_line()? {
        if let Event::TrialAborted { reason } = line.stamped.event {
            return Ok(Some(reason));
        }
    }
    Ok(None)
}

/// A later decision in a file beside the log overrides the log. Errors: that file is damaged.
pub fn exclusion_status(session: &Session, log: &LogReader) -> FileResult<ExclusionStatus> {
    with_ruling(ExclusionStatus::at_console(session), log.folder())
}

/// In words; `None` for a recording that counts.
pub fn left_out(recording: &Path) -> FileResult<Option<String>> {
    let mut log = LogReader::open(recording)?;
    let mut session = log.session();
    while let Some(line) = log.next_line()? {
        apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?;
    }
    Ok(exclusion_status(&session, &log)?.left_out(&session, log.ending()))
}

/// A later decision in a file in this folder overrides the status. Errors: that file is damaged.
pub fn with_ruling(at_console: ExclusionStatus, folder: &Path) -> FileResult<ExclusionStatus> {
    Ok(match ruling(folder)? {
        Some(ExclusionRecord { excluded, reason, .. }) => {
            ExclusionStatus { excluded: excluded.then_some(reason), ..at_console }
        }
        None => at_console,
    })
}
