//! Writer of recordings: creates the folder, the settings file and the log, and appends events to the log.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::ser::Formatter;

use super::guarded::GuardedFile;
use super::lock::{LOCK_NAME, RecordingLock, is_same};
use super::{LOG_NAME, RecordingWriteError, SETTINGS_NAME, move_aside};
use crate::files::file_error::read_regular;
use crate::files::replace_file::{self, new_beside, replaced_name};
use crate::files::rescue::{RescueNote, new_rescue_folder};
use crate::{LogHeader, SessionSpec, TimestampedEvent};
use tomcom_core::base::time::SessionTime;

/// Longest time, in session time, for which gaze samples are held back before they are handed to the operating system.
const FLUSH_AFTER: SessionTime = SessionTime(50_000_000);
/// Largest number of bytes that are handed on at once: less than the buffer, so that they are taken as a whole or not at
/// all.
const PIECE: usize = 1 << 14;
/// Suffix of the folders of later parts: `<recording>-part2`, `<recording>-part3`, …
const PART: &str = "-part";

/// Writer of the log of a session, one event per line.
#[derive(Debug)]
pub struct LogWriter {
    folder: PathBuf,
    path: PathBuf,
    out: BufWriter<GuardedFile>,
    /// Bytes of the last event that `out` has not taken, since the log could not be written.
    left: Vec<u8>,
    /// Whether events are handed to the operating system at once, because other programs rely on them.
    prompt: bool,
    flushed_at: SessionTime,
    settings: String,
    /// Original folder of the recording, which stays the same even if the folder is moved or deleted.
    home: PathBuf,
    lock: RecordingLock,
}

impl LogWriter {
    /// Starts a live recording `<date>-<participant>-<n>` in `root`, with the first free n. Events are handed to the
    /// operating system at once, gaze samples within 50 ms of session time or by [`LogWriter::flush`].
    pub fn create_live(root: &Path, date: &str, header: &LogHeader) -> Result<LogWriter, RecordingWriteError> {
        fs::create_dir_all(root).map_err(|reason| RecordingWriteError::unwritable(root, reason))?;
        let mut n = 1;
        loop {
            let folder = root.join(format!("{date}-{}-{n}", header.session.participant.code));
            match fs::create_dir(&folder) {
                Ok(()) => return LogWriter::begin(RecordingLock::take(&folder)?, folder, header, true),
                Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => n += 1,
                Err(reason) => return Err(RecordingWriteError::unwritable(folder, reason)),
            }
        }
    }

    /// Starts the live recording that continues the recording in `folder`, in a folder beside it.
    ///
    /// # Errors
    /// The recording has already been continued, or cannot be written.
    pub fn create_part(folder: &Path, header: &LogHeader) -> Result<LogWriter, RecordingWriteError> {
        check_continued(folder)?;
        let part = next_part(folder);
        fs::create_dir_all(&part).map_err(|reason| RecordingWriteError::unwritable(&part, reason))?;
        LogWriter::begin(RecordingLock::take(&part)?, part, header, true)
    }

    /// Creates the log file. The file gets its name when its header is complete, so that no log lacks a header after a
    /// crash.
    pub(super) fn begin(
        lock: RecordingLock,
        folder: PathBuf,
        header: &LogHeader,
        prompt: bool,
    ) -> Result<LogWriter, RecordingWriteError> {
        let path = folder.join(LOG_NAME);
        let failed = |reason| RecordingWriteError::unwritable(&path, reason);
        let settings = toml::to_string(&header.session).map_err(|error| failed(io::Error::other(error)))?;
        replace_file::put(&folder.join(SETTINGS_NAME), settings.as_bytes()).map_err(failed)?;
        // The log file is opened for reading, too, since it has to be read if its folder vanishes.
        let (file, begun) = new_beside(&path).map_err(failed)?.into_parts();
        let file = if prompt { GuardedFile::guarded(file, &folder) } else { GuardedFile::unguarded(file) };
        let mut out = BufWriter::with_capacity(1 << 16, file);
        line(header).and_then(|line| out.write_all(&line)).and_then(|()| out.flush()).map_err(failed)?;
        begun.persist(&path).map_err(|error| failed(error.error))?;
        let home = fs::canonicalize(&folder).unwrap_or_else(|_| folder.clone());
        let (left, flushed_at) = (Vec::new(), SessionTime::ZERO);
        Ok(LogWriter { folder, path, out, left, prompt, flushed_at, settings, home, lock })
    }

    /// Folder of the recording that is being written.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes the network address at which viewers can watch into the lock file.
    pub fn announce(&mut self, viewers: &str) {
        // An address that cannot be written into the lock file has no further consequences.
        let _ = self.lock.announce(viewers);
    }

    /// Appends an event to the log.
    ///
    /// # Errors
    /// The log cannot be written. Once there is room on a full disk, [`LogWriter::flush`] writes the event.
    pub fn append(&mut self, stamped: &TimestampedEvent) -> Result<(), RecordingWriteError> {
        let written = line(stamped).and_then(|line| {
            self.left.extend(line);
            self.hand_on()
        });
        written.map_err(|reason| RecordingWriteError::unwritable(&self.path, reason))?;
        let waits = stamped.event.is_sample() && stamped.time - self.flushed_at < FLUSH_AFTER;
        if self.prompt && !waits {
            self.flushed_at = stamped.time;
            self.flush()?;
        }
        Ok(())
    }

    /// Hands all events that were held back to the operating system.
    pub fn flush(&mut self) -> Result<(), RecordingWriteError> {
        let flushed = self.hand_on().and_then(|()| self.out.flush());
        flushed.map_err(|reason| RecordingWriteError::unwritable(&self.path, reason))
    }

    /// Hands the bytes of the last event on to the buffer, which writes them if it is full.
    fn hand_on(&mut self) -> io::Result<()> {
        while !self.left.is_empty() {
            let piece = self.left.len().min(PIECE);
            self.out.write_all(&self.left[..piece])?;
            self.left.drain(..piece);
        }
        Ok(())
    }

    /// Checks that the log is still at its place and undamaged: an open file accepts every event even after it was
    /// deleted, moved, cut, overwritten or made read-only. If the log is not, the recording is saved into a folder of
    /// the same name: at its place, or else below the system's folder for temporary files. Every check compares a part
    /// of the log with what was written, or `whole`, all of it.
    ///
    /// # Errors
    /// The log is gone or damaged, or must not be written any more.
    pub fn check(&mut self, whole: bool) -> Result<(), RecordingWriteError> {
        if !is_same(self.out.get_ref().file(), &self.path) {
            let found = if self.path.exists() { "another file took its place" } else { "its folder was removed" };
            let reason = io::Error::new(io::ErrorKind::NotFound, found);
            return Err(RecordingWriteError::Unwritable { path: self.path.clone(), reason, saved: self.rescue(false) });
        }
        if let Some(found) = self.out.get_mut().damage(whole) {
            return Err(RecordingWriteError::Damaged { path: self.path.clone(), found, saved: self.rescue(true) });
        }
        let is_readonly = |path: &Path| fs::metadata(path).is_ok_and(|data| data.permissions().readonly());
        match is_readonly(&self.path) || is_readonly(&self.folder) {
            true => {
                let reason = io::Error::new(io::ErrorKind::ReadOnlyFilesystem, "its folder is read-only");
                Err(RecordingWriteError::unwritable(&self.path, reason))
            }
            false => Ok(()),
        }
    }

    /// Saves the recording into another folder; returns the folder that contains the recording now.
    fn rescue(&mut self, is_damaged: bool) -> Option<PathBuf> {
        // Events that cannot be handed to the operating system now have not been acknowledged.
        let _ = self.out.flush();
        let name = self.folder.file_name()?.to_owned();
        if self.save_to(&self.folder.clone(), is_damaged).is_ok() {
            return Some(self.folder.clone());
        }
        let elsewhere = new_rescue_folder().ok()?.join(name);
        self.save_to(&elsewhere, is_damaged).ok()?;
        // The recording is saved by now; the note only helps to find its original place later.
        let _ = RescueNote { home: self.home.clone().into() }.write(&elsewhere);
        Some(elsewhere)
    }

    fn save_to(&mut self, folder: &Path, is_damaged: bool) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let log = folder.join(LOG_NAME);
        let mut saved = new_beside(&log)?;
        self.out.get_mut().save(is_damaged, saved.as_file_mut())?;
        // An existing settings file is kept, since the log contains all settings, too.
        match OpenOptions::new().write(true).create_new(true).open(folder.join(SETTINGS_NAME)) {
            Ok(mut file) => file.write_all(self.settings.as_bytes())?,
            Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => {}
            Err(reason) => return Err(reason),
        }
        move_aside(&log)?;
        saved.persist(&log)?;
        Ok(())
    }
}

/// Checks that the recording in this folder has not been continued yet.
///
/// # Errors
/// The recording has already been continued.
pub fn check_continued(folder: &Path) -> Result<(), RecordingWriteError> {
    let part = next_part(folder);
    match part.join(LOG_NAME).exists() {
        true => Err(RecordingWriteError::Continued { folder: folder.to_path_buf(), part }),
        false => Ok(()),
    }
}

/// Folder of the part after the one in `folder`: the first folder that has a log, or into which a part can be written
/// without losing anything.
fn next_part(folder: &Path) -> PathBuf {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let numbered = name.rsplit_once(PART).and_then(|(first, n)| Some((first, n.parse::<u64>().ok()?)));
    let (first, mut n) = numbered.unwrap_or((&name, 1));
    loop {
        n = n.saturating_add(1);
        let part = folder.with_file_name(format!("{first}{PART}{n}"));
        if part.join(LOG_NAME).exists() || holds_nothing(&part) {
            return part;
        }
    }
}

/// Whether a folder does not exist, or contains only a part whose program was killed before it wrote a log.
fn holds_nothing(part: &Path) -> bool {
    let is_left = |entry: io::Result<fs::DirEntry>| {
        // The program makes no links and pipes, and follows none.
        let entry = entry.ok().filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
        entry.is_some_and(|entry| match entry.file_name().to_str() {
            Some(SETTINGS_NAME) => read_regular(&entry.path()).is_ok_and(|text| is_written_settings(&text)),
            Some(name) => name == LOCK_NAME || is_begun(name),
            None => false,
        })
    };
    match fs::symlink_metadata(part) {
        Ok(data) => data.is_dir() && fs::read_dir(part).is_ok_and(|mut entries| entries.all(is_left)),
        Err(reason) => reason.kind() == io::ErrorKind::NotFound,
    }
}

/// Whether a file of this name is a log or a settings file that a program was writing when it was killed.
fn is_begun(name: &str) -> bool {
    [LOG_NAME, SETTINGS_NAME].iter().any(|whole| name != *whole && replaced_name(name) == *whole)
}

/// Whether this program wrote a settings file in the folder of a recording: it has all settings and nothing else.
pub fn is_written_settings(text: &str) -> bool {
    let spec = toml::from_str::<SessionSpec>(text).ok();
    spec.and_then(|spec| toml::to_string(&spec).ok()).is_some_and(|written| written == text)
}

/// A line of the log, with its line end.
fn line(value: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut line = Vec::with_capacity(256);
    value.serialize(&mut serde_json::Serializer::with_formatter(&mut line, FiniteNumbers))?;
    line.push(b'\n');
    Ok(line)
}

/// JSON serialiser that rejects `null`: in a log, only numbers that are not finite would become `null`, and a log with
/// a `null` could not be read.
struct FiniteNumbers;

impl Formatter for FiniteNumbers {
    fn write_null<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        Err(io::Error::new(io::ErrorKind::InvalidData, "a number in it is not finite"))
    }
}
