//! Files with the parts of a study: JSON Lines ([`crate::study_part`]). They are written and read recording by
//! recording, so that memory use does not grow with the number of recordings.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::study_part::{AnalysedRecording, PART_FORMAT, PartHeader, PartShared};
use tomcom_session::files::file_error::{FileError, FileResult, open_regular};
use tomcom_session::files::overwrite;
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::log::at_line;

/// Longest line of a part, in bytes: the rows of events of one recording.
const MAX_LINE: u64 = 1 << 28;
const REMEDY: &str = "a part that tomcom study wrote with --shard, unchanged";

#[derive(Debug)]
pub struct PartWriter {
    path: PathBuf,
    file: Replacement,
}

impl PartWriter {
    /// Begins the file of a part. An earlier file with the same part of the study is replaced. Errors: there is a file
    /// at the path that is not this part, or the folder cannot be written to.
    pub fn create(path: &Path, header: &PartHeader, shared: &PartShared) -> FileResult<PartWriter> {
        let unwritable = |reason| FileError::unwritable(path, reason);
        let is_own = |head: &[u8]| {
            let there = serde_json::from_slice::<PartHeader>(overwrite::first_line(head));
            there.is_ok_and(|there| (there.shard, there.shards) == (header.shard, header.shards))
        };
        overwrite::check(path, "the same part", is_own).map_err(unwritable)?;
        let file = Replacement::begin(path).map_err(unwritable)?;
        let mut part = PartWriter { path: path.to_path_buf(), file };
        part.line(header)?;
        part.line(shared)?;
        Ok(part)
    }

    pub fn add(&mut self, recording: &AnalysedRecording, rows: &[Vec<u8>; 5]) -> FileResult<()> {
        self.line(recording)?;
        // Rows of tables are always UTF-8.
        let rows: [Cow<str>; 5] = rows.each_ref().map(|rows| String::from_utf8_lossy(rows));
        self.line(&rows)
    }

    fn line(&mut self, value: &impl Serialize) -> FileResult<()> {
        let unwritable = |reason| FileError::unwritable(&self.path, reason);
        let mut line = serde_json::to_vec(value).map_err(|error| unwritable(io::Error::from(error)))?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(unwritable)
    }

    pub fn finish(self) -> FileResult<()> {
        let PartWriter { path, file } = self;
        file.finish().map_err(|reason| FileError::unwritable(&path, reason))
    }
}

#[derive(Debug)]
pub struct PartReader {
    pub header: PartHeader,
    pub shared: PartShared,
    path: PathBuf,
    lines: BufReader<File>,
    number: usize,
}

impl PartReader {
    /// Errors: the file cannot be read, or is no study part of this format.
    pub fn open(path: &Path) -> FileResult<PartReader> {
        let mut lines =
            BufReader::new(open_regular(path).map_err(|reason| FileError::unreadable(path, reason, REMEDY))?);
        let (path, mut number) = (path.to_path_buf(), 0);
        let Some(text) = next_line(&path, &mut lines, &mut number)? else {
            return Err(FileError::from_finding(&path, "an empty file".to_string(), REMEDY.to_string()));
        };
        let header: PartHeader = parsed(&path, number, &text)?;
        if header.study_part != PART_FORMAT {
            let found = format!("a study's part of format {}", header.study_part);
            let remedy =
                format!("a study's part of format {PART_FORMAT}, or the version of the program that wrote the part");
            return Err(at_line(&path, number, &text, 0, found, remedy));
        }
        let cut = || FileError::from_finding(&path, "the end after the first line".to_string(), REMEDY.to_string());
        let text = next_line(&path, &mut lines, &mut number)?.ok_or_else(cut)?;
        let shared = parsed(&path, number, &text)?;
        Ok(PartReader { header, shared, path, lines, number })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next analysed recording with its rows of the tables of events; `None` after the last recording. Errors: a
    /// line is not that of a part, or there are more or fewer recordings than the header says.
    pub(crate) fn next_recording(&mut self) -> FileResult<Option<(AnalysedRecording, [Vec<u8>; 5])>> {
        let (read, all) = ((self.number as u64 - 2) / 2, self.header.recordings);
        let is_whole = read == all;
        match (self.next()?, is_whole) {
            (None, true) => Ok(None),
            (Some(text), false) => {
                let recording = parsed(&self.path, self.number, &text)?;
                let Some(rows) = self.next()? else { return Err(self.cut(read)) };
                let rows: [String; 5] = parsed(&self.path, self.number, &rows)?;
                Ok(Some((recording, rows.map(String::into_bytes))))
            }
            (None, false) => Err(self.cut(read)),
            (Some(text), true) => {
                let found = format!("a line after the last of {all} recordings");
                Err(at_line(&self.path, self.number, &text, 0, found, REMEDY.to_string()))
            }
        }
    }

    fn next(&mut self) -> FileResult<Option<String>> {
        next_line(&self.path, &mut self.lines, &mut self.number)
    }

    fn cut(&self, read: u64) -> FileError {
        let found = format!("the end after {read} of {} recordings", self.header.recordings);
        FileError::from_finding(&self.path, found, REMEDY.to_string())
    }
}

/// Without the line end; `None` at the end of the file. A last line without a line end was cut.
fn next_line(path: &Path, lines: &mut BufReader<File>, number: &mut usize) -> FileResult<Option<String>> {
    let mut text = String::new();
    lines.by_ref().take(MAX_LINE).read_line(&mut text).map_err(|reason| FileError::unreadable(path, reason, REMEDY))?;
    if text.is_empty() {
        return Ok(None);
    }
    *number += 1;
    match text.pop() {
        Some('\n') => Ok(Some(text)),
        _ => Err(at_line(path, *number, &text, text.len(), "a line without its end".to_string(), REMEDY.to_string())),
    }
}

fn parsed<T: DeserializeOwned>(path: &Path, number: usize, text: &str) -> FileResult<T> {
    serde_json::from_str(text).map_err(|error| {
        let found = format!("a line that is not a line of a study's part: {error}");
        at_line(path, number, text, error.column().saturating_sub(1), found, REMEDY.to_string())
    })
}
