//! The command `tomcom forget`: finds and deletes everything about one participant (or one wizard) below a folder:
//! recordings with what this program wrote beside their logs, rows of tables, reports, streams, training records.
//!
//! Only files that say that this program wrote them are deleted or changed: recordings say it in their headers, tables
//! by their columns, reports and streams in their first bytes, training records by their fields. The participant is
//! looked for in the column or field that means the participant or the recording, and nowhere else.

mod deletion;
mod subject;
mod tables;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use self::deletion::{ParticipantDeletionError, delete};
use self::subject::{AMBIGUOUS, ForgetSubject, NamedPerson, RecordingOwner, file_name};
use self::tables::{FolderTables, TableMatch};
use tomcom_devices::stream_head;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::replace_file::replaced_name;
use tomcom_session::files::rescue::{RESCUE_NOTE_NAME, RESCUED, RescueNote};
use tomcom_session::film::is_recorded_film;
use tomcom_session::log::consensus_file::CONSENSUS_NAME;
use tomcom_session::log::rater_codes::is_codes_file;
use tomcom_session::log::video_file::{self, AttachedFilm, VIDEO_NAME};
use tomcom_session::log::{
    ANNOTATION_NAMES, CODES_LOCK, CORRECTION_NAME, EXCLUSION_NAME, LOCK_NAME, LOG_NAME, MCAP_NAME, RRD_NAME,
    SETTINGS_NAME, is_damaged_log,
};
use tomcom_session::person_code;
use tomcom_study::analysis::lesson_report::WizardTrainingRecord;
use tomcom_study::files::{bids_tree, pool_file};
use tomcom_study::report;

/// Largest size of a report or a training record that is read, in bytes.
const MAX_BYTES: u64 = 64 << 20;

/// A file that is or may be about the participant and is kept, with the reason.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RetainedFile {
    pub path: PathBuf,
    pub reason: String,
}

/// All data about one participant code that were found in a folder, for their deletion.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParticipantData {
    pub code: String,
    pub root: PathBuf,
    pub temporary: PathBuf,
    pub recordings: Vec<PathBuf>,
    pub recording_files: Vec<PathBuf>,
    /// Other files about the participant that will be deleted as a whole.
    pub files: Vec<PathBuf>,
    /// CSV tables about several participants, each with the byte ranges of the participant's rows. Tables of trials come
    /// last, since they tell to whom the recordings in the tables beside them belong.
    pub tables: Vec<(PathBuf, Vec<Range<u64>>)>,
    /// Training records of wizards that name recordings of the participant, each with its text without them.
    pub trainings: Vec<(PathBuf, String)>,
    pub left: Vec<RetainedFile>,
    /// Files that name the code and stay as they are: session files, frozen plans, recordings of others that were begun
    /// with it.
    pub naming: Vec<PathBuf>,
    /// Names of the plans of the participant's recordings.
    pub plans: BTreeSet<String>,
    /// "; did you mean P07?", where a recording of somebody else has a similar code.
    pub near: String,
    /// Folders that are removed if they are empty after the deletion; a folder comes after the one that contains it.
    folders: Vec<PathBuf>,
}

impl ParticipantData {
    /// Whether there is nothing to delete; there may still be files that are listed as kept.
    pub fn is_empty(&self) -> bool {
        self.recording_files.is_empty() && self.files.is_empty() && self.tables.is_empty() && self.trainings.is_empty()
    }
}

/// Looks for everything about this code below a folder, and in `temporary`, the system's folder for temporary files,
/// for recordings that were rescued from that folder and for Rerun streams made from its recordings. Session files and
/// the targets of symbolic links are not touched.
///
/// # Errors
/// The folder cannot be read. Unreadable files in the folder are listed as kept instead.
pub fn find(root: &Path, temporary: &Path, code: &str) -> FileResult<ParticipantData> {
    if let Err(reason) = fs::read_dir(root) {
        return Err(FileError::unreadable(root, reason, "the folder with the recordings"));
    }
    let found = ParticipantData {
        code: code.to_string(),
        root: root.to_path_buf(),
        temporary: temporary.to_path_buf(),
        ..ParticipantData::default()
    };
    let mut search = ForgetSearch { found, subject: ForgetSubject::new(code), folders: Vec::new() };
    search.enter(root, false);
    // A folder for temporary files inside the searched folder has been searched with it.
    if let (Ok(home), Ok(elsewhere)) = (root.canonicalize(), temporary.canonicalize())
        && !elsewhere.starts_with(&home)
    {
        search.enter_rescued(&home, temporary);
    }
    for folder in std::mem::take(&mut search.folders) {
        search.look_through(folder);
    }
    let mut found = search.found;
    found.near = person_code::did_you_mean(code, search.subject.codes());
    found.tables.sort_by_key(|(path, _)| (path.ends_with("trials.csv"), path.clone()));
    found.left.sort();
    Ok(found)
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
struct WalkedFolder {
    path: PathBuf,
    files: Vec<PathBuf>,
    is_own: bool,
}

/// The search for a participant's data: first for all recordings, then through all other files, which name recordings.
struct ForgetSearch {
    found: ParticipantData,
    subject: ForgetSubject,
    folders: Vec<WalkedFolder>,
}

impl ForgetSearch {
    fn leave(&mut self, path: &Path, reason: impl Into<String>) {
        self.found.left.push(RetainedFile { path: path.to_path_buf(), reason: reason.into() });
    }

    fn leave_unreadable(&mut self, path: &Path, reason: &io::Error) {
        self.leave(path, format!("it cannot be read, so it may be about the participant: {reason}"));
    }

    fn leave_strange(&mut self, path: &Path) {
        self.leave(
            path,
            "in the folder of one of the participant's recordings, and tomcom did not write it; it is to be deleted or \
             moved by hand",
        );
    }

    /// Looks for recordings in a folder and everything below it, and lists all other files.
    fn enter(&mut self, folder: &Path, is_inside: bool) {
        if bids_tree::codes(folder).is_some_and(|codes| codes.contains(&self.found.code)) {
            return self.leave(
                folder,
                "a BIDS data set of tomcom export with the participant in it; delete the folder, and export what is \
                 left of the recordings again",
            );
        }
        let owner = RecordingOwner::read(folder);
        let is_recording = matches!(&owner, RecordingOwner::Participant(found) if found.code == self.found.code);
        let is_own = is_recording || (is_inside && matches!(owner, RecordingOwner::NoRecording));
        match owner {
            RecordingOwner::Participant(recording) => {
                // Its log cannot be changed.
                let is_named = !is_recording && recording.recorded_as == self.found.code;
                self.found.naming.extend(is_named.then(|| folder.join(LOG_NAME)));
                // A corrected code need not be one of the plan.
                let is_planned = is_recording && recording.recorded_as == recording.code;
                self.found.plans.extend(recording.plan.clone().filter(|_| is_planned));
                self.subject.add(recording);
            }
            RecordingOwner::Unknown(reason) => self.leave(folder, reason),
            RecordingOwner::NoRecording => {}
        }
        let entries = match entries(folder) {
            Ok(entries) => entries,
            Err(reason) => return self.leave_unreadable(folder, &reason),
        };
        if is_recording {
            self.found.recordings.push(folder.to_path_buf());
        }
        let films = if is_recording { self.films(folder) } else { BTreeSet::new() };
        if is_own {
            self.found.folders.push(folder.to_path_buf());
        }
        let mut files = Vec::new();
        for (path, kind) in entries {
            match kind {
                EntryKind::Folder => self.enter(&path, is_own),
                // The lock file of a recording is removed by the program that holds the lock.
                EntryKind::File if is_recording && is_lock(&path) => {}
                EntryKind::File if is_recording && (is_of_recording(&path) || films.contains(&file_name(&path))) => {
                    self.found.recording_files.push(path);
                }
                EntryKind::File => files.push(path),
                EntryKind::Other if is_own => self.leave_strange(&path),
                EntryKind::Other => {}
            }
        }
        self.folders.push(WalkedFolder { path: folder.to_path_buf(), files, is_own });
    }

    /// Names of the films that lie in the folder of one of the participant's recordings; films elsewhere are listed as kept.
    fn films(&mut self, folder: &Path) -> BTreeSet<String> {
        let films = match video_file::read(folder) {
            Ok(films) => films.films,
            Err(error) => {
                let path = folder.join(VIDEO_NAME);
                self.leave(&path, format!("it does not say where films of the participant are: {error}"));
                return BTreeSet::new();
            }
        };
        let files = films.iter().flat_map(AttachedFilm::files);
        let (inside, outside): (Vec<_>, Vec<_>) = files.partition(|file| video_file::is_name(file));
        for file in outside {
            let gone = if file.exists() { "" } else { " (there is no such file there now)" };
            let reason = format!(
                "a film of the participant's recording {}, outside of its folder{gone}; it is to be deleted by hand",
                file_name(folder)
            );
            self.leave(file, reason);
        }
        inside.iter().map(|file| file_name(file)).collect()
    }

    /// Looks for recordings that were rescued from a folder below the folder `home`, and for Rerun streams of recordings
    /// that could not be written beside the recordings' logs.
    fn enter_rescued(&mut self, home: &Path, temporary: &Path) {
        // The note names the original folder as text.
        let home = PathBuf::from(home.to_string_lossy().into_owned());
        let mut files = Vec::new();
        for (path, kind) in entries(temporary).unwrap_or_default() {
            let name = file_name(&path);
            if kind == EntryKind::File && name.starts_with("tomcom-") && replaced_name(&name).ends_with(".rrd") {
                files.push(path);
            } else if kind == EntryKind::Folder && name.starts_with(RESCUED) {
                for (recording, kind) in entries(&path).unwrap_or_default() {
                    let is_from_here = RescueNote::read(&recording).is_some_and(|note| note.home.starts_with(&home));
                    if kind == EntryKind::Folder && is_from_here {
                        // The folder of rescued recordings is also removed once it is empty.
                        self.found.folders.push(path.clone());
                        self.enter(&recording, false);
                    }
                }
            }
        }
        self.folders.push(WalkedFolder { path: temporary.to_path_buf(), files, is_own: false });
    }

    /// Looks for data of the participant in the files of a folder that do not belong to a recording.
    fn look_through(&mut self, folder: WalkedFolder) {
        let mut tables = match FolderTables::read(&folder.path, &self.subject) {
            Ok(tables) => tables,
            Err(reason) => return self.leave_unreadable(&folder.path, &reason),
        };
        let mut unreadable = None;
        for path in &folder.files {
            match self.look_at(path, &mut tables, folder.is_own) {
                Ok(true) => {}
                Ok(false) if folder.is_own => self.leave_strange(path),
                Ok(false) => {}
                Err(reason) => self.leave_unreadable(path, &reason),
            }
            if path.extension().is_some_and(|end| end == "csv")
                && self.found.left.last().is_some_and(|left| left.path == *path)
            {
                unreadable = Some(file_name(path));
            }
        }
        // As long as a table of the folder cannot be changed, the table of trials must tell whose the recordings in it are.
        let trials = folder.path.join("trials.csv");
        if let Some(table) = unreadable
            && let Some(at) = self.found.tables.iter().position(|(path, _)| *path == trials)
        {
            self.found.tables.remove(at);
            self.leave(&trials, format!("rows are about the participant; they go when {table} is mended or deleted"));
        }
    }

    /// Adds a file to the results if it contains data of the participant. Returns whether the kind of file is known.
    fn look_at(&mut self, path: &Path, tables: &mut FolderTables, is_own: bool) -> io::Result<bool> {
        // What a killed program left of a file has the content of that file.
        let name = file_name(path);
        let end = Path::new(replaced_name(&name)).extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match end.as_str() {
            "csv" => self.look_at_table(path, tables, is_own),
            "json" => self.look_at_training(path),
            "html" => self.look_at_page(path),
            _ => {
                let identity = stream_head::identity(path)?;
                let is_streamed = identity.is_some_and(|identity| self.subject.is_streamed(&identity));
                self.found.files.extend(is_streamed.then(|| path.to_path_buf()));
                if !is_own && (end == "toml" || pool_file::is_frozen(path)?) {
                    let code = format!("\"{}\"", self.found.code);
                    let is_named =
                        read_small(path)?.is_some_and(|bytes| String::from_utf8_lossy(&bytes).contains(&code));
                    self.found.naming.extend(is_named.then(|| path.to_path_buf()));
                }
                Ok(is_streamed)
            }
        }
    }

    fn look_at_table(&mut self, path: &Path, tables: &mut FolderTables, is_own: bool) -> io::Result<bool> {
        let is_dictionary = path.ends_with("dictionary.csv");
        match tables.look_at(path, &self.subject)? {
            TableMatch::Foreign => return Ok(false),
            // Tables from an analysis of this participant alone are deleted as a whole.
            TableMatch::Own { has_others, .. } if is_own && (is_dictionary || !has_others) => {
                self.found.files.push(path.to_path_buf());
            }
            TableMatch::Own { cut, .. } if cut.is_empty() => {}
            TableMatch::Own { cut, .. } => self.found.tables.push((path.to_path_buf(), cut)),
            TableMatch::Unclear(reason) => self.leave(path, reason),
        }
        Ok(true)
    }

    fn look_at_training(&mut self, path: &Path) -> io::Result<bool> {
        let record = read_small(path)?.and_then(|bytes| serde_json::from_slice::<WizardTrainingRecord>(&bytes).ok());
        let Some(mut record) = record else { return Ok(false) };
        let whose: BTreeSet<NamedPerson> =
            record.recordings.iter().map(|one| self.subject.recording(&one.recording)).collect();
        let is_of_subject = whose.iter().eq([&NamedPerson::Subject]);
        if record.wizard == self.found.code || is_of_subject {
            self.found.files.push(path.to_path_buf());
        } else if whose.contains(&NamedPerson::Ambiguous) {
            self.leave(path, AMBIGUOUS);
        } else if whose.contains(&NamedPerson::Subject) {
            record.recordings.retain(|one| self.subject.recording(&one.recording) == NamedPerson::Other);
            let text = serde_json::to_string_pretty(&record).map_err(io::Error::other)? + "\n";
            self.found.trainings.push((path.to_path_buf(), text));
        }
        Ok(true)
    }

    fn look_at_page(&mut self, path: &Path) -> io::Result<bool> {
        let Some(bytes) = read_small(path)? else { return Ok(false) };
        let page = String::from_utf8_lossy(&bytes);
        let Some(participants) = report::participants_of_page(&page) else { return Ok(false) };
        if participants.iter().any(|name| self.subject.is_participant(name)) {
            self.found.files.push(path.to_path_buf());
        }
        Ok(true)
    }
}

/// The content of a file; `None` if it is longer than any report or training record.
fn read_small(path: &Path) -> io::Result<Option<Vec<u8>>> {
    match fs::metadata(path)?.len() {
        ..=MAX_BYTES => fs::read(path).map(Some),
        _ => Ok(None),
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
    const NAMES: [&str; 9] = [
        LOG_NAME,
        SETTINGS_NAME,
        RRD_NAME,
        MCAP_NAME,
        VIDEO_NAME,
        EXCLUSION_NAME,
        CORRECTION_NAME,
        CONSENSUS_NAME,
        RESCUE_NOTE_NAME,
    ];
    let name = file_name(path);
    let name = replaced_name(&name);
    let seal = name.strip_suffix(".toml").unwrap_or_default();
    is_codes_file(name)
        || is_damaged_log(name)
        || is_recorded_film(name)
        || NAMES.contains(&name)
        || ANNOTATION_NAMES.contains(&name)
        || seal == RRD_NAME
}

fn is_lock(path: &Path) -> bool {
    let name = file_name(path);
    name == LOCK_NAME || name.starts_with(CODES_LOCK)
}
