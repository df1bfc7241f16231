//! Whether a recording counts: aborted at the console, excluded there or later from the command line, or neither.

use std::path::Path;

use crate::analysis::exclusion_status::ExclusionStatus;
use crate::edge::file_error::FileResult;
use crate::edge::log::{ExclusionRecord, LogReader, ruling};
use crate::session::{Event, Session};

/// Why the trial of a recording was aborted, if it was.
///
/// # Errors
/// Those of reading a log.
pub fn aborted(recording: &Path) -> FileResult<Option<String>> {
    let mut log = LogReader::open(recording)?;
    while let Some(line) = log.next_line()? {
        if let Event::TrialAborted { reason } = line.stamped.event {
            return Ok(Some(reason));
        }
    }
    Ok(None)
}

/// Whether a recording counts that was read to its end. What was said later, beside the log, holds before what is in it.
///
/// # Errors
/// The file beside the log is broken.
pub fn exclusion_status(session: &Session, log: &LogReader) -> FileResult<ExclusionStatus> {
    let at_console = ExclusionStatus::at_console(session);
    Ok(match ruling(log.folder())? {
        Some(ExclusionRecord { excluded, reason, .. }) => {
            ExclusionStatus { excluded: excluded.then_some(reason), ..at_console }
        }
        None => at_console,
    })
}
