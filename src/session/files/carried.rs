//! The files that the program carries, so that it runs without a checkout, and `tomcom new` writes a lab's folder.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use crate::files::file_error::{FileError, FileResult, read_regular};
use tomcom_core::base::text::nearest as nearest_name;

macro_rules! carried {
    ($($path:literal)*) => {
        /// Paths from the lab's folder, with their texts.
        pub const FILES: &[(&str, &str)] = &[$(($path, include_str!(concat!("../../../", $path)))),*];
    };
}

carried! {
    "layouts/burger.toml"
    "layouts/sushi.toml"
    "recipes/burger.toml"
    "recipes/sushi.toml"
    "sessions/all-arms.toml"
    "sessions/arms.toml"
    "sessions/burger.toml"
    "sessions/default.toml"
    "sessions/paper.toml"
    "sessions/people/accepted.toml"
    "sessions/people/robustness.toml"
    "sessions/probes.toml"
    "sessions/questionnaires/acceptance.de.toml"
    "sessions/questionnaires/acceptance.toml"
    "sessions/questionnaires/demographics.de.toml"
    "sessions/questionnaires/demographics.toml"
    "sessions/questionnaires/nasa-tlx.de.toml"
    "sessions/questionnaires/nasa-tlx.toml"
    "sessions/questionnaires/sus.de.toml"
    "sessions/questionnaires/sus.toml"
    "sessions/study.toml"
    "sessions/tutorials/burger.de.toml"
    "sessions/tutorials/burger.toml"
    "sessions/tutorials/sushi.de.toml"
    "sessions/tutorials/sushi.toml"
}

/// A folder that every lab's folder has.
const KITCHENS: &str = "layouts";
/// What to do about a carried file that is missed.
pub const REMEDY: &str =
    "tomcom new DIR writes a folder with this file, and overwrites nothing; then cd DIR, and again";

/// Whether the program carries a file with this path.
pub fn has(path: &Path) -> bool {
    text(path).is_some()
}

/// The carried text for a path at which there is no file. `None` in a lab's folder: its files are its own, and one that is
/// missing there is an error.
pub fn instead_of(path: &Path) -> Option<&'static str> {
    text(path).filter(|_| !path.exists() && !Path::new(KITCHENS).exists())
}

/// The carried path that is nearest to a mistyped one; `None` in a lab's folder.
pub(super) fn nearest(path: &Path) -> Option<PathBuf> {
    if has(path) || Path::new(KITCHENS).exists() {
        return None;
    }
    let names = FILES.iter().map(|(name, _)| *name);
    nearest_name(&path.to_string_lossy(), names).map(PathBuf::from)
}

/// Refuses a file that would be read from what the program carries: who runs a session with a person and names its file
/// means that file, and may be in the wrong folder.
pub fn refuse(path: &Path) -> FileResult<()> {
    match (instead_of(path), fs::metadata(path)) {
        (Some(_), Err(reason)) => Err(FileError::unreadable(path, reason, REMEDY)),
        _ => Ok(()),
    }
}

/// Reads the text of a settings file; outside of a lab's folder, of a carried one.
pub(super) fn read(path: &Path) -> io::Result<String> {
    instead_of(path).map_or_else(|| read_regular(path), |text| Ok(text.to_string()))
}

fn text(path: &Path) -> Option<&'static str> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => plain.pop().then_some(())?,
            part => plain.push(part),
        }
    }
    FILES.iter().find(|(carried, _)| Path::new(carried) == plain).map(|(_, text)| *text)
}
