//! Lock that lets only one program at a time write a recording.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use crate::files::file_error::open_regular;
use crate::log::RecordingWriteError;

/// Contains the writing program's process id and the network address for viewers.
pub const LOCK_NAME: &str = "lock";
/// Prefix of the lock while raters' codes are written; the raters' names follow.
pub const CODES_LOCK: &str = "lock-codes-";
/// Number of bytes of a lock file that are read; process id and address are shorter.
const MAX_BYTES: u64 = 1 << 12;
/// Attempts to take the lock again, because its holder removed the file meanwhile.
const ATTEMPTS: usize = 8;

/// The right to write a recording, until the value is dropped. The operating system holds the lock and releases it when
/// the process ends, so a lock file that a killed program left blocks nobody, even if another process has its id now.
#[derive(Debug)]
pub struct RecordingLock {
    file: File,
    path: PathBuf,
    /// Folder that was made for the lock alone; it goes with it if nothing was recorded.
    made: Option<PathBuf>,
}

/// As far as the lock file tells.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LockHolder {
    pub pid: Option<u32>,
    /// Address at which viewers can watch the running session.
    pub viewers: Option<String>,
}

impl LockHolder {
    fn read(file: &mut File) -> LockHolder {
        let mut text = String::new();
        // A lock file that cannot be read still counts as held.
        let _ = file.take(MAX_BYTES).read_to_string(&mut text);
        let mut lines = text.lines();
        let pid = lines.next().and_then(|line| line.trim().parse().ok());
        LockHolder { pid, viewers: lines.next().map(str::to_string) }
    }
}

impl RecordingLock {
    /// It is an error if another program holds the lock.
    pub fn take(folder: &Path) -> Result<RecordingLock, RecordingWriteError> {
        RecordingLock::take_file(folder.join(LOCK_NAME), folder)
    }

    /// Takes the right to code errors as these raters, whose codes are always replaced as a whole.
    pub fn take_for_codes(folder: &Path, raters: &[&str]) -> Result<RecordingLock, RecordingWriteError> {
        let mut raters = raters.to_vec();
        raters.sort_unstable();
        let path = folder.join(format!("{CODES_LOCK}{}", raters.join("-")));
        RecordingLock::take_file(path, folder).map_err(|error| match error {
            RecordingWriteError::InUse { folder, pid } => {
                RecordingWriteError::Coded { folder, raters: raters.join(" and "), pid }
            }
            other => other,
        })
    }

    /// Takes the right to record a participant of a plan, from before the first question until the last recording is
    /// closed. The folder is made if it does not exist.
    pub fn take_for_participant(folder: &Path, plan: &str, code: &str) -> Result<RecordingLock, RecordingWriteError> {
        let made = (!folder.exists()).then(|| folder.to_path_buf());
        fs::create_dir_all(folder).map_err(|reason| RecordingWriteError::unwritable(folder, reason))?;
        let path = folder.join(format!("{LOCK_NAME}-{plan}-{code}"));
        let mut lock = RecordingLock::take_file(path, folder).map_err(|error| match error {
            RecordingWriteError::InUse { folder, pid } => {
                RecordingWriteError::Attended { folder, plan: plan.to_string(), code: code.to_string(), pid }
            }
            other => other,
        })?;
        lock.made = made;
        Ok(lock)
    }

    fn take_file(path: PathBuf, folder: &Path) -> Result<RecordingLock, RecordingWriteError> {
        let failed = |reason| RecordingWriteError::unwritable(&path, reason);
        // Taking the lock empties the lock file, which must therefore not be the target of a link; and opening a named
        // pipe would block.
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
                // On a file system without locks, recording without a lock is better than no recording.
                Ok(()) | Err(TryLockError::Error(_)) => {}
                Err(TryLockError::WouldBlock) => {
                    let pid = LockHolder::read(&mut file).pid;
                    return Err(RecordingWriteError::InUse { folder: folder.to_path_buf(), pid });
                }
            }
            // If the lock's previous holder removed the file after it was opened here, a lock on the removed file has
            // no effect.
            if is_same(&file, &path) {
                file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id())).map_err(failed)?;
                return Ok(RecordingLock { file, path, made: None });
            }
        }
        Err(RecordingWriteError::InUse { folder: folder.to_path_buf(), pid: None })
    }

    /// The program that writes the recording in this folder.
    pub fn holder(folder: &Path) -> Option<LockHolder> {
        let mut file = open_regular(&folder.join(LOCK_NAME)).ok()?;
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => Some(LockHolder::read(&mut file)),
            Ok(()) | Err(TryLockError::Error(_)) => None,
        }
    }

    /// Writes the address at which viewers can watch into the lock file.
    pub fn announce(&mut self, viewers: &str) -> io::Result<()> {
        writeln!(self.file, "{viewers}")
    }
}

impl Drop for RecordingLock {
    fn drop(&mut self) {
        if is_same(&self.file, &self.path) {
            // A lock file that cannot be removed does no harm.
            let _ = fs::remove_file(&self.path);
        }
        if let Some(folder) = &self.made {
            // A folder with recordings is not empty, and stays.
            let _ = fs::remove_dir(folder);
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

/// Whether any file still exists at this path.
#[cfg(not(unix))]
pub fn is_same(_: &File, path: &Path) -> bool {
    path.exists()
}
