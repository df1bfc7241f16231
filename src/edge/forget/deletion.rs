//! Deletes the data of a participant that were found (`tomcom forget`). Every step that can fail is tried first in a
//! way that changes nothing.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::participant_data::{ParticipantData, find, others, training};
use super::walk::RetainedFile;
use crate::analysis::training_record::WizardTrainingRecord;
use crate::edge::file_error::FileError;
use crate::edge::log::{LOG_NAME, RecordingLock, RecordingWriteError, SETTINGS_NAME};
use crate::edge::replace_file::Replacement;

/// Why no data of a participant were deleted.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ParticipantDeletionError {
    /// A recording of the participant is being written, or its folder cannot be written to.
    #[error("nothing was deleted: {0}")]
    #[diagnostic(transparent)]
    Recording(RecordingWriteError),
    /// A file with possible data of the participant cannot be read.
    #[error("nothing was deleted: {0}")]
    #[diagnostic(transparent)]
    File(Box<FileError>),
    /// A file with data of the participant cannot be deleted or rewritten.
    #[error("nothing was deleted: {}: cannot be deleted or written again: {reason}", path.display())]
    #[diagnostic(help("the right to write to the file's folder, on a disk with free space"))]
    Unwritable {
        /// File or folder that cannot be deleted or rewritten.
        path: PathBuf,
        /// Why the file or folder cannot be deleted or rewritten.
        reason: io::Error,
    },
    /// Files have changed since the participant's data were listed.
    #[error("nothing was deleted: files in {} have changed since they were listed", folder.display())]
    #[diagnostic(help("run the command again, when nothing else writes there"))]
    Changed {
        /// Folder with files that have changed.
        folder: PathBuf,
    },
}

/// Deletes the participant's data that were found. Files that could not be deleted in the end are listed in the result.
/// Nothing is deleted if one of the recordings is being written, if a file has changed since it was found, or if a
/// folder cannot be written to.
///
/// # Errors
/// Nothing was deleted, for one of these reasons.
pub fn delete(found: ParticipantData) -> Result<ParticipantData, ParticipantDeletionError> {
    let locks = found.recordings.iter().map(|folder| RecordingLock::take(folder));
    let locks = locks.collect::<Result<Vec<RecordingLock>, _>>().map_err(ParticipantDeletionError::Recording)?;
    let again = find(&found.root, &found.temporary, &found.code)
        .map_err(|error| ParticipantDeletionError::File(Box::new(error)))?;
    if again != found {
        return Err(ParticipantDeletionError::Changed { folder: found.root });
    }
    let unwritable = |path: &Path| {
        let path = path.to_path_buf();
        |reason| ParticipantDeletionError::Unwritable { path, reason }
    };
    let mut replacements = Vec::new();
    for (path, cut) in &found.cuts {
        replacements.push(written(path, |new| copy_without(path, cut, new)).map_err(unwritable(path))?);
    }
    for path in &found.trainings {
        replacements.push(written(path, |new| write_others(path, &found, new)).map_err(unwritable(path))?);
    }
    for path in &found.files {
        // Whether a folder can be written to is known only after writing a file into the folder.
        written(path, |_| Ok(())).map_err(unwritable(path))?;
    }
    Ok(commit(found, replacements, locks))
}

/// Moves the new versions of files into place, and deletes all other found files. Recordings are deleted last, since
/// other files are recognised by the recordings' names if the command has to be run again.
fn commit(found: ParticipantData, replacements: Vec<Replacement>, locks: Vec<RecordingLock>) -> ParticipantData {
    let mut done =
        ParticipantData { recording_files: Vec::new(), files: Vec::new(), left: Vec::new(), ..found.clone() };
    let mut left = found.left;
    let mut fails = |path: &Path, result: io::Result<()>| match result {
        Ok(()) => false,
        Err(reason) => {
            left.push(RetainedFile::new(path, format!("the file cannot be deleted or written again: {reason}")));
            true
        }
    };
    for replacement in replacements {
        let path = replacement.path().to_path_buf();
        if fails(&path, replacement.finish()) {
            done.tables.retain(|(table, _)| *table != path);
            done.trainings.retain(|training| *training != path);
        }
    }
    for path in found.files {
        if !fails(&path, fs::remove_file(&path)) {
            done.files.push(path);
        }
    }
    // A recording's log and settings are deleted last, since they tell to whom the recording belongs if another file
    // cannot be deleted.
    let (known_by, mut files): (Vec<PathBuf>, Vec<PathBuf>) =
        found.recording_files.into_iter().partition(|path| path.ends_with(LOG_NAME) || path.ends_with(SETTINGS_NAME));
    files.extend(known_by);
    let mut occupied: Vec<PathBuf> = Vec::new();
    for path in files {
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let is_needed = path.ends_with(LOG_NAME) || path.ends_with(SETTINGS_NAME);
        let kept = io::Error::other("it says whose the files beside it are, and these files could not be deleted");
        let result = if is_needed && occupied.contains(&folder) { Err(kept) } else { fs::remove_file(&path) };
        match fails(&path, result) {
            true => occupied.push(folder),
            false => done.recording_files.push(path),
        }
    }
    // The lock of a recording is a file in its folder, so locks are released before folders are removed.
    drop(locks);
    for folder in found.folders.iter().rev() {
        // Folders that are not empty stay: their files are listed as left, or belong to somebody else.
        let _ = fs::remove_dir(folder);
    }
    done.recording_files.sort();
    left.sort();
    ParticipantData { left, ..done }
}

/// Writes the new content of a file to another file beside it, which is to replace it.
fn written(path: &Path, write: impl FnOnce(&mut Replacement) -> io::Result<()>) -> io::Result<Replacement> {
    let mut replacement = Replacement::begin(path)?;
    write(&mut replacement)?;
    replacement.complete()?;
    Ok(replacement)
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

/// Writes a wizard's training record without the forgotten participant's recordings.
fn write_others(path: &Path, found: &ParticipantData, new: &mut Replacement) -> io::Result<()> {
    let record = training(path)?.ok_or_else(|| io::Error::other("the file is no record of training any more"))?;
    let record = WizardTrainingRecord { recordings: others(&record, &found.subject), ..record };
    let text = serde_json::to_string_pretty(&record).map_err(io::Error::other)? + "\n";
    new.write_all(text.as_bytes())
}
