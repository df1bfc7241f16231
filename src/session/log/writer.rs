//! Writer of recordings: creates the folder, the settings file and the log, and appends events to the log.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::ser::Formatter;

use crate::files::file_error::read_regular;
use crate::files::replace_file::{self, new_beside, replaced_name};
use crate::files::rescue::{RescueNote, new_rescue_folder};
use crate::log::lock::{LOCK_NAME, RecordingLock, is_same};
use crate::log::{LOG_NAME, RRD_NAME, RecordingWriteError, SETTINGS_NAME, move_aside};
use crate::{LogHeader, SessionSpec, TimestampedEvent};
use tomcom_core::base::time::SessionTime;

/// Longest time for which gaze samples are held back before the operating system gets them.
const FLUSH_AFTER: SessionTime = SessionTime(50_000_000);
/// Largest number of bytes handed on at once: less than the buffer, so that they are taken as a whole or not at all.
const PIECE: usize = 1 << 14;
/// Later parts: `<recording>-part2`, `<recording>-part3`, …
const PART: &str = "-part";

#[derive(Debug)]
pub struct LogWriter {
    folder: PathBuf,
    path: PathBuf,
    out: BufWriter<GuardedFile>,
    /// Bytes of the last event that `out` has not taken, since the log could not be written.
    left: Vec<u8>,
    /// Whether the operating system gets events at once, because other programs rely on them.
    prompt: bool,
    flushed_at: SessionTime,
    settings: String,
    /// Original folder, which stays the same even if it is moved or deleted.
    home: PathBuf,
    lock: RecordingLock,
}

impl LogWriter {
    /// Starts the live recording `<date>-<participant>-<n>` in `root`, with the first free n. The operating system gets
    /// events at once, gaze samples within 50 ms of session time or by [`LogWriter::flush`].
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

    /// In a folder beside the recording in `folder`; an error if it has been continued already.
    pub fn create_part(folder: &Path, header: &LogHeader) -> Result<LogWriter, RecordingWriteError> {
        check_continued(folder)?;
        let part = next_part(folder);
        fs::create_dir_all(&part).map_err(|reason| RecordingWriteError::unwritable(&part, reason))?;
        LogWriter::begin(RecordingLock::take(&part)?, part, header, true)
    }

    /// The file gets its name when its header is complete, so that no log lacks a header after a crash.
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
        // The guarding copy is in the system's folder for temporary files, or else beside the log.
        let temporary = || tempfile::tempfile().or_else(|_| tempfile::tempfile_in(&folder)).ok();
        let copy = if prompt { temporary() } else { None };
        let file = GuardedFile { file, copy, length: 0, next: 0, pass_end: 0 };
        let mut out = BufWriter::with_capacity(1 << 16, file);
        line(header).and_then(|line| out.write_all(&line)).and_then(|()| out.flush()).map_err(failed)?;
        begun.persist(&path).map_err(|error| failed(error.error))?;
        let home = fs::canonicalize(&folder).unwrap_or_else(|_| folder.clone());
        let (left, flushed_at) = (Vec::new(), SessionTime::ZERO);
        Ok(LogWriter { folder, path, out, left, prompt, flushed_at, settings, home, lock })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Removes a recording in which nothing happened. Its folder stays if others put something into it.
    pub fn discard(&self) {
        let seal = format!("{RRD_NAME}.toml");
        // What cannot be removed stays, and is listed as empty.
        for name in [LOG_NAME, SETTINGS_NAME, RRD_NAME, &seal, LOCK_NAME] {
            let _ = fs::remove_file(self.folder.join(name));
        }
        let _ = fs::remove_dir(&self.folder);
    }

    pub fn announce(&mut self, viewers: &str) {
        // An address that cannot be written into the lock file has no further consequences.
        let _ = self.lock.announce(viewers);
    }

    /// Once there is room on a full disk, [`LogWriter::flush`] writes the event.
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

    fn hand_on(&mut self) -> io::Result<()> {
        while !self.left.is_empty() {
            let piece = self.left.len().min(PIECE);
            self.out.write_all(&self.left[..piece])?;
            self.left.drain(..piece);
        }
        Ok(())
    }

    /// Whether the log is still at its place and undamaged: an open file accepts every event even after it was deleted,
    /// moved, cut, overwritten or made read-only. If not, the recording is saved into a folder of the same name: at its
    /// place, or else below the system's folder for temporary files. Every check compares a part of the log with what
    /// was written, or `whole`, all of it.
    pub fn check(&mut self, whole: bool) -> Result<(), RecordingWriteError> {
        if !is_same(&self.out.get_ref().file, &self.path) {
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

    /// Returns the folder that contains the recording now.
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

/// It is an error if the recording in this folder has been continued.
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

/// Whether a program was writing a log or a settings file of this name when it was killed.
fn is_begun(name: &str) -> bool {
    [LOG_NAME, SETTINGS_NAME].iter().any(|whole| name != *whole && replaced_name(name) == *whole)
}

/// Whether this program wrote a settings file: it has all settings and nothing else.
pub fn is_written_settings(text: &str) -> bool {
    let spec = toml::from_str::<SessionSpec>(text).ok();
    spec.and_then(|spec| toml::to_string(&spec).ok()).is_some_and(|written| written == text)
}

/// With its line end.
fn line(value: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut line = Vec::with_capacity(256);
    value.serialize(&mut serde_json::Serializer::with_formatter(&mut line, FiniteNumbers))?;
    line.push(b'\n');
    Ok(line)
}

/// Rejects `null`: only numbers that are not finite would become `null` in a log, which could then not be read.
struct FiniteNumbers;

impl Formatter for FiniteNumbers {
    fn write_null<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        Err(io::Error::new(io::ErrorKind::InvalidData, "a number in it is not finite"))
    }
}

/// Length of the log's end that every check compares, in bytes (some seconds of gaze).
const TAIL: u64 = 64 << 10;
/// Least length of the further stretch that every check compares, in bytes.
const STRETCH: u64 = 1 << 20;
/// Largest number of checks whose stretches go through the whole log. With four checks a second, damage anywhere in the
/// log is found within 10 s, also if the walk has just passed its place.
const PASS: u64 = 18;
/// Number of bytes compared at a time.
#[cfg(unix)]
const COMPARED: usize = 64 << 10;

/// A log file that is being written, with a guarding copy that no other program can change: the log is compared with
/// the copy, and saved from it if another program damaged the log.
#[derive(Debug)]
struct GuardedFile {
    file: File,
    /// A file without a name; `None` if the log is not guarded or the copy could not be written.
    copy: Option<File>,
    /// Number of bytes written to the log.
    length: u64,
    /// Where the next check's stretch begins, in bytes.
    next: u64,
    /// Where the present pass through the log ends, in bytes.
    pass_end: u64,
}

impl Write for GuardedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.length += written as u64;
        // An incomplete guarding copy is dropped, and the log continues without a copy.
        self.copy = self.copy.take().filter(|mut copy| copy.write_all(&bytes[..written]).is_ok());
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl GuardedFile {
    /// Compares the length, the end and the next stretch of the log with what was written, or the whole log; returns
    /// the damage in words.
    fn damage(&mut self, whole: bool) -> Option<String> {
        let length = match self.file.metadata() {
            Ok(data) => data.len(),
            Err(reason) => return Some(format!("cannot be read to be checked: {reason}")),
        };
        if length != self.length {
            let how = if length < self.length { "was cut" } else { "was written to" };
            return Some(format!("{how} by another program: {length} bytes, {} were recorded", self.length));
        }
        let tail = self.length.saturating_sub(TAIL);
        let stretch = if whole { 0..tail } else { self.next_stretch(tail) };
        let at = self.difference(tail, self.length).or_else(|| self.difference(stretch.start, stretch.end))?;
        Some(format!("was overwritten by another program, at byte {at} of {}", self.length))
    }

    /// The next stretch before `tail`. The end of a pass is fixed where it begins: a walk that followed the growing log
    /// would never return to its beginning.
    fn next_stretch(&mut self, tail: u64) -> std::ops::Range<u64> {
        if self.next >= self.pass_end {
            (self.next, self.pass_end) = (0, tail);
        }
        let length = STRETCH.max(self.pass_end.div_ceil(PASS));
        let stretch = self.next..(self.next + length).min(self.pass_end);
        self.next = stretch.end;
        stretch
    }

    /// Position of the first byte in this range that differs between log and copy; `None` also without a copy.
    #[cfg(unix)]
    fn difference(&mut self, from: u64, until: u64) -> Option<u64> {
        use std::os::unix::fs::FileExt;
        let (mut copied, mut found) = ([0; COMPARED], [0; COMPARED]);
        let mut at = from;
        while at < until {
            let size = COMPARED.min((until - at) as usize);
            let copy = self.copy.as_ref()?;
            if copy.read_exact_at(&mut copied[..size], at).is_err() {
                self.copy = None;
                return None;
            }
            // The read failed: the log was cut meanwhile, or the disk is broken.
            if self.file.read_exact_at(&mut found[..size], at).is_err() {
                return Some(at);
            }
            if copied[..size] != found[..size] {
                let index = copied.iter().zip(&found).position(|(copied, found)| copied != found);
                return index.map(|index| at + index as u64);
            }
            at += size as u64;
        }
        None
    }

    /// There are no guarding copies on this operating system.
    #[cfg(not(unix))]
    fn difference(&mut self, _from: u64, _until: u64) -> Option<u64> {
        None
    }

    /// From the guarding copy, or from the log itself if it is undamaged.
    fn save(&mut self, is_damaged: bool, to: &mut File) -> io::Result<()> {
        let from = match (&mut self.copy, is_damaged) {
            (Some(copy), _) => copy,
            (None, false) => &mut self.file,
            (None, true) => return Err(io::Error::from(io::ErrorKind::NotFound)),
        };
        from.rewind()?;
        io::copy(from, to)?;
        to.sync_all()
    }
}
