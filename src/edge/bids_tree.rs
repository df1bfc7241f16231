//! Writes the tree of a BIDS data set.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use flate2::{Compression, GzBuilder};

use super::file_error::{FileError, FileResult, read_regular};
use crate::analysis::bids::{BidsFile, CODE_COLUMN, DESCRIPTION_NAME, PARTICIPANTS_NAME, PROGRAM_NAME};

/// What would be right where the tree cannot be written.
const REMEDY: &str = "a new folder on a disk with free space";

/// A folder in which a tree is made.
#[derive(Debug)]
pub struct BidsTree {
    root: PathBuf,
}

impl BidsTree {
    /// Makes the folder. One that is there has to be empty, so that nothing of an earlier export, or of somebody else, is in the tree.
    ///
    /// # Errors
    /// There is something in the folder, or it cannot be made.
    pub fn create(root: &Path) -> FileResult<BidsTree> {
        match fs::read_dir(root) {
            Ok(mut entries) => {
                if entries.next().is_some() {
                    let found = "a folder that is not empty".to_string();
                    return Err(FileError::from_finding(root, found, "a new or empty folder".to_string()));
                }
            }
            Err(reason) if reason.kind() == ErrorKind::NotFound => {
                fs::create_dir_all(root).map_err(|reason| FileError::unreadable(root, reason, REMEDY))?;
            }
            Err(reason) => return Err(FileError::unreadable(root, reason, REMEDY)),
        }
        Ok(BidsTree { root: root.to_path_buf() })
    }

    /// Writes a file; its name is its path below the tree. What ends with `.gz` is compressed.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, file: &BidsFile) -> FileResult<()> {
        let path = self.root.join(&file.name);
        let write = || {
            fs::create_dir_all(path.parent().unwrap_or(&self.root))?;
            match file.name.ends_with(".gz") {
                true => fs::write(&path, compressed(&file.text)?),
                false => fs::write(&path, &file.text),
            }
        };
        write().map_err(|reason| FileError::unreadable(&path, reason, REMEDY))
    }
}

/// The codes of the participants in a tree that this program wrote; nothing for every other folder.
pub(super) fn codes(root: &Path) -> Option<Vec<String>> {
    let description = read_regular(&root.join(DESCRIPTION_NAME)).ok()?;
    let description: serde_json::Value = serde_json::from_str(&description).ok()?;
    let is_ours = description["GeneratedBy"].as_array()?.iter().any(|by| by["Name"] == PROGRAM_NAME);
    let people = is_ours.then(|| read_regular(&root.join(PARTICIPANTS_NAME)).unwrap_or_default())?;
    let mut rows = people.lines().map(|line| line.split('\t'));
    let column = rows.next()?.position(|name| name == CODE_COLUMN)?;
    Some(rows.filter_map(|mut cells| cells.nth(column).map(str::to_string)).collect())
}

/// As gzip writes it, without time and name, so that the same text gives the same bytes.
fn compressed(text: &str) -> io::Result<Vec<u8>> {
    let mut out = GzBuilder::new().write(Vec::new(), Compression::default());
    out.write_all(text.as_bytes())?;
    out.finish()
}
