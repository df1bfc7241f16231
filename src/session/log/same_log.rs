//! What tells whether two recordings are copies: their logs, and the codes of raters that stand beside the logs.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::files::file_error::{FileError, FileResult, open_regular};
use crate::log::consensus_file::CONSENSUS_NAME;
use crate::log::rater_codes::code_file_names;
use crate::log::reader::{MAX_LINE, first_line, is_blank};

const REMEDY: &str = "a readable recording";

/// SHA-256 digest of the header of a log, in hexadecimal, without its line end. Each session has a header of its own, so
/// that only copies of one log have the same digest.
///
/// # Errors
/// The log cannot be read.
pub fn header_digest(log: &Path) -> FileResult<String> {
    let line = open_regular(log).and_then(|file| first_line(&mut BufReader::new(file)));
    let line = line.map_err(|reason| FileError::unreadable(log, reason, REMEDY))?;
    Ok(Sha256::digest(line.trim_ascii_end()).iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Logs of one session, by their indices: copies of each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SameLogs {
    /// The logs with the most events.
    pub longest: Vec<usize>,
    /// The logs that are a beginning of the longest ones, such as a copy that was made before the session ended.
    pub beginnings: Vec<usize>,
}

impl SameLogs {
    /// Groups logs, each with a key that only logs of one session share, such as its [`header_digest`]. Ends of lines
    /// make no difference: neither those of other systems, nor empty lines at the end, nor a last one that is missing.
    ///
    /// # Errors
    /// A log cannot be read.
    pub fn of(logs: &[(&Path, &str)]) -> FileResult<Vec<SameLogs>> {
        let mut order: Vec<usize> = (0..logs.len()).collect();
        order.sort_by_key(|&index| logs[index].1);
        let mut all = Vec::new();
        for session in order.chunk_by(|&one, &other| logs[one].1 == logs[other].1) {
            let mut found: Vec<SameLogs> = Vec::new();
            'logs: for &log in session {
                for same in &mut found {
                    match compare(logs[log].0, logs[same.longest[0]].0)? {
                        Some(Ordering::Equal) => same.longest.push(log),
                        Some(Ordering::Less) => same.beginnings.push(log),
                        Some(Ordering::Greater) => {
                            same.beginnings.append(&mut std::mem::replace(&mut same.longest, vec![log]))
                        }
                        None => continue,
                    }
                    continue 'logs;
                }
                found.push(SameLogs { longest: vec![log], beginnings: Vec::new() });
            }
            all.extend(found);
        }
        Ok(all)
    }

    /// All these logs, the longest first.
    pub fn all(&self) -> impl Iterator<Item = usize> {
        self.longest.iter().chain(&self.beginnings).copied()
    }
}

/// Whether a log is equal to another one, a beginning of it, or begins with it; `None` for logs that differ.
fn compare(one: &Path, other: &Path) -> FileResult<Option<Ordering>> {
    let (mut one, mut other) = (LogText::open(one)?, LogText::open(other)?);
    loop {
        match (one.read()?, other.read()?) {
            (false, false) => return Ok(Some(Ordering::Equal)),
            (false, true) => return Ok(Some(Ordering::Less)),
            (true, false) => return Ok(Some(Ordering::Greater)),
            (true, true) if one.line == other.line => {}
            // A copy can end within a line.
            (true, true) if other.line.starts_with(&one.line) => return Ok((!one.read()?).then_some(Ordering::Less)),
            (true, true) if one.line.starts_with(&other.line) => {
                return Ok((!other.read()?).then_some(Ordering::Greater));
            }
            (true, true) => return Ok(None),
        }
    }
}

/// The lines of a log with text, one after another, without their ends.
struct LogText<'a> {
    path: &'a Path,
    input: BufReader<File>,
    line: Vec<u8>,
}

impl LogText<'_> {
    fn open(path: &Path) -> FileResult<LogText<'_>> {
        let file = open_regular(path).map_err(|reason| FileError::unreadable(path, reason, REMEDY))?;
        Ok(LogText { path, input: BufReader::with_capacity(1 << 16, file), line: Vec::new() })
    }

    /// Reads the next line; returns false at the end of the log.
    fn read(&mut self) -> FileResult<bool> {
        loop {
            self.line.clear();
            let read = self.input.by_ref().take(MAX_LINE as u64).read_until(b'\n', &mut self.line);
            let is_there = read.map_err(|reason| FileError::unreadable(self.path, reason, REMEDY))? > 0;
            self.line.truncate(self.line.trim_ascii_end().len());
            if !is_there || !is_blank(&self.line) {
                return Ok(is_there);
            }
        }
    }
}

/// Names of the files with codes of raters, and with their consensus, in the folder of a recording.
///
/// # Errors
/// The folder cannot be read, or has codes of a rater in a file of another kind.
pub fn code_files(folder: &Path) -> FileResult<BTreeSet<String>> {
    let mut names = code_file_names(folder)?;
    names.extend(folder.join(CONSENSUS_NAME).exists().then(|| CONSENSUS_NAME.to_string()));
    Ok(names)
}

/// The first file with codes of raters beside a log that does not stand with the same content in another folder, and
/// whether that folder has a file of this name; `None` if nothing is lost without the first folder.
///
/// # Errors
/// A folder or a file with codes cannot be read.
pub fn differing_codes(folder: &Path, other: &Path) -> FileResult<Option<(String, bool)>> {
    let text = |path: &Path| {
        let mut bytes = Vec::new();
        let read = open_regular(path).and_then(|mut file| io::copy(&mut file, &mut bytes));
        read.map_err(|reason| FileError::unreadable(path, reason, REMEDY))?;
        bytes.retain(|byte| *byte != b'\r');
        bytes.truncate(bytes.trim_ascii_end().len());
        Ok::<Vec<u8>, FileError>(bytes)
    };
    for name in code_files(folder)? {
        let beside = other.join(&name);
        let is_there = beside.exists();
        if !is_there || text(&folder.join(&name))? != text(&beside)? {
            return Ok(Some((name, is_there)));
        }
    }
    Ok(None)
}
