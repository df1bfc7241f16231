//! File of a log while the log is written, with a guarding copy that no other program can change: the log is compared
//! with the copy, and restored from the copy if another program damaged the log.

use std::fs::File;
use std::io::{self, Seek, Write};
use std::path::Path;

/// Length of the log's end that every check compares with the guarding copy, in bytes (some seconds of gaze).
const TAIL: u64 = 64 << 10;
/// Least length of the further stretch that every check compares with the guarding copy, in bytes.
const STRETCH: u64 = 1 << 20;
/// Largest number of checks whose stretches go through the whole log. With four checks a second, damage anywhere in the
/// log is found within 10 s, also if the walk has just passed its place.
const PASS: u64 = 18;
/// Number of bytes of log and copy that are compared at a time.
#[cfg(unix)]
const PIECE: usize = 64 << 10;

/// A log file that is being written, with its guarding copy.
#[derive(Debug)]
pub(super) struct GuardedFile {
    file: File,
    /// Guarding copy of the log, a file without a name; `None` if the log is not guarded or the copy could not be
    /// written.
    copy: Option<File>,
    /// Number of bytes written to the log.
    length: u64,
    /// Position in the log at which the next check's stretch begins, in bytes.
    next: u64,
    /// Position in the log at which the present pass through the log ends, in bytes.
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
    /// A log file without a guarding copy.
    pub(super) fn unguarded(file: File) -> GuardedFile {
        GuardedFile { file, copy: None, length: 0, next: 0, pass_end: 0 }
    }

    /// A log file with a guarding copy, which is in the system's folder for temporary files, or else in this folder.
    pub(super) fn guarded(file: File, folder: &Path) -> GuardedFile {
        let copy = tempfile::tempfile().or_else(|_| tempfile::tempfile_in(folder)).ok();
        GuardedFile { copy, ..GuardedFile::unguarded(file) }
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Compares the length, the end and the next stretch of the log with what was written, or the whole log; returns the
    /// damage in words; `None` if no damage is found.
    pub(super) fn damage(&mut self, whole: bool) -> Option<String> {
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

    /// The stretch of the log that is compared next, between the log's beginning and `tail`. The end of a pass is fixed
    /// where the pass begins: a walk that followed the growing log would never return to its beginning.
    fn next_stretch(&mut self, tail: u64) -> std::ops::Range<u64> {
        if self.next >= self.pass_end {
            (self.next, self.pass_end) = (0, tail);
        }
        let length = STRETCH.max(self.pass_end.div_ceil(PASS));
        let stretch = self.next..(self.next + length).min(self.pass_end);
        self.next = stretch.end;
        stretch
    }

    /// Position of the first byte in this range that differs between log and guarding copy; `None` if nothing differs
    /// or there is no copy.
    #[cfg(unix)]
    fn difference(&mut self, from: u64, until: u64) -> Option<u64> {
        use std::os::unix::fs::FileExt;
        let (mut copied, mut found) = ([0; PIECE], [0; PIECE]);
        let mut at = from;
        while at < until {
            let size = PIECE.min((until - at) as usize);
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

    /// Nothing differs on this operating system, on which logs have no guarding copies.
    #[cfg(not(unix))]
    fn difference(&mut self, _from: u64, _until: u64) -> Option<u64> {
        None
    }

    /// Saves the log to another file: from the guarding copy, or from the log itself if the log is undamaged.
    ///
    /// # Errors
    /// There is no undamaged source, or the other file cannot be written.
    pub(super) fn save(&mut self, is_damaged: bool, to: &mut File) -> io::Result<()> {
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
