//! Writes recordings.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::ser::Formatter;

use super::lock::{RecordingLock, is_same};
use super::{LOG_NAME, LogReader, SETTINGS_NAME, WriteError};
use crate::base::time::SessionTime;
use crate::session::{Event, Header, Stamped};

/// Gaze samples wait at most so long, in session time, before they are handed to the operating system.
const FLUSH_AFTER: SessionTime = SessionTime(50_000_000);
/// What the folders of later parts are called: `<recording>-part2`, `<recording>-part3`, …
const PART: &str = "-part";

/// Writes the log of a session.
#[derive(Debug)]
pub struct LogWriter {
    folder: PathBuf,
    path: PathBuf,
    out: BufWriter<File>,
    /// Hand events to the operating system as they come, because somebody relies on them.
    prompt: bool,
    flushed_at: SessionTime,
    settings: String,
    lock: RecordingLock,
}

impl LogWriter {
    /// Starts a live recording `<date>-<participant>-<n>` in `root`, with the first n that is free. What is appended is
    /// handed to the operating system at once, gaze within 50 ms of session time or by [`LogWriter::flush`].
    pub fn create_live(root: &Path, date: &str, header: &Header) -> Result<LogWriter, WriteError> {
        fs::create_dir_all(root).map_err(|reason| WriteError::unwritable(root, reason))?;
        let mut n = 1;
        loop {
            let folder = root.join(format!("{date}-{}-{n}", header.session.participant.code));
            match fs::create_dir(&folder) {
                Ok(()) => return LogWriter::begin(folder, header, true),
                Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => n += 1,
                Err(reason) => return Err(WriteError::unwritable(folder, reason)),
            }
        }
    }

    /// Starts the live recording that continues the one in `folder`, in a folder beside it.
    ///
    /// # Errors
    /// It was continued already, or cannot be written.
    pub fn create_part(folder: &Path, header: &Header) -> Result<LogWriter, WriteError> {
        check_continued(folder)?;
        let part = next_part(folder);
        // A part that was killed before it had a log is there already, and continues nothing.
        fs::create_dir_all(&part).map_err(|reason| WriteError::unwritable(&part, reason))?;
        LogWriter::begin(part, header, true)
    }

    /// Starts a simulated recording in this folder.
    ///
    /// # Errors
    /// Those of [`check_simulated`], or the folder cannot be written to.
    pub fn create_simulated(folder: &Path, header: &Header) -> Result<LogWriter, WriteError> {
        check_simulated(folder, header)?;
        fs::create_dir_all(folder).map_err(|reason| WriteError::unwritable(folder, reason))?;
        LogWriter::begin(folder.to_path_buf(), header, false)
    }

    /// The log gets its name when its header is complete, so that no log is without one after a kill.
    fn begin(folder: PathBuf, header: &Header, prompt: bool) -> Result<LogWriter, WriteError> {
        let lock = RecordingLock::take(&folder)?;
        let path = folder.join(LOG_NAME);
        let failed = |reason| WriteError::unwritable(&path, reason);
        let settings = toml::to_string(&header.session).map_err(|error| failed(io::Error::other(error)))?;
        fs::write(folder.join(SETTINGS_NAME), &settings).map_err(failed)?;
        let begun = folder.join(format!("{LOG_NAME}.new"));
        // It is read again if the folder vanishes.
        let file =
            OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&begun).map_err(failed)?;
        let mut out = BufWriter::with_capacity(1 << 16, file);
        write_line(&mut out, header).and_then(|()| out.flush()).map_err(failed)?;
        fs::rename(&begun, &path).map_err(failed)?;
        Ok(LogWriter { folder, path, out, prompt, flushed_at: SessionTime::ZERO, settings, lock })
    }

    /// The folder of the recording.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Tells whoever finds the recording while it is written where viewers can look on.
    pub fn announce(&mut self, viewers: &str) {
        // Nothing depends on it.
        let _ = self.lock.announce(viewers);
    }

    /// Adds an event.
    pub fn append(&mut self, stamped: &Stamped) -> Result<(), WriteError> {
        write_line(&mut self.out, stamped).map_err(|reason| WriteError::unwritable(&self.path, reason))?;
        let waits = stamped.event.is_sample() && stamped.time - self.flushed_at < FLUSH_AFTER;
        if self.prompt && !waits {
            self.flushed_at = stamped.time;
            self.flush()?;
        }
        Ok(())
    }

    /// Hands everything to the operating system.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.out.flush().map_err(|reason| WriteError::unwritable(&self.path, reason))
    }

    /// Looks whether what is written still goes where it should: an open file takes every event, also after it was
    /// deleted, moved away or made read-only. What vanished is saved from the open file, into a folder of the same name:
    /// where it was, or else below the system's folder for temporary files.
    ///
    /// # Errors
    /// The log is gone, or it must not be written any more.
    pub fn check(&mut self) -> Result<(), WriteError> {
        if !is_same(self.out.get_ref(), &self.path) {
            let reason = io::Error::new(io::ErrorKind::NotFound, "its folder was removed");
            return Err(WriteError::Unwritable { path: self.path.clone(), reason, saved: self.rescue() });
        }
        let is_readonly = |path: &Path| fs::metadata(path).is_ok_and(|data| data.permissions().readonly());
        match is_readonly(&self.path) || is_readonly(&self.folder) {
            true => {
                let reason = io::Error::new(io::ErrorKind::ReadOnlyFilesystem, "its folder is read-only");
                Err(WriteError::unwritable(&self.path, reason))
            }
            false => Ok(()),
        }
    }

    /// Copies what was recorded out of the open file; the folder where it is now.
    fn rescue(&mut self) -> Option<PathBuf> {
        // What cannot be handed over any more was not acknowledged for longer than gaze may wait.
        let _ = self.out.flush();
        let name = self.folder.file_name()?;
        let elsewhere = std::env::temp_dir().join(format!("tomcom-rescued-{}", std::process::id())).join(name);
        [self.folder.clone(), elsewhere].into_iter().find(|folder| self.copy_to(folder).is_ok())
    }

    fn copy_to(&mut self, folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let mut copy = OpenOptions::new().write(true).create_new(true).open(folder.join(LOG_NAME))?;
        let log = self.out.get_mut();
        log.rewind()?;
        io::copy(log, &mut copy)?;
        fs::write(folder.join(SETTINGS_NAME), &self.settings)?;
        copy.sync_all()
    }
}

/// Whether the recording in this folder can still be continued.
///
/// # Errors
/// It was continued already.
pub fn check_continued(folder: &Path) -> Result<(), WriteError> {
    let part = next_part(folder);
    match part.join(LOG_NAME).exists() {
        true => Err(WriteError::Continued { folder: folder.to_path_buf(), part }),
        false => Ok(()),
    }
}

/// The folder of the part after the one in `folder`.
fn next_part(folder: &Path) -> PathBuf {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = name.rsplit_once(PART).and_then(|(first, n)| Some((first, n.parse::<u64>().ok()?)));
    let (first, n) = numbered.unwrap_or((&name, 1));
    folder.with_file_name(format!("{first}{PART}{}", n.saturating_add(1)))
}

/// Whether a simulated recording may go into this folder: the same header gives the same recording, which may be
/// replaced; any other one may not.
///
/// # Errors
/// Another recording is there.
pub fn check_simulated(folder: &Path, header: &Header) -> Result<(), WriteError> {
    if !folder.join(LOG_NAME).exists() {
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

/// Whether the simulated recording of this header is in this folder, whole: with the end of its session.
pub fn is_whole(folder: &Path, header: &Header) -> bool {
    /// The last line is shorter, in bytes.
    const LAST: u64 = 256;
    let ends = || -> io::Result<bool> {
        let mut log = File::open(folder.join(LOG_NAME))?;
        let length = log.seek(io::SeekFrom::End(0))?;
        log.seek(io::SeekFrom::Start(length.saturating_sub(LAST)))?;
        let mut end = Vec::new();
        io::Read::read_to_end(&mut log, &mut end)?;
        let end = String::from_utf8_lossy(&end);
        let last = end.strip_suffix('\n').and_then(|lines| lines.rsplit('\n').next());
        let last = last.and_then(|line| serde_json::from_str::<Stamped>(line).ok());
        Ok(last.is_some_and(|last| last.event == Event::SessionEnded))
    };
    ends().unwrap_or(false) && LogReader::open(folder).is_ok_and(|log| log.header == *header)
}

/// Writes a line of the log, or nothing of it.
fn write_line(out: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    let mut line = Vec::with_capacity(256);
    value.serialize(&mut serde_json::Serializer::with_formatter(&mut line, FiniteNumbers))?;
    line.push(b'\n');
    out.write_all(&line)
}

/// JSON without `null`. Nothing in a log is written so but numbers that are not finite, and no log with one can be read.
struct FiniteNumbers;

impl Formatter for FiniteNumbers {
    fn write_null<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        Err(io::Error::new(io::ErrorKind::InvalidData, "a number in it is not finite"))
    }
}
