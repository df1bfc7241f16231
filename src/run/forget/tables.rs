//! Rows of CSV tables that are about the participant. Tables are read as bytes, so that text that is not UTF-8 is kept
//! as it is.

use std::fs::File;
use std::io;
use std::ops::Range;
use std::path::Path;

use csv::ByteRecord;
use rustc_hash::FxHashMap;

use super::subject::{AMBIGUOUS, ForgetSubject, NamedPerson, file_name};
use tomcom_session::files::replace_file::replaced_name;
use tomcom_session::log::rater_codes::EXPORT_COLUMNS;
use tomcom_study::column::CsvTable;
use tomcom_study::files::export::{ListedTables, reader, records, table_named};

/// Advice for a damaged table.
const REMEDY: &str = "make the table again with tomcom study or tomcom codes --export, or delete it";

/// What a CSV table contains about the participant.
pub(super) enum TableMatch {
    /// This program did not write the table.
    Foreign,
    /// This program wrote the table: byte ranges of the participant's rows, and whether there are other rows.
    Own {
        cut: Vec<Range<u64>>,
        has_others: bool,
    },
    Unclear(String),
}

/// What the tables of one folder tell about each other: the data dictionary, and the table of trials.
pub(super) struct FolderTables {
    written: ListedTables,
    /// To which person each recording belongs: according to the folder's table of trials, or else by its name.
    recordings: FxHashMap<Vec<u8>, NamedPerson>,
}

impl FolderTables {
    /// Reads the data dictionary and the table of trials of a folder, if they exist.
    ///
    /// # Errors
    /// One of the two files exists but cannot be read.
    pub(super) fn read(folder: &Path, subject: &ForgetSubject) -> io::Result<FolderTables> {
        let mut tables = FolderTables { written: ListedTables::read(folder)?, recordings: FxHashMap::default() };
        let trials = records(&folder.join("trials.csv"))?;
        if let Some((header, rows)) = trials.split_first()
            && tables.written.has(CsvTable::Trials.name(), header)
            && let (Some(recording), Some(participant)) = (column(header, "recording"), column(header, "participant"))
        {
            for row in rows.iter().filter(|row| row.len() == header.len()) {
                let [name, of] = [participant, recording].map(|column| String::from_utf8_lossy(&row[column]));
                let is_subject = subject.is_in_row(&name, Some(&of));
                let whose = if is_subject { NamedPerson::Subject } else { NamedPerson::Other };
                tables.recordings.insert(row[recording].to_vec(), whose);
            }
        }
        Ok(tables)
    }

    /// Looks for rows of the participant in a table, by the column that names the participant, or else the recording.
    ///
    /// # Errors
    /// The table cannot be read.
    pub(super) fn look_at(&mut self, path: &Path, subject: &ForgetSubject) -> io::Result<TableMatch> {
        let name = file_name(path);
        let stem = Path::new(replaced_name(&name)).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut table = reader(File::open(path)?);
        let mut header = ByteRecord::new();
        table.read_byte_record(&mut header)?;
        if !self.written.has(&stem, &header) && !header.iter().eq(EXPORT_COLUMNS.map(str::as_bytes)) {
            // In the folder of an analysis a table of this name is one of its tables, with a damaged header.
            let is_damaged = self.written.is_listed() && table_named(&stem).is_some();
            return Ok(match is_damaged {
                true => {
                    TableMatch::Unclear(format!("its header is damaged, so it may be about the participant; {REMEDY}"))
                }
                false => TableMatch::Foreign,
            });
        }
        let (participant, recording) = (column(&header, "participant"), column(&header, "recording"));
        let (mut cut, mut has_others, mut row) = (Vec::new(), false, ByteRecord::new());
        // Each record of the table begins where the previous one ended, so that byte ranges are whole lines with any
        // kind of line end.
        let mut start = table.position().byte();
        while table.read_byte_record(&mut row)? {
            let end = table.position().byte();
            // No cell of a table of this program contains line breaks; one quotation mark too many would make one
            // record of several rows.
            if row.len() != header.len() || row.iter().any(|cell| cell.contains(&b'\n')) {
                let line = row.position().map_or(0, |position| position.line());
                return Ok(TableMatch::Unclear(format!(
                    "line {line} is damaged, and may be about the participant ({} cells, instead of {}); {REMEDY}",
                    row.len(),
                    header.len()
                )));
            }
            let whose = match (participant, recording) {
                (Some(column), of) => {
                    let name = String::from_utf8_lossy(&row[column]);
                    let recording = of.map(|column| String::from_utf8_lossy(&row[column]));
                    match subject.is_in_row(&name, recording.as_deref()) {
                        true => NamedPerson::Subject,
                        false => NamedPerson::Other,
                    }
                }
                (None, Some(column)) => self.whose(&row[column], subject),
                (None, None) => NamedPerson::Other,
            };
            match whose {
                NamedPerson::Subject => cut.push(start..end),
                NamedPerson::Other => has_others = true,
                NamedPerson::Ambiguous => return Ok(TableMatch::Unclear(AMBIGUOUS.to_string())),
            }
            start = end;
        }
        Ok(TableMatch::Own { cut, has_others })
    }

    fn whose(&mut self, recording: &[u8], subject: &ForgetSubject) -> NamedPerson {
        if let Some(&whose) = self.recordings.get(recording) {
            return whose;
        }
        let whose = subject.recording(&String::from_utf8_lossy(recording));
        self.recordings.insert(recording.to_vec(), whose);
        whose
    }
}

fn column(header: &ByteRecord, name: &str) -> Option<usize> {
    header.iter().position(|column| column == name.as_bytes())
}
