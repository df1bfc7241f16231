//! The files of a tournament: its table, and what is kept beside each recording.

use std::fs;
use std::io;
use std::path::Path;

use crate::tournament::{KeptFigures, Tournament, csv_header, csv_rows};
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::overwrite;

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
    let names = csv_header().join(",");
    overwrite::check(path, "a table of a tournament", |head| overwrite::first_line(head) == names.as_bytes())
        .map_err(|reason| FileError::unwritable(path, reason))
}

pub fn write_table(path: &Path, found: &Tournament) -> FileResult<()> {
    let write = || -> io::Result<()> {
        let mut table = csv::Writer::from_writer(Vec::new());
        table.write_record(csv_header())?;
        csv_rows(found).iter().try_for_each(|row| table.write_record(row))?;
        let bytes = table.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
        overwrite::write(path, &bytes)
    };
    write().map_err(|reason| FileError::unwritable(path, reason))
}
