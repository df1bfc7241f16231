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
use crate::log::reader::{MAX_LINE, first_line_of, is_blank};

const REMEDY: &str = "a readable recording";

/// SHA-256 of a log's header without its line end, in hexadecimal. Each session has a header of its own, so only copies
/// have the same.
pub fn header_digest(log: &Path) -> FileResult<String> {
    let line = first_line_of(log).map_err(|reason| FileError::unreadable(log, reason, REMEDY))?;
    Ok(Sha256::digest(line.trim_ascii_end()).iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Logs of one session, by their indices: copies of each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SameLogs {
    /// Those with the most events.
    pub longest: Vec<usize>,
    /// Those that are a beginning of the longest ones, such as a copy that was made before the session ended.
    pub beginnings: Vec<usize>,
}

impl SameLogs {
    /// Groups logs, each with a key that only logs of one session share, such as its [`header_digest`]. Line ends of
    /// other systems, and missing or empty last lines, make no difference.
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

    /// The longest first.
    pub fn all(&self) -> impl Iterator<Item = usize> {
        self.longest.iter().chain(&self.beginnings).copied()
    }
}

/// Whether a log is equal to another one, a beginning of it, or begins with it; `None` if they differ.
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

/// The lines with text, one after another, without their ends.
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

    /// The next line; false at the end.
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

/// Files with raters' codes, and with their consensus.
pub fn code_files(folder: &Path) -> FileResult<BTreeSet<String>> {
    let mut names = code_file_names(folder)?;
    names.extend(folder.join(CONSENSUS_NAME).exists().then(|| CONSENSUS_NAME.to_string()));
    Ok(names)
}

/// The first file with codes that does not stand with the same content in another folder, and whether one of this name
/// does.
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
