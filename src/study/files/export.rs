//! Output files of an analysis: tables as CSV (RFC 4180, UTF-8), and the report. Analysed recordings and their rows of
//! events are kept in temporary files until all recordings are read, so that memory use does not grow with the number of
//! recordings and tables have the order of the recordings.

use std::borrow::{Borrow, Cow};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, ReaderBuilder};

use crate::column::{CsvRow, CsvTable, TableCell, TableColumn, described};
use crate::files::new_folder::NewFolder;
use crate::report;
use crate::study_part::AnalysedRecording;
use tomcom_core::base::text::without_formula;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::files::overwrite;
use tomcom_session::files::replace_file::{self, Replacement};

const REPORT_NAME: &str = "report.html";
const PARTS_NAME: &str = ".rows";
const ANALYSED: &str = "analysed";

#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{}: cannot be written: {reason}", path.display())]
#[diagnostic(help("another folder with --out, on a disk with free space"))]
pub struct AnalysisWriteError {
    pub path: PathBuf,
    pub reason: io::Error,
}

fn at<T>(path: &Path, done: io::Result<T>) -> Result<T, AnalysisWriteError> {
    done.map_err(|reason| AnalysisWriteError { path: path.to_path_buf(), reason })
}

/// Rows of one CSV table, without the header line, which are written to memory or to a file.
#[derive(Debug)]
pub struct TableRows<Out: Write = Vec<u8>> {
    rows: csv::Writer<Out>,
}

impl Default for TableRows {
    fn default() -> TableRows {
        TableRows::new(Vec::new())
    }
}

impl<Out: Write> TableRows<Out> {
    fn new(out: Out) -> TableRows<Out> {
        TableRows { rows: csv::WriterBuilder::new().has_headers(false).from_writer(out) }
    }

    /// Writes a row of the CSV table. Its texts can be what somebody typed, and people open tables with spreadsheets.
    fn write(&mut self, mut cells: Vec<TableCell>) -> io::Result<()> {
        for cell in &mut cells {
            if let TableCell::Text(text) = cell
                && let Cow::Owned(guarded) = without_formula(text)
            {
                *text = Cow::Owned(guarded);
            }
        }
        self.rows.serialize(cells).map_err(io::Error::from)
    }
}

impl TableRows {
    pub fn add(&mut self, row: &impl CsvRow) {
        self.write(row.cells()).expect("rows are flat, and written to memory");
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.rows.into_inner().expect("rows are written to memory")
    }
}

/// A CSV table of the analysis that is being written row by row. The table's file gets its name when it is complete.
#[derive(Debug)]
pub struct TableFile {
    table: CsvTable,
    path: PathBuf,
    rows: TableRows<Replacement>,
    has_rows: bool,
}

impl TableFile {
    pub fn add<Row: CsvRow>(&mut self, row: &Row) -> Result<(), AnalysisWriteError> {
        debug_assert_eq!(Row::TABLE, self.table, "a row of another table");
        self.has_rows = true;
        at(&self.path, self.rows.write(row.cells()))
    }

    /// Completes the table and gives its file its name. Returns the table if it has rows.
    pub fn finish(self) -> Result<Option<CsvTable>, AnalysisWriteError> {
        let TableFile { table, path, rows, has_rows } = self;
        let written = rows.rows.into_inner().map_err(csv::IntoInnerError::into_error).and_then(Replacement::finish);
        at(&path, written)?;
        Ok(has_rows.then_some(table))
    }
}

/// What is kept in it until all recordings are read goes with this value.
#[derive(Debug)]
pub struct AnalysisFolder {
    folder: PathBuf,
    _new: NewFolder,
}

impl Drop for AnalysisFolder {
    fn drop(&mut self) {
        // The next analysis removes what could not be removed.
        let _ = remove_parts(&self.parts());
    }
}

impl AnalysisFolder {
    /// Creates the output folder of an analysis if the folder does not exist. Errors: the folder cannot be created or
    /// written to, or it contains files that have the names of tables or report but that this program did not write.
    pub fn create(folder: &Path) -> Result<AnalysisFolder, AnalysisWriteError> {
        check_replaced(folder)?;
        let export = AnalysisFolder { folder: folder.to_path_buf(), _new: at(folder, NewFolder::create(folder))? };
        let parts = export.parts();
        // Temporary files that an interrupted analysis left are removed.
        at(&parts, remove_parts(&parts).and_then(|()| fs::create_dir(&parts)))?;
        Ok(export)
    }

    fn parts(&self) -> PathBuf {
        self.folder.join(PARTS_NAME)
    }

    fn part(&self, index: usize, what: &str) -> PathBuf {
        self.parts().join(format!("{index}-{what}"))
    }

    /// Stores the event rows of one recording in temporary files, in the order of [`CsvTable::OF_EVENTS`].
    pub fn keep(&self, index: usize, rows: &[Vec<u8>; 5]) -> Result<(), AnalysisWriteError> {
        for (table, rows) in CsvTable::OF_EVENTS.into_iter().zip(rows) {
            let path = self.part(index, table.name());
            at(&path, fs::write(&path, rows))?;
        }
        Ok(())
    }

    pub fn keep_analysed(&self, index: usize, recording: &AnalysedRecording) -> Result<(), AnalysisWriteError> {
        let path = self.part(index, ANALYSED);
        let written = serde_json::to_vec(recording).map_err(io::Error::from).and_then(|text| fs::write(&path, text));
        at(&path, written)
    }

    pub fn kept_analysed(&self, index: usize) -> Result<AnalysedRecording, AnalysisWriteError> {
        let path = self.part(index, ANALYSED);
        let read = fs::read(&path).and_then(|text| serde_json::from_slice(&text).map_err(io::Error::from));
        at(&path, read)
    }

    pub fn begin(&self, table: CsvTable) -> Result<TableFile, AnalysisWriteError> {
        self.begin_with(table, &names(table))
    }

    fn begin_with(&self, table: CsvTable, names: &[impl AsRef<str>]) -> Result<TableFile, AnalysisWriteError> {
        let path = self.folder.join(format!("{}.csv", table.name()));
        let rows = TableRows::new(at(&path, begin_table(&path, names))?);
        Ok(TableFile { table, path, rows, has_rows: false })
    }

    /// Writes a table of the analysis; returns the table if it has rows.
    pub fn table<Row: CsvRow>(
        &self,
        rows: impl IntoIterator<Item: Borrow<Row>>,
    ) -> Result<Option<CsvTable>, AnalysisWriteError> {
        let mut table = self.begin(Row::TABLE)?;
        rows.into_iter().try_for_each(|row| table.add(row.borrow()))?;
        table.finish()
    }

    /// Writes a table whose columns follow from the study; returns the table if it has rows.
    pub fn table_of_columns<Row: CsvRow>(
        &self,
        columns: &[TableColumn<Row>],
        rows: impl Iterator<Item = Row>,
    ) -> Result<Option<CsvTable>, AnalysisWriteError> {
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_ref()).collect();
        let mut table = self.begin_with(Row::TABLE, &names)?;
        for row in rows {
            table.has_rows = true;
            at(&table.path, table.rows.write(columns.iter().map(|column| column.cell(&row)).collect()))?;
        }
        table.finish()
    }

    /// From the stored rows of these recordings, in this order. Returns the tables that have rows.
    pub fn tables_of_events(&self, recordings: &[usize]) -> Result<Vec<CsvTable>, AnalysisWriteError> {
        let mut filled = Vec::new();
        for table in CsvTable::OF_EVENTS {
            let path = self.folder.join(format!("{}.csv", table.name()));
            let write = || {
                let mut out = begin_table(&path, &names(table))?;
                let mut bytes = 0;
                for &index in recordings {
                    bytes += io::copy(&mut File::open(self.part(index, table.name()))?, &mut out)?;
                }
                out.finish().map(|()| (bytes > 0).then_some(table))
            };
            filled.extend(at(&path, write())?);
        }
        Ok(filled)
    }

    pub fn report(&self, page: &str) -> Result<PathBuf, AnalysisWriteError> {
        let path = self.folder.join(REPORT_NAME);
        at(&path, replace_file::replace(&path, page.as_bytes()))?;
        Ok(path)
    }
}

/// Errors: there is a file at the path that is no table with this header line; `what`: in words, what is to be there.
pub(super) fn check_csv(path: &Path, what: &str, header: &str) -> FileResult<()> {
    overwrite::check(path, what, |head| overwrite::first_line(head) == header.as_bytes())
        .map_err(|reason| FileError::unwritable(path, reason))
}

/// Writes a table of its own, whose first row is the header. Errors: the file cannot be written.
pub(super) fn write_csv(path: &Path, rows: impl IntoIterator<Item: IntoIterator<Item: AsRef<[u8]>>>) -> FileResult<()> {
    let write = || -> io::Result<()> {
        let mut table = csv::Writer::from_writer(Vec::new());
        rows.into_iter().try_for_each(|row| table.write_record(row))?;
        let bytes = table.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
        overwrite::write(path, &bytes)
    };
    write().map_err(|reason| FileError::unwritable(path, reason))
}

fn check_replaced(folder: &Path) -> Result<(), AnalysisWriteError> {
    let written = at(folder, ListedTables::read(folder))?;
    for &table in CsvTable::ALL {
        let path = folder.join(format!("{}.csv", table.name()));
        let is_own = |head: &[u8]| {
            let mut header = csv::ByteRecord::new();
            reader(head).read_byte_record(&mut header).unwrap_or(false) && written.has(table.name(), &header)
        };
        let what = format!("the table \"{}\"", table.name());
        at(&path, overwrite::check(&path, &what, is_own))?;
    }
    let path = folder.join(REPORT_NAME);
    let is_own = |head: &[u8]| report::participants_of_page(&String::from_utf8_lossy(head)).is_some();
    at(&path, overwrite::check(&path, "a report", is_own))
}

fn names(table: CsvTable) -> Vec<Cow<'static, str>> {
    described(table).into_iter().map(|column| column.column).collect()
}

fn begin_table(path: &Path, names: &[impl AsRef<str>]) -> io::Result<Replacement> {
    let mut out = Replacement::begin(path)?;
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    writeln!(out, "{}", names.join(","))?;
    Ok(out)
}

/// Files that this program did not write stay, and then the folder stays, too.
fn remove_parts(folder: &Path) -> io::Result<()> {
    if fs::symlink_metadata(folder).is_ok_and(|data| !data.is_dir()) {
        return Err(io::Error::new(io::ErrorKind::NotADirectory, "it is no folder, but a link or a file"));
    }
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(reason) if reason.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(reason) => return Err(reason),
    };
    for entry in entries {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_part = name.split_once('-').is_some_and(|(index, table)| {
            let is_kept = table == ANALYSED || CsvTable::OF_EVENTS.iter().any(|part| part.name() == table);
            index.parse::<usize>().is_ok() && is_kept
        });
        if is_part {
            fs::remove_file(entry.path())?;
        }
    }
    fs::remove_dir(folder)
}

/// The tables in a folder that this program wrote, by the data dictionary beside them.
#[derive(Debug, Default)]
pub struct ListedTables {
    columns: BTreeMap<Vec<u8>, Vec<Vec<u8>>>,
}

impl ListedTables {
    /// Errors: the data dictionary exists but cannot be read.
    pub fn read(folder: &Path) -> io::Result<ListedTables> {
        let mut tables = ListedTables::default();
        let dictionary = records(&folder.join("dictionary.csv"))?;
        if let Some((header, rows)) = dictionary.split_first()
            && has_columns_of(header, CsvTable::Dictionary)
        {
            for row in rows {
                if let (Some(table), Some(column)) = (row.get(0), row.get(1)) {
                    tables.columns.entry(table.to_vec()).or_default().push(column.to_vec());
                }
            }
        }
        Ok(tables)
    }

    pub fn is_listed(&self) -> bool {
        !self.columns.is_empty()
    }

    pub fn has(&self, name: &str, header: &ByteRecord) -> bool {
        let listed = self.columns.get(name.as_bytes());
        listed.is_some_and(|columns| header.iter().eq(columns.iter().map(Vec::as_slice)))
            || table_named(name).is_some_and(|table| has_columns_of(header, table))
    }
}

pub fn table_named(name: &str) -> Option<CsvTable> {
    CsvTable::ALL.iter().copied().find(|table| table.name() == name)
}

fn has_columns_of(header: &ByteRecord, table: CsvTable) -> bool {
    header.iter().eq(described(table).iter().map(|row| row.column.as_bytes()))
}

/// A CSV reader of all records including the header, which accepts any number of cells and any bytes.
pub fn reader<R: io::Read>(table: R) -> csv::Reader<R> {
    ReaderBuilder::new().has_headers(false).flexible(true).from_reader(table)
}

/// All records of a CSV table; empty if the file does not exist. Errors: the file exists but cannot be read.
pub fn records(path: &Path) -> io::Result<Vec<ByteRecord>> {
    match path.symlink_metadata() {
        Ok(data) if data.is_file() => Ok(reader(File::open(path)?).into_byte_records().collect::<csv::Result<_>>()?),
        Ok(_) => Ok(Vec::new()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}
