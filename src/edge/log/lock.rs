//! A recording is written by one program at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use super::WriteError;
use crate::edge::file_error::open_regular;

/// The name of the lock in the folder of a recording that is being written, with the number of the process in it, and
/// where viewers connect.
pub const LOCK_NAME: &str = "lock";
/// How the name of the lock of raters' codes begins; their names follow.
pub const CODES_LOCK: &str = "lock-codes-";
/// How often somebody else may give the lock up between our opening and taking it.
const ATTEMPTS: usize = 8;

/// The right to write a recording, until it is dropped. The operating system holds it: it ends with the process, so a
/// file that a killed program left behind locks nobody out, whichever process has its number now.
#[derive(Debug)]
pub struct RecordingLock {
    file: File,
    path: PathBuf,
}

/// Who writes a recording now, as far as that is told.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LockHolder {
    /// Its process id.
    pub pid: Option<u32>,
    /// Where viewers can look on.
    pub viewers: Option<String>,
}

impl LockHolder {
    fn read(file: &mut File) -> LockHolder {
        let mut text = String::new();
        // Who cannot be asked holds it all the same.
        let _ = file.read_to_string(&mut text);
        let mut lines = text.lines();
        let pid = lines.next().and_then(|line| line.trim().parse().ok());
        LockHolder { pid, viewers: lines.next().map(str::to_string) }
    }
}

impl RecordingLock {
    /// Takes the lock of the recording in this folder.
    ///
    /// # Errors
    /// Another program has it, or the folder cannot be written to.
    pub fn take(folder: &Path) -> Result<RecordingLock, WriteError> {
        RecordingLock::take_file(folder.join(LOCK_NAME), folder)
    }

    /// Takes the right to code the errors of the recording in this folder as these raters: their codes are replaced as a whole.
    ///
    /// # Errors
    /// Another program has it, or the folder cannot be written to.
    pub fn take_for_codes(folder: &Path, raters: &[&str]) -> Result<RecordingLock, WriteError> {
        let mut raters = raters.to_vec();
        raters.sort_unstable();
        let path = folder.join(format!("{CODES_LOCK}{}", raters.join("-")));
        RecordingLock::take_file(path, folder).map_err(|error| match error {
            WriteError::InUse { folder, pid } => WriteError::Coded { folder, raters: raters.join(" and "), pid },
            other => other,
        })
    }

    fn take_file(path: PathBuf, folder: &Path) -> Result<RecordingLock, WriteError> {
        let failed = |reason| WriteError::unwritable(&path, reason);
        // Taking it empties the file, which must not be one that a link leads to; opening a pipe would wait for its other end.
        if fs::symlink_metadata(&path).is_ok_and(|data| !data.is_file()) {
            return Err(failed(io::Error::new(
                ErrorKind::InvalidInput,
                "it is no regular file, but a link, pipe or folder",
            )));
        }
        for _ in 0..ATTEMPTS {
            let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = options.map_err(failed)?;
            match file.try_lock() {
                // Where a file system has no locks, a recording is still worth more than none.
                Ok(()) | Err(TryLockError::Error(_)) => {}
                Err(TryLockError::WouldBlock) => {
                    let pid = LockHolder::read(&mut file).pid;
                    return Err(WriteError::InUse { folder: folder.to_path_buf(), pid });
                }
            }
            // Its last holder may have removed the file after we opened it: then it locks nothing.
            if is_same(&file, &path) {
                file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id())).map_err(failed)?;
                return Ok(RecordingLock { file, path });
            }
        }
        Err(WriteError::InUse { folder: folder.to_path_buf(), pid: None })
    }

    /// Who writes the recording in this folder; none where nobody does.
    pub fn holder(folder: &Path) -> Option<LockHolder> {
        let mut file = open_regular(&folder.join(LOCK_NAME)).ok()?;
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => Some(LockHolder::read(&mut file)),
            Ok(()) | Err(TryLockError::Error(_)) => None,
        }
    }

    /// Tells whoever asks who writes here where viewers can look on.
    ///
    /// # Errors
    /// The lock cannot be written to.
    pub fn announce(&mut self, viewers: &str) -> io::Result<()> {
        writeln!(self.file, "{viewers}")
    }
}

impl Drop for RecordingLock {
    fn drop(&mut self) {
        if is_same(&self.file, &self.path) {
            // Left behind it does no harm.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether the file at this path is still the one that was opened.
#[cfg(unix)]
pub fn is_same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |data: fs::Metadata| (data.dev(), data.ino());
    match (file.metadata(), fs::metadata(path)) {
        (Ok(opened), Ok(there)) => place(opened) == place(there),
        _ => false,
    }
}

/// Whether there is still a file at this path.
#[cfg(not(unix))]
pub fn is_same(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::temporary::new_folder;

    #[test]
    fn a_lock_tells_who_writes_and_where_viewers_look_on_until_it_is_dropped() {
        let folder = new_folder(&std::env::temp_dir(), &format!("tomcom-lock-{}", std::process::id())).unwrap();
        assert_eq!(RecordingLock::holder(&folder), None);
        let mut lock = RecordingLock::take(&folder).unwrap();
        let pid = Some(std::process::id());
        assert_eq!(RecordingLock::holder(&folder), Some(LockHolder { pid, viewers: None }));
        lock.announce("rerun+http://127.0.0.1:9876/proxy").unwrap();
        let viewers = Some("rerun+http://127.0.0.1:9876/proxy".to_string());
        assert_eq!(RecordingLock::holder(&folder), Some(LockHolder { pid, viewers }));
        drop(lock);
        assert_eq!(RecordingLock::holder(&folder), None);
        fs::write(folder.join(LOCK_NAME), "1\n").unwrap();
        assert_eq!(RecordingLock::holder(&folder), None, "what a killed program left behind is held by nobody");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn one_program_at_a_time_codes_as_one_rater() {
        let folder = new_folder(&std::env::temp_dir(), &format!("tomcom-codes-lock-{}", std::process::id())).unwrap();
        let first = RecordingLock::take_for_codes(&folder, &["R1"]).unwrap();
        let refusal = RecordingLock::take_for_codes(&folder, &["R1"]).unwrap_err().to_string();
        assert!(refusal.contains("codes its errors as R1"), "{refusal}");
        let _other = RecordingLock::take_for_codes(&folder, &["R2"]).unwrap();
        let _recording = RecordingLock::take(&folder).unwrap();
        drop(first);
        drop(RecordingLock::take_for_codes(&folder, &["R1"]).unwrap());
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_a_link_leads_to_is_left_as_it_is() {
        let folder = new_folder(&std::env::temp_dir(), &format!("tomcom-lock-link-{}", std::process::id())).unwrap();
        let other = folder.join("notes.txt");
        fs::write(&other, "of somebody else").unwrap();
        std::os::unix::fs::symlink(&other, folder.join(LOCK_NAME)).unwrap();
        let refusal = RecordingLock::take(&folder).unwrap_err().to_string();
        assert!(refusal.contains("a link"), "{refusal}");
        assert_eq!(fs::read_to_string(&other).unwrap(), "of somebody else");
        fs::remove_dir_all(folder).unwrap();
    }
}
