//! Recordings whose folder vanished while they were written: where they are saved, and the note beside them that says where
//! they belong.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// What the names of the folders begin with, below the system's folder for temporary files.
pub const RESCUED: &str = "tomcom-rescued-";
/// The name of the note in the folder of a recording that was saved there.
pub const RESCUE_NOTE_NAME: &str = "rescued.toml";

/// The folder below which this program saves recordings, in the system's folder for temporary files.
pub fn rescue_folder(temporary: &Path) -> PathBuf {
    temporary.join(format!("{RESCUED}{}", std::process::id()))
}

/// What stands beside a log that was saved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RescueNote {
    /// The folder in which the recording was, without symbolic links.
    pub home: PathBuf,
}

impl RescueNote {
    /// Writes the note into the folder of a recording.
    ///
    /// # Errors
    /// It cannot be written, or is there already.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let text = toml::to_string(self).map_err(io::Error::other)?;
        let mut file = OpenOptions::new().write(true).create_new(true).open(folder.join(RESCUE_NOTE_NAME))?;
        file.write_all(text.as_bytes())
    }

    /// The note in the folder of a recording; none where there is none that can be read.
    pub fn read(folder: &Path) -> Option<RescueNote> {
        toml::from_str(&fs::read_to_string(folder.join(RESCUE_NOTE_NAME)).ok()?).ok()
    }
}
