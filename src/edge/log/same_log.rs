//! What tells whether two recordings are copies: their logs, and the decisions that stand beside the logs.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::consensus_file::CONSENSUS_NAME;
use super::rater_codes::is_codes_file;
use super::{CORRECTION_NAME, EXCLUSION_NAME};
use crate::edge::file_error::{FileError, FileResult, open_regular};

const REMEDY: &str = "a readable recording";

/// SHA-256 digest of a log, in hexadecimal: logs with the same digest are equal to the last byte.
///
/// # Errors
/// The log cannot be read.
pub fn log_digest(log: &Path) -> FileResult<String> {
    let mut digest = Sha256::new();
    let read = open_regular(log).and_then(|mut file| io::copy(&mut file, &mut digest));
    read.map_err(|reason| FileError::unreadable(log, reason, REMEDY))?;
    Ok(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The files with later decisions in the folder of a recording, by name: exclusion, correction, raters' codes and their consensus.
///
/// # Errors
/// The folder or one of the files cannot be read.
pub fn decisions(folder: &Path) -> FileResult<BTreeMap<String, Vec<u8>>> {
    let unreadable = |path: &Path, reason| FileError::unreadable(path, reason, REMEDY);
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).map_err(|reason| unreadable(folder, reason))? {
        let path = entry.map_err(|reason| unreadable(folder, reason))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if [EXCLUSION_NAME, CORRECTION_NAME, CONSENSUS_NAME].contains(&name.as_str()) || is_codes_file(&name) {
            let mut bytes = Vec::new();
            let read = open_regular(&path).and_then(|mut file| io::copy(&mut file, &mut bytes));
            read.map_err(|reason| unreadable(&path, reason))?;
            found.insert(name, bytes);
        }
    }
    Ok(found)
}
