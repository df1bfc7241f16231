//! The files of a tournament: its table, and what is kept beside each recording.

use std::fs;
use std::io;
use std::path::Path;

use crate::files::export::{check_csv, write_csv};
use crate::tournament::{KeptFigures, Tournament, csv_header, csv_rows};
use tomcom_session::files::file_error::{FileError, FileResult};

/// Beside a recording: what cannot be read from its log.
const KEPT: &str = "tournament.json";

/// What was kept beside a recording; a damaged file counts as none, since it is made anew.
pub fn kept(recording: &Path) -> Option<KeptFigures> {
    serde_json::from_slice(&fs::read(recording.join(KEPT)).ok()?).ok()
}

pub fn keep(recording: &Path, figures: &KeptFigures) -> FileResult<()> {
    let path = recording.join(KEPT);
    let written = serde_json::to_vec(figures).map_err(io::Error::other).and_then(|text| fs::write(&path, text));
    written.map_err(|reason| FileError::unwritable(&path, reason))
}

/// Errors: there is a file at the path that this program did not write.
pub fn check_table(path: &Path) -> FileResult<()> {
    check_csv(path, "a table of a tournament", &csv_header().join(","))
}

pub fn write_table(path: &Path, found: &Tournament) -> FileResult<()> {
    write_csv(path, std::iter::once(csv_header()).chain(csv_rows(found)))
}
