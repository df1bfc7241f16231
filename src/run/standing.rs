//! Whether a recording counts: aborted at the console, excluded there or later from the command line, or neither.

use std::path::Path;

use serde::Serialize;

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

/// What was said about a trial. An analysis leaves out what does not count.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ExclusionStatus {
    /// Why it was aborted; null: it was not.
    pub aborted: Option<String>,
    /// Why it is excluded; null: it is not.
    pub excluded: Option<String>,
}

impl ExclusionStatus {
    /// That of a recording that was read to its end. What was said later, beside the log, holds before what is in it.
    ///
    /// # Errors
    /// The file beside the log is broken.
    pub fn from_recording(session: &Session, log: &LogReader) -> FileResult<ExclusionStatus> {
        let at_console = ExclusionStatus::at_console(session);
        Ok(match ruling(log.folder())? {
            Some(ExclusionRecord { excluded, reason, .. }) => {
                ExclusionStatus { excluded: excluded.then_some(reason), ..at_console }
            }
            None => at_console,
        })
    }

    /// As it was said at the console.
    pub fn at_console(session: &Session) -> ExclusionStatus {
        ExclusionStatus { aborted: session.aborted.clone(), excluded: session.excluded.clone() }
    }

    /// Whether the analysis takes it.
    pub fn counts(&self) -> bool {
        self.aborted.is_none() && self.excluded.is_none()
    }

    /// For people; empty for what counts.
    pub fn describe(&self) -> String {
        let said = |word: &str, reason: &Option<String>| reason.as_ref().map(|reason| format!("{word}: {reason}"));
        let both = [said("aborted", &self.aborted), said("excluded", &self.excluded)];
        both.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
