//! Search through folders for recordings and for all other files (`tomcom forget`).

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::owner::RecordingOwner;
use super::subject::ForgetSubject;
use crate::edge::bids_tree;
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::log::consensus_file::CONSENSUS_NAME;
use crate::edge::log::rater_codes::is_codes_file;
use crate::edge::log::{
    CODES_LOCK, CORRECTION_NAME, EXCLUSION_NAME, LOCK_NAME, LOG_NAME, MCAP_NAME, RRD_NAME, SETTINGS_NAME,
    is_damaged_log,
};
use crate::edge::replace_file::replaced_name;
use crate::edge::rescue::{RESCUE_NOTE_NAME, RESCUED, RescueNote};

/// Why an unknown file in the folder of a recording is kept.
const STRANGE: &str = "in the folder of one of the participant's recordings, and tomcom did not write it; it is to be deleted or \
                       moved by hand";

/// Why a BIDS data set that contains the participant is kept.
const EXPORTED: &str = "a BIDS data set of tomcom export with the participant in it; delete the folder, and export what is left of the \
                        recordings again";

/// A file that is or may be about the participant and is kept, with the reason.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RetainedFile {
    /// Path of the file that is not deleted.
    pub path: PathBuf,
    /// Why the file is not deleted, in words.
    pub reason: String,
}

impl RetainedFile {
    pub(super) fn new(path: &Path, reason: impl Into<String>) -> RetainedFile {
        RetainedFile { path: path.to_path_buf(), reason: reason.into() }
    }

    pub(super) fn unreadable(path: &Path, reason: &io::Error) -> RetainedFile {
        RetainedFile::new(path, format!("it cannot be read, so it may be about the participant: {reason}"))
    }
}

/// Kind of an entry in a folder: file, folder or something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EntryKind {
    File,
    Folder,
    /// Neither file nor folder: a symbolic link, a named pipe, or a device.
    Other,
}

/// Files of a folder that do not belong to a recording.
#[derive(Debug, Default)]
pub(super) struct WalkedFolder {
    pub files: Vec<PathBuf>,
    /// Whether the folder is, or is inside, the folder of one of the participant's recordings.
    pub is_own: bool,
}

/// Results of the search through folders.
#[derive(Debug)]
pub(super) struct ForgetWalk {
    pub subject: ForgetSubject,
    /// Folders of the participant's recordings.
    pub recordings: Vec<PathBuf>,
    /// Files of the participant's recordings.
    pub recording_files: Vec<PathBuf>,
    /// Folders of the participant's recordings, and folders in them that belong to nobody else; a folder comes after
    /// the one that contains it.
    pub own_folders: Vec<PathBuf>,
    /// All files that do not belong to a recording, by folder.
    pub folders: BTreeMap<PathBuf, WalkedFolder>,
    pub left: Vec<RetainedFile>,
}

impl ForgetWalk {
    /// Searches a folder, and the recordings of this folder that were rescued into the system's folder for temporary
    /// files.
    ///
    /// # Errors
    /// The folder cannot be read. Unreadable files in the folder are listed as kept instead.
    pub(super) fn through(root: &Path, temporary: &Path, code: &str) -> FileResult<ForgetWalk> {
        let mut walk = ForgetWalk {
            subject: ForgetSubject::new(code),
            recordings: Vec::new(),
            recording_files: Vec::new(),
            own_folders: Vec::new(),
            folders: BTreeMap::new(),
            left: Vec::new(),
        };
        if let Err(reason) = fs::read_dir(root) {
            return Err(FileError::unreadable(root, reason, "the folder with the recordings"));
        }
        walk.enter(root, false);
        let (home, elsewhere) = (canonical(root), canonical(temporary));
        // A folder for temporary files inside the searched folder has been searched with it.
        if !elsewhere.starts_with(&home) {
            walk.enter_rescued(&home, temporary);
        }
        Ok(walk)
    }

    /// Searches a folder with everything below it.
    fn enter(&mut self, folder: &Path, is_inside: bool) {
        if bids_tree::codes(folder).is_some_and(|codes| codes.contains(&self.subject.code)) {
            return self.left.push(RetainedFile::new(folder, EXPORTED));
        }
        let owner = RecordingOwner::read(folder);
        let (mut is_own, mut is_known) = (is_inside, false);
        match owner {
            RecordingOwner::Participant { code, began } if code == self.subject.code => {
                self.subject.add_own(folder, began);
                self.recordings.push(folder.to_path_buf());
                (is_own, is_known) = (true, true);
            }
            RecordingOwner::Participant { code, .. } => {
                self.subject.add_other(folder, code);
                is_own = false;
            }
            RecordingOwner::Unknown(reason) => {
                self.left.push(RetainedFile::new(folder, reason));
                is_own = false;
            }
            RecordingOwner::NoRecording => {}
        }
        let entries = match entries(folder) {
            Ok(entries) => entries,
            Err(reason) => return self.left.push(RetainedFile::unreadable(folder, &reason)),
        };
        if is_own {
            self.own_folders.push(folder.to_path_buf());
        }
        let mut files = Vec::new();
        for (path, kind) in entries {
            let is_of_recording = is_known && is_of_recording(&path);
            match kind {
                EntryKind::Folder => self.enter(&path, is_own),
                // The lock file of a recording is removed by the program that holds the lock.
                EntryKind::File if is_of_recording && is_lock(&path) => {}
                EntryKind::File if is_of_recording => self.recording_files.push(path),
                EntryKind::File => files.push(path),
                EntryKind::Other if is_own => self.left.push(RetainedFile::new(&path, STRANGE)),
                EntryKind::Other => {}
            }
        }
        self.folders.insert(folder.to_path_buf(), WalkedFolder { files, is_own });
    }

    /// Searches recordings that were rescued from a folder below the folder `home`.
    fn enter_rescued(&mut self, home: &Path, temporary: &Path) {
        // The note names the original folder as text.
        let home = PathBuf::from(home.to_string_lossy().into_owned());
        for (folder, _) in entries(temporary).unwrap_or_default().iter().filter(is_rescued) {
            for (recording, kind) in entries(folder).unwrap_or_default() {
                let is_from_here = RescueNote::read(&recording).is_some_and(|note| note.home.starts_with(&home));
                if kind == EntryKind::Folder && is_from_here {
                    // The folder of rescued recordings is also removed once it is empty.
                    self.own_folders.push(folder.clone());
                    self.enter(&recording, false);
                }
            }
        }
        // Rerun streams of recordings that could not be written beside the recordings' logs.
        let streams =
            entries(temporary).unwrap_or_default().into_iter().filter(is_stream).map(|(path, _)| path).collect();
        self.folders.insert(temporary.to_path_buf(), WalkedFolder { files: streams, is_own: false });
    }

    /// Lists a file of unknown kind in the participant's own folders as kept.
    pub(super) fn leave_strange(&mut self, path: &Path) {
        self.left.push(RetainedFile::new(path, STRANGE));
    }
}

/// Files and folders in a folder, sorted by name.
fn entries(folder: &Path) -> io::Result<Vec<(PathBuf, EntryKind)>> {
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let kind = match entry.file_type()? {
            kind if kind.is_file() => EntryKind::File,
            kind if kind.is_dir() => EntryKind::Folder,
            _ => EntryKind::Other,
        };
        entries.push((entry.path(), kind));
    }
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(entries)
}

/// Whether the program writes a file of this name into the folder of a recording, or leaves it there when it is killed.
fn is_of_recording(path: &Path) -> bool {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return false };
    let name = replaced_name(name);
    let is_code_file = is_codes_file(name);
    let seal = name.strip_suffix(".toml").unwrap_or_default();
    let names = [
        LOG_NAME,
        SETTINGS_NAME,
        RRD_NAME,
        MCAP_NAME,
        EXCLUSION_NAME,
        CORRECTION_NAME,
        CONSENSUS_NAME,
        RESCUE_NOTE_NAME,
    ];
    is_lock(path) || is_code_file || is_damaged_log(name) || names.contains(&name) || seal == RRD_NAME
}

/// Whether this file is the lock of a recording.
fn is_lock(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name == LOCK_NAME || name.starts_with(CODES_LOCK)
}

fn is_rescued((path, kind): &&(PathBuf, EntryKind)) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    *kind == EntryKind::Folder && name.starts_with(RESCUED)
}

/// Whether this file is a Rerun stream that `tomcom review` left in the system's folder for temporary files.
fn is_stream((path, kind): &(PathBuf, EntryKind)) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    *kind == EntryKind::File && name.starts_with("tomcom-") && replaced_name(&name).ends_with(".rrd")
}

fn canonical(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}
