//! Rescue of recordings whose folder vanished while they were written: the folder for rescued recordings, and a note
//! that names the original folder.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::file_error::read_regular;
use tomcom_core::base::text::PathText;

/// Prefix of the folders for rescued recordings in the system's folder for temporary files.
pub const RESCUED: &str = "tomcom-rescued-";
/// File name of the note in the folder of a rescued recording.
pub const RESCUE_NOTE_NAME: &str = "rescued.toml";

/// Creates a folder for a rescued recording in the system's folder for temporary files, which only the user of the
/// program can read.
///
/// # Errors
/// The folder cannot be created.
pub fn new_rescue_folder() -> io::Result<PathBuf> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    Ok(builder.prefix(RESCUED).tempdir()?.keep())
}

/// Note beside a rescued log that tells the recording's original folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RescueNote {
    /// Original folder of the recording, with symbolic links resolved.
    pub home: PathText,
}

impl RescueNote {
    /// Writes the note into the folder of a rescued recording.
    ///
    /// # Errors
    /// The note cannot be written or exists already.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let text = toml::to_string(self).map_err(io::Error::other)?;
        let mut file = OpenOptions::new().write(true).create_new(true).open(folder.join(RESCUE_NOTE_NAME))?;
        file.write_all(text.as_bytes())
    }

    /// Reads the rescue note in the folder of a recording; `None` if the note is missing or unreadable.
    pub fn read(folder: &Path) -> Option<RescueNote> {
        toml::from_str(&read_regular(&folder.join(RESCUE_NOTE_NAME)).ok()?).ok()
    }
}
