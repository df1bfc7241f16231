//! Rows of tables (CSV) that are about the participant. Tables are read as bytes: what is no UTF-8 stays as it is.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::ops::Range;
use std::path::Path;

use csv::{ByteRecord, Reader};

use super::subject::{ForgetSubject, NamedPerson};
use crate::base::words::count;
use crate::edge::log::rater_codes::EXPORT_COLUMNS;
use crate::edge::written_tables::{WrittenTables, reader, records};
use crate::study::column::Table;

/// Why a table is left that names a recording of which there are several.
const AMBIGUOUS: &str = "it names a recording, and recordings of several people in different folders have this name; \
                         tomcom forget --in the folder with one of them, or delete the rows by hand";
/// What to do with a table that this program does not change.
const REMEDY: &str = "make it anew with tomcom study or tomcom codes --export, or delete it";

/// What a table says of the participant.
#[derive(Debug)]
pub(super) enum TableMatch {
    /// Nothing, as far as it can be told.
    Nothing,
    /// A table that this program wrote: where the participant's rows are, in bytes, and how many other rows there are.
    Own { cut: Vec<Range<u64>>, kept: u64 },
    /// It names the participant and stays as it is, for this reason.
    Unclear(String),
}

/// What the tables of one folder say about each other.
#[derive(Debug)]
pub(super) struct FolderTables {
    written: WrittenTables,
    /// By the folder's table of trials: whose each recording is.
    recordings: BTreeMap<Vec<u8>, NamedPerson>,
}

/// Where a table names the participant, and where the recording.
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
    /// Reads the dictionary and the table of trials in a folder; what is not there says nothing.
    ///
    /// # Errors
    /// One of them is there, and cannot be read.
    pub fn read(folder: &Path, subject: &ForgetSubject) -> io::Result<FolderTables> {
        let mut tables = FolderTables { written: WrittenTables::read(folder)?, recordings: BTreeMap::new() };
        let trials = records(&folder.join("trials.csv"))?;
        if let Some((header, rows)) = trials.split_first()
            && tables.is_own(Table::Trials.name(), header)
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

    /// Looks for rows of the participant in a table, by the column that names the participant, else by the one that names
    /// the recording.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn look_at(&self, path: &Path, subject: &ForgetSubject) -> io::Result<TableMatch> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
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
        // A record begins where the one before ended, so that ranges of bytes are whole lines whatever ends these.
        let mut start = table.position().byte();
        while table.read_byte_record(&mut row)? {
            let end = table.position().byte();
            // No table has line breaks in a row: a quotation mark too much makes one row of several.
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

    /// Looks at a table that does not say that this program wrote it. It stays as it is; what is found is told.
    fn look_at_other(
        &self,
        mut table: Reader<File>,
        stem: &str,
        header: ByteRecord,
        subject: &ForgetSubject,
    ) -> io::Result<TableMatch> {
        let own = self.written.columns_of(stem);
        // Of a damaged header the number of columns still says which is which.
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
            (1.., _) if is_damaged => {
                TableMatch::Unclear(format!("its header is damaged, and {told} about the participant; {REMEDY}"))
            }
            (1.., _) => TableMatch::Unclear(format!(
                "{told} about the participant, in a table that tomcom did not write: its columns are others; delete them by hand"
            )),
            (0, true) => TableMatch::Unclear(format!(
                "it names the participant, and its columns are not those of the table of this name that tomcom writes; {REMEDY}"
            )),
        })
    }

    /// Whose a row is.
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

    /// Whether this program wrote a table with this header: for a study, or as an export of raters' codes.
    fn is_own(&self, stem: &str, header: &ByteRecord) -> bool {
        self.written.has(stem, header) || header.iter().eq(EXPORT_COLUMNS.map(str::as_bytes))
    }
}
