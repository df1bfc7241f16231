//! Writes the folder tree of a BIDS data set (Brain Imaging Data Structure).

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use flate2::{Compression, GzBuilder};

use super::file_error::{FileError, FileResult, read_regular};
use crate::analysis::bids::{BidsFile, CODE_COLUMN, DESCRIPTION_NAME, PARTICIPANTS_NAME, PROGRAM_NAME};

/// Advice in error messages when the data set cannot be written.
const REMEDY: &str = "a new folder on a disk with free space";

/// Root folder of a BIDS data set that is being written.
#[derive(Debug)]
pub struct BidsTree {
    root: PathBuf,
}

impl BidsTree {
    /// Creates the root folder of a data set. An existing folder has to be empty, so that the data set contains nothing
    /// of an earlier export or of another program.
    ///
    /// # Errors
    /// The folder is not empty, or cannot be created.
    pub fn create(root: &Path) -> FileResult<BidsTree> {
        match fs::read_dir(root) {
            Ok(mut entries) => {
                if entries.next().is_some() {
                    let found = "a folder that is not empty".to_string();
                    return Err(FileError::from_finding(root, found, "a new or empty folder".to_string()));
                }
            }
            Err(reason) if reason.kind() == ErrorKind::NotFound => {
                fs::create_dir_all(root).map_err(|reason| FileError::not_written(root, reason, REMEDY))?;
            }
            Err(reason) => return Err(FileError::unreadable(root, reason, REMEDY)),
        }
        Ok(BidsTree { root: root.to_path_buf() })
    }

    /// Writes a file of the data set; the file's name is the path below the root folder. Files whose name ends with
    /// `.gz` are compressed.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, file: &BidsFile) -> FileResult<()> {
        let path = self.root.join(&file.name);
        let write = || {
            fs::create_dir_all(path.parent().unwrap_or(&self.root))?;
            match file.name.ends_with(".gz") {
                true => fs::write(&path, compressed(&file.text)?),
                false => fs::write(&path, &file.text),
            }
        };
        write().map_err(|reason| FileError::not_written(&path, reason, REMEDY))
    }
}

/// Codes of the participants in a BIDS data set that this program wrote; `None` for every other folder.
pub(super) fn codes(root: &Path) -> Option<Vec<String>> {
    let description = read_regular(&root.join(DESCRIPTION_NAME)).ok()?;
    let description: serde_json::Value = serde_json::from_str(&description).ok()?;
    let is_ours = description["GeneratedBy"].as_array()?.iter().any(|by| by["Name"] == PROGRAM_NAME);
    let people = is_ours.then(|| read_regular(&root.join(PARTICIPANTS_NAME)).unwrap_or_default())?;
    let mut rows = people.lines().map(|line| line.split('\t'));
    let column = rows.next()?.position(|name| name == CODE_COLUMN)?;
    Some(rows.filter_map(|mut cells| cells.nth(column).map(str::to_string)).collect())
}

/// Compresses a text with gzip, without time and file name, so that the same text gives the same bytes.
fn compressed(text: &str) -> io::Result<Vec<u8>> {
    let mut out = GzBuilder::new().write(Vec::new(), Compression::default());
    out.write_all(text.as_bytes())?;
    out.finish()
}
