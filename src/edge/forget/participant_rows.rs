//! Rows of CSV tables that are about the participant. Tables are read as bytes, so that text that is not UTF-8 is kept
//! as it is.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::ops::Range;
use std::path::Path;

use csv::{ByteRecord, Reader};

use super::subject::{ForgetSubject, NamedPerson};
use crate::base::words::count;
use crate::edge::log::rater_codes::EXPORT_COLUMNS;
use crate::edge::replace_file::replaced_name;
use crate::edge::written_tables::{ListedTables, reader, records};
use crate::study::column::CsvTable;

/// Why a table is kept if it names a recording whose name several people's recordings share.
const AMBIGUOUS: &str = "it names a recording, and recordings of several people in different folders have this name; \
                         tomcom forget --in the folder with one of them, or delete the rows by hand";
/// Advice for a table that this program does not change.
const REMEDY: &str = "make the table again with tomcom study or tomcom codes --export, or delete it";

/// What a CSV table contains about the participant.
#[derive(Debug)]
pub(super) enum TableMatch {
    /// The table contains nothing about the participant, as far as can be determined.
    Nothing,
    /// This program wrote the table: byte ranges of the participant's rows, and number of other rows.
    Own { cut: Vec<Range<u64>>, kept: u64 },
    /// The table names the participant but is kept as it is, for this reason.
    Unclear(String),
}

/// What the tables of one folder tell about each other: the data dictionary, and the table of trials.
#[derive(Debug)]
pub(super) struct FolderTables {
    written: ListedTables,
    /// To which person each recording belongs, according to the folder's table of trials.
    recordings: BTreeMap<Vec<u8>, NamedPerson>,
}

/// Positions of the columns that name the participant and the recording in a table.
#[derive(Clone, Copy)]
struct KeyColumns {
    participant: Option<usize>,
    recording: Option<usize>,
}

impl KeyColumns {
    fn new<'a>(columns: impl Iterator<Item = &'a [u8]> + Clone) -> KeyColumns {
        let find = |name: &str| columns.clone().position(|column| column == name.as_bytes());
        KeyColumns { participant: find("participant"), recording: find("recording") }
    }
}

impl FolderTables {
    /// Reads the data dictionary and the table of trials of a folder, if they exist.
    ///
    /// # Errors
    /// One of the two files exists but cannot be read.
    pub fn read(folder: &Path, subject: &ForgetSubject) -> io::Result<FolderTables> {
        let mut tables = FolderTables { written: ListedTables::read(folder)?, recordings: BTreeMap::new() };
        let trials = records(&folder.join("trials.csv"))?;
        if let Some((header, rows)) = trials.split_first()
            && tables.is_own(CsvTable::Trials.name(), header)
        {
            let key = KeyColumns::new(header.iter());
            for row in rows.iter().filter(|row| row.len() == header.len()) {
                let cell = |column: Option<usize>| column.and_then(|column| row.get(column));
                if let (Some(recording), Some(participant)) = (cell(key.recording), cell(key.participant)) {
                    let whose = subject.participant(&String::from_utf8_lossy(participant));
                    let known = tables.recordings.entry(recording.to_vec()).or_insert(whose);
                    if *known != whose {
                        *known = NamedPerson::Ambiguous;
                    }
                }
            }
        }
        Ok(tables)
    }

    /// Whether the table of trials names the participant.
    pub fn name_participant(&self) -> bool {
        self.recordings.values().any(|&whose| whose != NamedPerson::Other)
    }

    /// Looks for rows of the participant in a table, by the column that names the participant, or else the recording.
    ///
    /// # Errors
    /// The table cannot be read.
    pub fn look_at(&self, path: &Path, subject: &ForgetSubject) -> io::Result<TableMatch> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let stem = Path::new(replaced_name(&name)).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut table = reader(File::open(path)?);
        let mut header = ByteRecord::new();
        if !table.read_byte_record(&mut header)? {
            return Ok(TableMatch::Nothing);
        }
        match self.is_own(&stem, &header) {
            true => self.look_at_own(table, &header, subject),
            false => self.look_at_other(table, &stem, header, subject),
        }
    }

    fn look_at_own(
        &self,
        mut table: Reader<File>,
        header: &ByteRecord,
        subject: &ForgetSubject,
    ) -> io::Result<TableMatch> {
        let key = KeyColumns::new(header.iter());
        let (mut cut, mut kept, mut row) = (Vec::new(), 0, ByteRecord::new());
        // Each record of the table begins where the previous one ended, so that byte ranges are whole lines with any
        // kind of line end.
        let mut start = table.position().byte();
        while table.read_byte_record(&mut row)? {
            let end = table.position().byte();
            // No cell of a table of this program contains line breaks; one quotation mark too many would make one
            // record of several rows.
            let is_damaged = row.len() != header.len() || row.iter().any(|cell| cell.contains(&b'\n'));
            if is_damaged && row.iter().any(|cell| subject.may_be_in(cell)) {
                let line = row.position().map_or(0, |position| position.line());
                return Ok(TableMatch::Unclear(format!(
                    "line {line} is damaged, and the participant may be in it ({} cells, instead of {}); {REMEDY}",
                    row.len(),
                    header.len()
                )));
            }
            match self.whose(&row, key, subject) {
                _ if is_damaged => kept += 1,
                NamedPerson::Subject => cut.push(start..end),
                NamedPerson::Other => kept += 1,
                NamedPerson::Ambiguous => return Ok(TableMatch::Unclear(AMBIGUOUS.to_string())),
            }
            start = end;
        }
        Ok(TableMatch::Own { cut, kept })
    }

    /// Looks at a table that this program may not have written. Such a table is kept as it is, and is listed if it
    /// names the participant.
    fn look_at_other(
        &self,
        mut table: Reader<File>,
        stem: &str,
        header: ByteRecord,
        subject: &ForgetSubject,
    ) -> io::Result<TableMatch> {
        let own = self.written.columns_of(stem);
        // If the table's header is damaged but has the right number of columns, the columns are still known.
        let is_damaged = own.as_ref().is_some_and(|own| own.len() == header.len());
        let key = match &own {
            Some(own) if is_damaged => KeyColumns::new(own.iter().map(Vec::as_slice)),
            _ => KeyColumns::new(header.iter()),
        };
        if own.is_none() && key.participant.is_none() && key.recording.is_none() {
            return Ok(TableMatch::Nothing);
        }
        let (mut rows, mut is_named, mut row) = (0, false, header);
        loop {
            rows += u64::from(self.whose(&row, key, subject) != NamedPerson::Other);
            is_named |= own.is_some() && row.iter().any(|cell| subject.is_named_in(cell));
            if !table.read_byte_record(&mut row)? {
                break;
            }
        }
        let told = count(rows, "row is", "rows are");
        Ok(match (rows, is_named) {
            (0, false) => TableMatch::Nothing,
            (1.., _) if is_damaged => TableMatch::Unclear(format!(
                "the table's header is damaged, and {told} about the participant; \
                                             {REMEDY}"
            )),
            (1.., _) => TableMatch::Unclear(format!(
                "{told} about the participant, in a table that tomcom did not write, with other columns; delete these \
                 rows by hand"
            )),
            (0, true) => TableMatch::Unclear(format!(
                "the table names the participant, and does not have the columns of the table of this name that tomcom \
                 writes; {REMEDY}"
            )),
        })
    }

    /// Which person a row of a table is about.
    fn whose(&self, row: &ByteRecord, key: KeyColumns, subject: &ForgetSubject) -> NamedPerson {
        let cell = |column: Option<usize>| column.and_then(|column| row.get(column));
        let participant = cell(key.participant).map(|cell| subject.participant(&String::from_utf8_lossy(cell)));
        match (participant, cell(key.recording)) {
            (Some(whose @ (NamedPerson::Subject | NamedPerson::Other)), _) | (Some(whose), None) => whose,
            (_, Some(recording)) => match self.recordings.get(recording) {
                Some(&whose) if participant.is_none() && whose != NamedPerson::Ambiguous => whose,
                _ => subject.recording(&String::from_utf8_lossy(recording)),
            },
            (None, None) => NamedPerson::Other,
        }
    }

    /// Whether this program wrote a table with this header: as a study's table, or as an export of raters' codes.
    fn is_own(&self, stem: &str, header: &ByteRecord) -> bool {
        self.written.has(stem, header) || header.iter().eq(EXPORT_COLUMNS.map(str::as_bytes))
    }
}
