//! Logs of simulated sessions. The same header always gives the same recording, so a complete recording is kept and
//! only read, and an incomplete recording is replaced. Several programs may simulate into one folder; each recording is
//! written by one of them.

use std::fs;
use std::path::{Path, PathBuf};

use crate::files::file_error::read_regular;
use crate::log::lock::RecordingLock;
use crate::log::reader::{ends_in_header, first_line_of};
use crate::log::writer::is_written_settings;
use crate::log::{LOG_NAME, LogReader, LogWriter, RecordingWriteError, SETTINGS_NAME, move_aside};
use crate::{Event, LogHeader};

#[derive(Debug)]
pub enum SimulatedLogState {
    /// A new log has to be written.
    Begun {
        log: Box<LogWriter>,
        /// New path of an old log that ended within its header.
        moved: Option<PathBuf>,
    },
    /// The recording exists and is complete.
    Whole,
}

impl SimulatedLogState {
    /// Starts the recording, unless it exists and is complete.
    pub fn open(folder: &Path, header: &LogHeader) -> Result<SimulatedLogState, RecordingWriteError> {
        // A complete recording is not locked, so that several programs can read it at once.
        if is_whole(folder, header) {
            return Ok(SimulatedLogState::Whole);
        }
        fs::create_dir_all(folder).map_err(|reason| RecordingWriteError::unwritable(folder, reason))?;
        let lock = RecordingLock::take(folder)?;
        check_simulated(folder, header)?;
        // The previous holder of the lock may have completed the recording.
        if is_whole(folder, header) {
            return Ok(SimulatedLogState::Whole);
        }
        let path = folder.join(LOG_NAME);
        let moved = match is_without_header(&path) {
            true => move_aside(&path).map_err(|reason| RecordingWriteError::unwritable(&path, reason))?,
            false => None,
        };
        let log = LogWriter::begin(lock, folder.to_path_buf(), header, false)?;
        Ok(SimulatedLogState::Begun { log: Box::new(log), moved })
    }
}

/// A simulation may replace a recording with the same header, and a log that ends within its header.
pub fn check_simulated(folder: &Path, header: &LogHeader) -> Result<(), RecordingWriteError> {
    let path = folder.join(LOG_NAME);
    let taken = |what: &str| Err(RecordingWriteError::Taken { folder: folder.to_path_buf(), what: what.to_string() });
    if !path.exists() {
        // A program that was killed before it wrote the log leaves a settings file behind.
        let is_foreign = read_regular(&folder.join(SETTINGS_NAME)).is_ok_and(|text| !is_written_settings(&text));
        return if is_foreign { taken("a session.toml that tomcom did not write") } else { Ok(()) };
    }
    if is_without_header(&path) {
        return Ok(());
    }
    match LogReader::open(folder).map(|log| log.header) {
        Ok(there) if there == *header => Ok(()),
        Ok(there) if there.started.is_some() => taken("a live recording"),
        Ok(_) => taken("the recording of another session"),
        Err(error) => taken(&format!("a recording that cannot be read ({})", error.with_remedy())),
    }
}

fn is_without_header(path: &Path) -> bool {
    first_line_of(path).is_ok_and(|line| ends_in_header(&line))
}

/// Whether the folder contains the complete recording with this header.
fn is_whole(folder: &Path, header: &LogHeader) -> bool {
    let is_same = |log: LogReader| {
        let last = log.last_event().ok().flatten();
        log.header == *header && last.is_some_and(|last| last.event == Event::SessionEnded)
    };
    folder.join(LOG_NAME).exists() && LogReader::open(folder).is_ok_and(is_same)
}
