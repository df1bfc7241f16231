//! Files of pools (simulated participants for power analyses) in the format JSON Lines
//! ([`crate::simulation_pool`]).

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::simulation_pool::{POOL_FORMAT, PoolHeader, SimulationPool};
use tomcom_session::files::file_error::{FileError, FileResult, read_bytes};
use tomcom_session::files::overwrite;

/// Largest size of a pool's file, in bytes.
const MAX_POOL: u64 = 1 << 30;
const REMEDY: &str = "a pool that tomcom power or tomcom arms wrote with --out";

/// Reads the parts of a pool of simulated participants and joins them.
///
/// # Errors
/// A file cannot be read, is no pool of this format, or the parts do not belong to one pool.
pub fn read_pool(paths: &[PathBuf]) -> FileResult<SimulationPool> {
    let parts = paths.iter().map(|path| read_part(path)).collect::<FileResult<Vec<_>>>()?;
    SimulationPool::joined(parts).map_err(|wrong| {
        let path = paths.get(wrong.index).map_or(Path::new("--from"), PathBuf::as_path);
        FileError::from_finding(path, wrong.found, wrong.remedy)
    })
}

fn read_part(path: &Path) -> FileResult<SimulationPool> {
    let unreadable = |reason| FileError::unreadable(path, reason, REMEDY);
    let text = String::from_utf8(read_bytes(path, MAX_POOL).map_err(unreadable)?)
        .map_err(|error| unreadable(io::Error::new(io::ErrorKind::InvalidData, error.utf8_error())))?;
    let mut lines = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        lines.push((start..start + line.trim_end().len(), line));
        start += line.len();
    }
    let Some(((place, first), trials)) = lines.split_first() else {
        return Err(FileError::from_finding(path, "an empty file".to_string(), REMEDY.to_string()));
    };
    let at = |place: &Range<usize>, found: String, remedy: &str| {
        FileError::at(path, &text, Some(place.clone()), found, remedy.to_string())
    };
    let header: PoolHeader = parsed(first).map_err(|found| at(place, found, REMEDY))?;
    if header.pool != POOL_FORMAT {
        let remedy = format!("a pool of format {POOL_FORMAT}, or the version of the program that wrote it");
        return Err(at(place, format!("a pool of format {}", header.pool), &remedy));
    }
    let read = trials.iter().map(|(place, line)| parsed(line).map_err(|found| at(place, found, REMEDY)));
    let read = read.collect::<FileResult<Vec<_>>>()?;
    SimulationPool::from_trials(header, read).map_err(|wrong| {
        let place = trials.get(wrong.index).map_or(place, |(place, _)| place);
        at(place, wrong.found, &wrong.remedy)
    })
}

fn parsed<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    serde_json::from_str(line).map_err(|error| format!("a line that is not a line of a pool: {error}"))
}

/// Checks that a pool with this header can be written to this path. A pool takes long to simulate, so a file with
/// another pool is not overwritten.
///
/// # Errors
/// There is a file at the path that is not this pool.
pub fn check_pool(path: &Path, header: &PoolHeader) -> FileResult<()> {
    let own = line(header);
    let is_own = |head: &[u8]| overwrite::first_line(head) == own.trim_end().as_bytes();
    overwrite::check(path, "the same pool", is_own).map_err(|reason| FileError::unwritable(path, reason))
}

/// Writes the file of a pool of simulated participants, completely or not at all.
///
/// # Errors
/// There is a file at the path that is not this pool, or the folder cannot be written to.
pub fn write_pool(path: &Path, pool: &SimulationPool) -> FileResult<()> {
    check_pool(path, &pool.header)?;
    let mut text = line(&pool.header);
    for trial in pool.trials() {
        text += &line(&trial);
    }
    overwrite::write(path, text.as_bytes()).map_err(|reason| FileError::unwritable(path, reason))
}

fn line(value: &impl Serialize) -> String {
    // Writing JSON cannot fail here, since headers and trials contain only string keys and finite numbers.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}
