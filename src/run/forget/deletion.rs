//! Deletes the data of a participant that were found (`tomcom forget`). Every step that can fail is tried first in a
//! way that changes nothing.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::{ParticipantData, RetainedFile, find};
use tomcom_session::files::file_error::FileError;
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::log::{LOG_NAME, RecordingLock, RecordingWriteError, SETTINGS_NAME};

/// Why no data of a participant were deleted.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ParticipantDeletionError {
    #[error("nothing was deleted: {0}")]
    #[diagnostic(transparent)]
    Recording(RecordingWriteError),
    #[error("nothing was deleted: {0}")]
    #[diagnostic(transparent)]
    File(FileError),
    #[error("nothing was deleted: {}: cannot be deleted or written again: {reason}", path.display())]
    #[diagnostic(help("the right to write to the file's folder, on a disk with free space"))]
    Unwritable { path: PathBuf, reason: io::Error },
    /// Files have changed since the participant's data were listed.
    #[error("nothing was deleted: files in {} have changed since they were listed", folder.display())]
    #[diagnostic(help("run the command again, when nothing else writes there"))]
    Changed { folder: PathBuf },
}

/// Deletes the participant's data that were found. Files that could not be deleted in the end are listed in the result.
/// Nothing is deleted if one of the recordings is being written, if a file has changed since it was found, or if a
/// folder cannot be written to. If the program is killed, the command can be run again: what says whose something is
/// goes last.
///
/// # Errors
/// Nothing was deleted, for one of these reasons.
pub fn delete(found: ParticipantData) -> Result<ParticipantData, ParticipantDeletionError> {
    let locks = found.recordings.iter().map(|folder| RecordingLock::take(folder));
    let locks = locks.collect::<Result<Vec<RecordingLock>, _>>().map_err(ParticipantDeletionError::Recording)?;
    let again = find(&found.root, &found.temporary, &found.code).map_err(ParticipantDeletionError::File)?;
    if again != found {
        return Err(ParticipantDeletionError::Changed { folder: found.root });
    }
    let mut replacements = Vec::new();
    for (path, cut) in &found.tables {
        replacements.push(written(path, |new| copy_without(path, cut, new))?);
    }
    for (path, text) in &found.trainings {
        replacements.push(written(path, |new| new.write_all(text.as_bytes()))?);
    }
    for path in &found.files {
        // Whether a folder can be written to is known only after writing a file into the folder.
        written(path, |_| Ok(()))?;
    }
    Ok(commit(found, replacements, locks))
}

/// Moves the new versions of files into place, and deletes all other found files. Recordings are deleted last, since
/// other files are recognised by the recordings' names if the command has to be run again.
fn commit(found: ParticipantData, replacements: Vec<Replacement>, locks: Vec<RecordingLock>) -> ParticipantData {
    let mut done = found;
    let mut left = std::mem::take(&mut done.left);
    let mut fails = |path: &Path, result: io::Result<()>| {
        let reason = result.err().map(|reason| format!("the file cannot be deleted or written again: {reason}"));
        left.extend(reason.iter().map(|reason| RetainedFile { path: path.to_path_buf(), reason: reason.clone() }));
        reason.is_some()
    };
    for replacement in replacements {
        let path = replacement.path().to_path_buf();
        if fails(&path, replacement.finish()) {
            done.tables.retain(|(table, _)| *table != path);
            done.trainings.retain(|(training, _)| *training != path);
        }
    }
    done.files.retain(|path| !fails(path, fs::remove_file(path)));
    // A recording's log and settings tell to whom the recording belongs, so they go after all other files, and stay if
    // one of these cannot be deleted.
    let is_known_by = |path: &PathBuf| path.ends_with(LOG_NAME) || path.ends_with(SETTINGS_NAME);
    let (known_by, mut deleted): (Vec<PathBuf>, Vec<PathBuf>) = done.recording_files.into_iter().partition(is_known_by);
    let mut occupied: Vec<PathBuf> = Vec::new();
    deleted.retain(|path| {
        let fails = fails(path, fs::remove_file(path));
        occupied.extend(path.parent().filter(|_| fails).map(Path::to_path_buf));
        !fails
    });
    let known_by = known_by.into_iter().filter(|path| {
        let is_needed = path.parent().is_some_and(|folder| occupied.iter().any(|occupied| occupied == folder));
        let kept = || io::Error::other("it says whose the files beside it are, and these files could not be deleted");
        !fails(path, if is_needed { Err(kept()) } else { fs::remove_file(path) })
    });
    deleted.extend(known_by);
    deleted.sort();
    // The lock of a recording is a file in its folder, so locks are released before folders are removed.
    drop(locks);
    for folder in done.folders.iter().rev() {
        // Folders that are not empty stay: their files are listed as left, or belong to somebody else.
        let _ = fs::remove_dir(folder);
    }
    left.sort();
    ParticipantData { recording_files: deleted, left, ..done }
}

/// Writes the new content of a file to another file beside it, which is to replace it.
fn written(
    path: &Path,
    write: impl FnOnce(&mut Replacement) -> io::Result<()>,
) -> Result<Replacement, ParticipantDeletionError> {
    let begun = Replacement::begin(path).and_then(|mut new| {
        write(&mut new)?;
        new.complete()?;
        Ok(new)
    });
    begun.map_err(|reason| ParticipantDeletionError::Unwritable { path: path.to_path_buf(), reason })
}

/// Copies a file without the bytes in these ranges.
fn copy_without(path: &Path, cut: &[Range<u64>], new: &mut Replacement) -> io::Result<()> {
    let mut old = File::open(path)?;
    let mut from = 0;
    for range in cut {
        io::copy(&mut (&old).take(range.start - from), new)?;
        from = old.seek(SeekFrom::Start(range.end))?;
    }
    io::copy(&mut old, new).map(drop)
}
