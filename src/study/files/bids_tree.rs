//! Writes the folder tree of a BIDS data set (Brain Imaging Data Structure).

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use flate2::{Compression, GzBuilder};

use crate::analysis::bids::BidsFile;
use crate::analysis::bids::dataset::{CODE_COLUMN, DESCRIPTION_NAME, PARTICIPANTS, PROGRAM_NAME};
use crate::analysis::bids::recording_tables::{LongTableFacts, LongTableRow};
use crate::files::new_folder::NewFolder;
use tomcom_core::base::time::SessionTime;
use tomcom_session::files::file_error::{FileError, FileResult, read_regular};

const REMEDY: &str = "a new folder on a disk with free space";

#[derive(Debug)]
pub struct BidsTree {
    root: PathBuf,
    _new: NewFolder,
}

impl BidsTree {
    /// Creates the root folder of a data set. An existing folder has to be empty, so that the data set contains nothing
    /// of an earlier export or of another program. Errors: the folder is not empty, or cannot be created.
    pub fn create(root: &Path) -> FileResult<BidsTree> {
        match fs::read_dir(root) {
            Ok(mut entries) => {
                if entries.next().is_some() {
                    let found = "a folder that is not empty".to_string();
                    return Err(FileError::from_finding(root, found, "a new or empty folder".to_string()));
                }
            }
            Err(reason) if reason.kind() == ErrorKind::NotFound => {}
            Err(reason) => return Err(FileError::unreadable(root, reason, REMEDY)),
        }
        let new = NewFolder::create(root).map_err(|reason| FileError::not_written(root, reason, REMEDY))?;
        Ok(BidsTree { root: root.to_path_buf(), _new: new })
    }

    /// `name` is the path below the root folder; what ends with `.gz` is compressed.
    pub fn write(&self, file: &BidsFile) -> FileResult<()> {
        let path = self.root.join(&file.name);
        let write = || {
            fs::create_dir_all(path.parent().unwrap_or(&self.root))?;
            match file.name.ends_with(".gz") {
                true => fs::write(&path, compressed(&file.text)?),
                false => fs::write(&path, &file.text),
            }
        };
        write().map_err(|reason| FileError::not_written(&path, reason, REMEDY))
    }

    /// `name`: path below the root folder. Errors: no file can be written to the data set's folder.
    pub fn begin(&self, name: &str, heading: String) -> FileResult<LongTableFile> {
        let file =
            tempfile::tempfile_in(&self.root).map_err(|reason| FileError::not_written(&self.root, reason, REMEDY))?;
        let (path, rows) = (self.root.join(name), BufWriter::new(file));
        let (newest, facts) = (SessionTime::ZERO, LongTableFacts::default());
        Ok(LongTableFile { path, heading, rows, newest, late: Vec::new(), facts })
    }
}

/// A long table of a data set that is being written row by row. Rows that come in the order of their times go to a
/// temporary file at once; a row that comes late is kept in memory until the end.
#[derive(Debug)]
pub struct LongTableFile {
    path: PathBuf,
    heading: String,
    /// A file without a name, which goes with this value.
    rows: BufWriter<File>,
    newest: SessionTime,
    late: Vec<(SessionTime, String)>,
    facts: LongTableFacts,
}

impl LongTableFile {
    pub fn add(&mut self, row: LongTableRow) -> FileResult<()> {
        if row.time < self.newest {
            self.late.push((row.time, row.line));
            return Ok(());
        }
        self.newest = row.time;
        self.put(row.time, &row.line).map_err(|reason| FileError::not_written(&self.path, reason, REMEDY))
    }

    fn put(&mut self, time: SessionTime, line: &str) -> io::Result<()> {
        self.rows.write_all(&time.0.to_le_bytes())?;
        self.rows.write_all(line.as_bytes())
    }

    /// Writes the table with all rows in the order of their times, if it has any. Returns what was counted of them.
    pub fn finish(mut self) -> FileResult<LongTableFacts> {
        let path = self.path.clone();
        self.write().map_err(|reason| FileError::not_written(&path, reason, REMEDY))?;
        Ok(self.facts)
    }

    fn write(&mut self) -> io::Result<()> {
        self.rows.flush()?;
        let file = self.rows.get_mut();
        file.seek(SeekFrom::Start(0))?;
        let mut rows = BufReader::new(&*file);
        // A row came late if its time was below that of a row before: so it comes after all rows of its own time.
        self.late.sort_by_key(|(time, _)| *time);
        let mut late = self.late.iter().peekable();
        let mut next = read_row(&mut rows)?;
        if next.is_none() && late.peek().is_none() {
            return Ok(());
        }
        fs::create_dir_all(self.path.parent().unwrap_or(Path::new(".")))?;
        let mut out = BufWriter::new(File::create(&self.path)?);
        let is_compressed = self.path.extension().is_some_and(|ending| ending == "gz");
        let mut packed = is_compressed.then(|| GzBuilder::new().write(Vec::new(), Compression::default()));
        let mut put = |text: &[u8]| match &mut packed {
            None => out.write_all(text),
            Some(packed) => {
                packed.write_all(text)?;
                out.write_all(packed.get_ref())?;
                packed.get_mut().clear();
                Ok(())
            }
        };
        put(self.heading.as_bytes())?;
        loop {
            let is_late = late.peek().is_some_and(|(time, _)| next.as_ref().is_none_or(|(other, _)| time < other));
            let (time, line) = match (is_late, late.next_if(|_| is_late), next.take()) {
                (true, Some((time, line)), kept) => {
                    next = kept;
                    (*time, line.as_bytes().to_vec())
                }
                (_, _, Some(row)) => {
                    next = read_row(&mut rows)?;
                    row
                }
                _ => break,
            };
            self.facts.add(time);
            put(&line)?;
        }
        if let Some(packed) = packed {
            out.write_all(&packed.finish()?)?;
        }
        out.flush()
    }
}

fn read_row(rows: &mut impl BufRead) -> io::Result<Option<(SessionTime, Vec<u8>)>> {
    let mut time = [0; 8];
    if rows.fill_buf()?.is_empty() {
        return Ok(None);
    }
    rows.read_exact(&mut time)?;
    let mut line = Vec::new();
    rows.read_until(b'\n', &mut line)?;
    Ok(Some((SessionTime(u64::from_le_bytes(time)), line)))
}

/// Codes of the participants in a BIDS data set that this program wrote; `None` for every other folder.
pub fn codes(root: &Path) -> Option<Vec<String>> {
    let description = read_regular(&root.join(DESCRIPTION_NAME)).ok()?;
    let description: serde_json::Value = serde_json::from_str(&description).ok()?;
    let is_ours = description["GeneratedBy"].as_array()?.iter().any(|by| by["Name"] == PROGRAM_NAME);
    let people = is_ours.then(|| read_regular(&root.join(format!("{PARTICIPANTS}.tsv"))).unwrap_or_default())?;
    let mut rows = people.lines().map(|line| line.split('\t'));
    let column = rows.next()?.position(|name| name == CODE_COLUMN)?;
    Some(rows.filter_map(|mut cells| cells.nth(column).map(str::to_string)).collect())
}

/// Compresses a text with gzip, without time and file name, so that the same text gives the same bytes.
fn compressed(text: &str) -> io::Result<Vec<u8>> {
    let mut out = GzBuilder::new().write(Vec::new(), Compression::default());
    out.write_all(text.as_bytes())?;
    out.finish()
}
