//! Simulated recordings: the same header gives the same recording, so one that is there whole is read, and one that is not
//! is made again. Several programs may fill a folder; each recording is written by one of them.

use std::fs;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::lock::RecordingLock;
use super::reader::{ends_in_header, first_line};
use super::writer::is_written_settings;
use super::{LOG_NAME, LogReader, LogWriter, SETTINGS_NAME, WriteError, move_aside};
use crate::edge::file_error::open_regular;
use crate::session::{Event, Header, Stamped};

/// The last line of a whole log is shorter, in bytes.
const LAST: u64 = 256;

/// What comes of asking for the log of a simulated session.
#[derive(Debug)]
pub enum SimulatedLog {
    /// It is to be written.
    Begun {
        /// The log to write to.
        log: Box<LogWriter>,
        /// Where a log went that ended before the end of its header.
        moved: Option<PathBuf>,
    },
    /// It is there, whole.
    Whole,
}

impl SimulatedLog {
    /// Begins the recording in this folder, unless it is there already.
    ///
    /// # Errors
    /// Those of [`check_simulated`]; another program writes it just now; or the folder cannot be written to.
    pub fn open(folder: &Path, header: &Header) -> Result<SimulatedLog, WriteError> {
        // Where it is whole nothing is locked: others may be reading it.
        if is_whole(folder, header) {
            return Ok(SimulatedLog::Whole);
        }
        fs::create_dir_all(folder).map_err(|reason| WriteError::unwritable(folder, reason))?;
        let lock = RecordingLock::take(folder)?;
        check_simulated(folder, header)?;
        // Whoever had the lock before may have brought it to its end.
        if is_whole(folder, header) {
            return Ok(SimulatedLog::Whole);
        }
        let path = folder.join(LOG_NAME);
        let moved = match is_without_header(&path) {
            true => move_aside(&path).map_err(|reason| WriteError::unwritable(&path, reason))?,
            false => None,
        };
        let log = LogWriter::begin(lock, folder.to_path_buf(), header, false)?;
        Ok(SimulatedLog::Begun { log: Box::new(log), moved })
    }
}

/// Whether a simulated recording may go into this folder: the same header gives the same recording, which may be
/// replaced; any other one may not. A log that ends before the end of its header may be moved aside.
///
/// # Errors
/// Another recording is there.
pub fn check_simulated(folder: &Path, header: &Header) -> Result<(), WriteError> {
    let path = folder.join(LOG_NAME);
    if !path.exists() {
        // A kill before the log leaves settings behind.
        let is_foreign = fs::read_to_string(folder.join(SETTINGS_NAME)).is_ok_and(|text| !is_written_settings(&text));
        let what = "a session.toml that tomcom did not write";
        return if is_foreign { Err(WriteError::Taken { folder: folder.to_path_buf(), what }) } else { Ok(()) };
    }
    if is_without_header(&path) {
        return Ok(());
    }
    let what = match LogReader::open(folder).map(|log| log.header) {
        Ok(there) if there == *header => return Ok(()),
        Ok(there) if there.started.is_some() => "a live recording",
        Ok(_) => "the recording of another session",
        Err(_) => "a recording that cannot be read",
    };
    Err(WriteError::Taken { folder: folder.to_path_buf(), what })
}

/// Whether a log is as a power failure leaves one that was just begun.
fn is_without_header(path: &Path) -> bool {
    let line = open_regular(path).and_then(|file| first_line(&mut BufReader::new(file)));
    line.is_ok_and(|line| ends_in_header(&line))
}

/// Whether the simulated recording of this header is in this folder, whole: with the end of its session.
fn is_whole(folder: &Path, header: &Header) -> bool {
    let ends = || -> io::Result<bool> {
        let mut log = open_regular(&folder.join(LOG_NAME))?;
        let length = log.seek(SeekFrom::End(0))?;
        log.seek(SeekFrom::Start(length.saturating_sub(LAST)))?;
        let mut end = Vec::new();
        log.read_to_end(&mut end)?;
        let end = String::from_utf8_lossy(&end);
        let last = end.strip_suffix('\n').and_then(|lines| lines.rsplit('\n').next());
        let last = last.and_then(|line| serde_json::from_str::<Stamped>(line).ok());
        Ok(last.is_some_and(|last| last.event == Event::SessionEnded))
    };
    ends().unwrap_or(false) && LogReader::open(folder).is_ok_and(|log| log.header == *header)
}
