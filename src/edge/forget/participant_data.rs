//! Everything that a folder contains about one participant.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::participant_rows::{FolderTables, TableMatch};
use super::subject::{ForgetSubject, NamedPerson};
use super::walk::{ForgetWalk, RetainedFile, WalkedFolder};
use crate::analysis::training_record::{WatchedRecording, WizardTrainingRecord};
use crate::base::words::count;
use crate::edge::export::REPORT_NAME;
use crate::edge::file_error::FileResult;
use crate::edge::log::SETTINGS_NAME;
use crate::edge::replace_file::replaced_name;
use crate::edge::stream_head;
use crate::edge::written_tables::table_named;
use crate::study::report::page_head;

/// Largest size of a report or a training record that is searched, in bytes.
const MAX_BYTES: u64 = 64 << 20;

/// All data about one participant code that were found in a folder, for their deletion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParticipantData {
    /// Code of the participant whose data are to be deleted.
    pub code: String,
    /// Folder that was searched for data of the participant.
    pub root: PathBuf,
    /// The system's folder for temporary files, which was searched as well.
    pub temporary: PathBuf,
    /// Folders of the participant's recordings, including later parts of continued recordings.
    pub recordings: Vec<PathBuf>,
    /// Files in the folders of the participant's recordings that will be deleted.
    pub recording_files: Vec<PathBuf>,
    /// Other files about the participant that will be deleted as a whole.
    pub files: Vec<PathBuf>,
    /// CSV tables about several participants, each with the number of rows that will be deleted.
    pub tables: Vec<(PathBuf, u64)>,
    /// Training records of wizards from which the participant's recordings will be deleted.
    pub trainings: Vec<PathBuf>,
    /// Files that are or may be about the participant and that will be kept, with the reason.
    pub left: Vec<RetainedFile>,
    /// Byte ranges of the participant's rows in each CSV table.
    pub(super) cuts: BTreeMap<PathBuf, Vec<Range<u64>>>,
    /// Folders that are removed if they are empty after the deletion; a folder comes after the one that contains it.
    pub(super) folders: Vec<PathBuf>,
    pub(super) subject: ForgetSubject,
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
    let mut walk = ForgetWalk::through(root, temporary, code)?;
    let folders = std::mem::take(&mut walk.folders);
    let mut found = ParticipantData {
        code: code.to_string(),
        root: root.to_path_buf(),
        temporary: temporary.to_path_buf(),
        recordings: Vec::new(),
        recording_files: Vec::new(),
        files: Vec::new(),
        tables: Vec::new(),
        trainings: Vec::new(),
        left: Vec::new(),
        cuts: BTreeMap::new(),
        folders: Vec::new(),
        subject: walk.subject.clone(),
    };
    for (folder, WalkedFolder { files, is_own }) in &folders {
        let tables = match FolderTables::read(folder, &walk.subject) {
            Ok(tables) => tables,
            Err(reason) => {
                walk.left.push(RetainedFile::unreadable(folder, &reason));
                continue;
            }
        };
        let mut look = FolderLook { tables: &tables, is_own: *is_own, cuts: Vec::new(), found: &mut found };
        for path in files {
            match look.at(path) {
                Ok(true) => {}
                Ok(false) if *is_own => walk.leave_strange(path),
                Ok(false) => {}
                Err(reason) => walk.left.push(RetainedFile::unreadable(path, &reason)),
            }
        }
        look.close();
    }
    found.left.append(&mut walk.left);
    // A recording's settings tell to whom its folder belongs, so the settings stay as long as another file of the
    // participant stays in the folder.
    let is_occupied =
        |folder: &Path| found.left.iter().any(|left| left.path != folder && left.path.starts_with(folder));
    let (kept, deleted): (Vec<PathBuf>, Vec<PathBuf>) = walk
        .recording_files
        .into_iter()
        .partition(|path| path.ends_with(SETTINGS_NAME) && path.parent().is_some_and(is_occupied));
    let keeps = "it says whose recording the folder has, as long as the other files are in the folder; run the command again \
         when they are gone";
    found.left.extend(kept.iter().map(|path| RetainedFile::new(path, keeps)));
    found.left.sort();
    (found.recordings, found.recording_files, found.folders) = (walk.recordings, deleted, walk.own_folders);
    Ok(found)
}

/// Search for data of the participant in the files of one folder.
struct FolderLook<'a> {
    tables: &'a FolderTables,
    /// Whether the folder is, or is inside, the folder of one of the participant's recordings.
    is_own: bool,
    /// Tables with rows of the participant, each with the byte ranges of these rows.
    cuts: Vec<(PathBuf, Vec<Range<u64>>)>,
    found: &'a mut ParticipantData,
}

impl FolderLook<'_> {
    /// Adds a file to the results if the file contains data of the participant. Returns whether the kind of file is
    /// known.
    fn at(&mut self, path: &Path) -> io::Result<bool> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // What a killed program left of a file has the content of that file.
        let extension = Path::new(replaced_name(&name)).extension().unwrap_or_default();
        let extension = extension.to_string_lossy().to_lowercase();
        let is_known = match extension.as_str() {
            "csv" => self.at_table(path)?,
            "json" => self.at_training(path)?,
            "html" => self.at_page(path, &name)?,
            _ => match stream_head::identity(path)? {
                Some(identity) if self.found.subject.is_streamed(&identity) => {
                    self.found.files.push(path.to_path_buf());
                    true
                }
                _ => false,
            },
        };
        if !is_known && !self.is_own && self.found.subject.is_named_by_recording(&name) {
            let reason = "the file has the name of one of the participant's recordings, and does not say what it \
                          contains";
            self.found.left.push(RetainedFile::new(path, reason));
        }
        Ok(is_known)
    }

    fn at_table(&mut self, path: &Path) -> io::Result<bool> {
        let is_dictionary = path.ends_with("dictionary.csv");
        match self.tables.look_at(path, &self.found.subject)? {
            TableMatch::Nothing => return Ok(false),
            // Tables from an analysis of this participant alone are deleted as a whole.
            TableMatch::Own { kept, .. } if self.is_own && (kept == 0 || is_dictionary) => {
                self.found.files.push(path.to_path_buf());
            }
            TableMatch::Own { cut, .. } if cut.is_empty() => {}
            TableMatch::Own { cut, .. } => self.cuts.push((path.to_path_buf(), cut)),
            TableMatch::Unclear(reason) => self.found.left.push(RetainedFile::new(path, reason)),
        }
        Ok(true)
    }

    fn at_training(&mut self, path: &Path) -> io::Result<bool> {
        let Some(record) = training(path)? else { return Ok(false) };
        let subject = &self.found.subject;
        let whose = |one: &WatchedRecording| subject.recording(&one.recording);
        let kept = others(&record, subject).len();
        if record.wizard == subject.code || (kept == 0 && !record.recordings.is_empty()) {
            self.found.files.push(path.to_path_buf());
        } else if record.recordings.iter().any(|one| whose(one) == NamedPerson::Ambiguous) {
            let reason = "a record of training that names a recording, and recordings of several people in different \
                          folders have \
                          this name; tomcom forget --in the folder with one of them, or delete it by hand";
            self.found.left.push(RetainedFile::new(path, reason));
        } else if kept < record.recordings.len() {
            self.found.trainings.push(path.to_path_buf());
        }
        Ok(true)
    }

    fn at_page(&mut self, path: &Path, name: &str) -> io::Result<bool> {
        let Some(bytes) = read_small(path)? else { return Ok(false) };
        let page = String::from_utf8_lossy(&bytes);
        let subject = &self.found.subject;
        let Some(participants) = page_head::participants(&page) else {
            let is_report = name == REPORT_NAME && (self.tables.name_participant() || subject.is_named_in(&bytes));
            if is_report {
                let reason = "a report that does not say who made it and whom it is about; make it again with tomcom study, \
                              or delete it";
                self.found.left.push(RetainedFile::new(path, reason));
            }
            return Ok(is_report);
        };
        let whose: Vec<NamedPerson> = participants.iter().map(|name| subject.participant(name)).collect();
        if whose.contains(&NamedPerson::Subject) {
            self.found.files.push(path.to_path_buf());
        } else if whose.contains(&NamedPerson::Ambiguous) {
            let reason =
                "a report about somebody who has this code, or this code after a seed; make it again, or delete it";
            self.found.left.push(RetainedFile::new(path, reason));
        }
        Ok(true)
    }

    /// Adds the tables of the folder to the results: all that name the participant, or none. The table of trials tells
    /// to whom the recordings in the other tables belong, so it must not be changed while one of those tables is kept.
    fn close(self) {
        let is_study_table = |path: &Path| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            table_named(&stem).is_some() && path.extension().is_some_and(|extension| extension == "csv")
        };
        let Some(folder) = self.cuts.first().and_then(|(path, _)| path.parent()).map(Path::to_path_buf) else { return };
        let is_beside = |left: &&RetainedFile| left.path.parent() == Some(&folder) && is_study_table(&left.path);
        let damaged = self.found.left.iter().find(is_beside).map(|left| left.path.clone());
        for (path, cut) in self.cuts {
            match &damaged {
                Some(damaged) if is_study_table(&path) => {
                    let beside = damaged.file_name().unwrap_or_default().to_string_lossy();
                    let rows = count(cut.len() as u64, "row is", "rows are");
                    let reason = format!(
                        "{rows} about the participant; this table is changed together with {beside}, or not \
                                 at all"
                    );
                    self.found.left.push(RetainedFile::new(&path, reason));
                }
                _ => {
                    self.found.tables.push((path.clone(), cut.len() as u64));
                    self.found.cuts.insert(path, cut);
                }
            }
        }
    }
}

/// Recordings of other participants in the same training record of a wizard.
pub(super) fn others(record: &WizardTrainingRecord, subject: &ForgetSubject) -> Vec<WatchedRecording> {
    let is_other = |one: &&WatchedRecording| subject.recording(&one.recording) != NamedPerson::Subject;
    record.recordings.iter().filter(is_other).cloned().collect()
}

/// The training record in a file; `None` if the file is anything else.
pub(super) fn training(path: &Path) -> io::Result<Option<WizardTrainingRecord>> {
    Ok(read_small(path)?.and_then(|bytes| serde_json::from_slice(&bytes).ok()))
}

/// The content of a file; `None` if it is longer than any report or training record.
fn read_small(path: &Path) -> io::Result<Option<Vec<u8>>> {
    match fs::metadata(path)?.len() {
        ..=MAX_BYTES => fs::read(path).map(Some),
        _ => Ok(None),
    }
}
