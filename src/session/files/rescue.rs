//! Rescue of recordings whose folder vanished while they were written: the folder for rescued recordings, and a note
//! that names the original folder.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files::file_error::read_regular;
use tomcom_core::base::text::PathText;

/// Prefix of folders for rescued recordings, in the system's folder for temporary files.
pub const RESCUED: &str = "tomcom-rescued-";
pub const RESCUE_NOTE_NAME: &str = "rescued.toml";

/// Only the user of the program can read it.
pub(crate) fn new_rescue_folder() -> io::Result<PathBuf> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    Ok(builder.prefix(RESCUED).tempdir()?.keep())
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RescueNote {
    /// With symbolic links resolved.
    pub home: PathText,
}

impl RescueNote {
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let text = toml::to_string(self).map_err(io::Error::other)?;
        let mut file = OpenOptions::new().write(true).create_new(true).open(folder.join(RESCUE_NOTE_NAME))?;
        file.write_all(text.as_bytes())
    }

    /// `None` if it is missing or unreadable.
    pub fn read(folder: &Path) -> Option<RescueNote> {
        toml::from_str(&read_regular(&folder.join(RESCUE_NOTE_NAME)).ok()?).ok()
    }
}
