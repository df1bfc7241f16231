//! Output files of an analysis: tables as CSV (RFC 4180, UTF-8), and the report. Analysed recordings and their rows of
//! events are kept in temporary files until all recordings are read, so that memory use does not grow with the number of
//! recordings and tables have the order of the recordings.

use std::borrow::{Borrow, Cow};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::written_tables::{ListedTables, reader};
use crate::column::{CsvCell, CsvRow, CsvTable};
use crate::dictionary::columns;
use crate::report::page_head;
use crate::study_part::AnalysedRecording;
use tomcom_core::base::text::without_formula;
use tomcom_session::files::overwrite;
use tomcom_session::files::replace_file::{self, Replacement};

/// File name of the analysis report.
pub const REPORT_NAME: &str = "report.html";
/// Name of the folder for temporary files of an analysis.
const PARTS_NAME: &str = ".rows";
/// End of the name of a temporary file with an analysed recording.
const ANALYSED: &str = "analysed";

/// An output file of an analysis that cannot be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{}: cannot be written: {reason}", path.display())]
#[diagnostic(help("another folder with --out, on a disk with free space"))]
pub struct AnalysisWriteError {
    /// File or folder that cannot be written.
    pub path: PathBuf,
    /// Why the output file cannot be written.
    pub reason: io::Error,
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
    fn write(&mut self, row: &impl CsvRow) -> io::Result<()> {
        let mut cells = row.cells();
        for cell in &mut cells {
            if let CsvCell::Text(text) = cell
                && let Cow::Owned(guarded) = without_formula(text)
            {
                *text = Cow::Owned(guarded);
            }
        }
        self.rows.serialize(cells).map_err(io::Error::from)
    }
}

impl TableRows {
    /// Adds a row to the CSV table.
    pub fn add(&mut self, row: &impl CsvRow) {
        self.write(row).expect("rows are flat, and written to memory");
    }

    /// The table's rows as CSV in UTF-8, without a header line.
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
    /// Writes a row of the table.
    ///
    /// # Errors
    /// The disk is full.
    pub fn add<Row: CsvRow>(&mut self, row: &Row) -> Result<(), AnalysisWriteError> {
        debug_assert_eq!(Row::TABLE, self.table, "a row of another table");
        self.has_rows = true;
        self.rows.write(row).map_err(|reason| AnalysisWriteError { path: self.path.clone(), reason })
    }

    /// Completes the table and gives its file its name. Returns the table if it has rows.
    ///
    /// # Errors
    /// The folder cannot be written to, or the disk is full.
    pub fn finish(self) -> Result<Option<CsvTable>, AnalysisWriteError> {
        let TableFile { table, path, rows, has_rows } = self;
        let written = rows.rows.into_inner().map_err(csv::IntoInnerError::into_error).and_then(Replacement::finish);
        written.map_err(|reason| AnalysisWriteError { path, reason })?;
        Ok(has_rows.then_some(table))
    }
}

/// Output folder of an analysis, with tables and report.
#[derive(Debug)]
pub struct AnalysisFolder {
    folder: PathBuf,
}

impl AnalysisFolder {
    /// Creates the output folder of an analysis if the folder does not exist.
    ///
    /// # Errors
    /// The folder cannot be created or written to, or it contains files that have the names of tables or report but
    /// that this program did not write.
    pub fn create(folder: &Path) -> Result<AnalysisFolder, AnalysisWriteError> {
        let export = AnalysisFolder { folder: folder.to_path_buf() };
        export.check_replaced()?;
        let parts = export.parts();
        // Temporary files that an interrupted analysis left are removed.
        remove_parts(&parts).map_err(|reason| AnalysisWriteError { path: parts.clone(), reason })?;
        fs::create_dir_all(&parts).map_err(|reason| AnalysisWriteError { path: parts, reason })?;
        Ok(export)
    }

    /// Checks that all files that would be replaced come from an earlier analysis.
    fn check_replaced(&self) -> Result<(), AnalysisWriteError> {
        let written = ListedTables::read(&self.folder)
            .map_err(|reason| AnalysisWriteError { path: self.folder.clone(), reason })?;
        for table in CsvTable::ALL {
            let path = self.folder.join(format!("{}.csv", table.name()));
            let is_own = |head: &[u8]| {
                let mut header = csv::ByteRecord::new();
                reader(head).read_byte_record(&mut header).unwrap_or(false) && written.has(table.name(), &header)
            };
            let what = format!("the table \"{}\"", table.name());
            overwrite::check(&path, &what, is_own).map_err(|reason| AnalysisWriteError { path, reason })?;
        }
        let path = self.folder.join(REPORT_NAME);
        let is_own = |head: &[u8]| page_head::participants(&String::from_utf8_lossy(head)).is_some();
        overwrite::check(&path, "a report", is_own).map_err(|reason| AnalysisWriteError { path, reason })
    }

    fn parts(&self) -> PathBuf {
        self.folder.join(PARTS_NAME)
    }

    /// Path of a temporary file: an analysed recording, or its event rows for a table.
    fn part(&self, index: usize, what: &str) -> PathBuf {
        self.parts().join(format!("{index}-{what}"))
    }

    /// Stores the event rows of one recording in temporary files, in the order of [`CsvTable::OF_EVENTS`].
    ///
    /// # Errors
    /// The files cannot be written.
    pub fn keep(&self, index: usize, rows: &[Vec<u8>; 5]) -> Result<(), AnalysisWriteError> {
        for (table, rows) in CsvTable::OF_EVENTS.into_iter().zip(rows) {
            let path = self.part(index, table.name());
            fs::write(&path, rows).map_err(|reason| AnalysisWriteError { path, reason })?;
        }
        Ok(())
    }

    /// Stores an analysed recording in a temporary file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep_analysed(&self, index: usize, recording: &AnalysedRecording) -> Result<(), AnalysisWriteError> {
        let path = self.part(index, ANALYSED);
        let written = serde_json::to_vec(recording).map_err(io::Error::from).and_then(|text| fs::write(&path, text));
        written.map_err(|reason| AnalysisWriteError { path, reason })
    }

    /// The stored analysed recording with this number.
    ///
    /// # Errors
    /// The temporary file cannot be read.
    pub fn kept_analysed(&self, index: usize) -> Result<AnalysedRecording, AnalysisWriteError> {
        let path = self.part(index, ANALYSED);
        let read = fs::read(&path).and_then(|text| serde_json::from_slice(&text).map_err(io::Error::from));
        read.map_err(|reason| AnalysisWriteError { path, reason })
    }

    /// Removes the temporary files of the analysis.
    ///
    /// # Errors
    /// The folder for temporary files cannot be changed.
    pub fn remove_kept(&self) -> Result<(), AnalysisWriteError> {
        let path = self.parts();
        remove_parts(&path).map_err(|reason| AnalysisWriteError { path, reason })
    }

    /// Begins a table of the analysis with its header line.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn begin(&self, table: CsvTable) -> Result<TableFile, AnalysisWriteError> {
        let path = self.folder.join(format!("{}.csv", table.name()));
        match begin_table(&path, table).map(TableRows::new) {
            Ok(rows) => Ok(TableFile { table, path, rows, has_rows: false }),
            Err(reason) => Err(AnalysisWriteError { path, reason }),
        }
    }

    /// Writes a table of the analysis; returns the table if it has rows.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn table<Row: CsvRow>(
        &self,
        rows: impl IntoIterator<Item: Borrow<Row>>,
    ) -> Result<Option<CsvTable>, AnalysisWriteError> {
        let mut table = self.begin(Row::TABLE)?;
        rows.into_iter().try_for_each(|row| table.add(row.borrow()))?;
        table.finish()
    }

    /// Writes the tables of events from the stored rows of these recordings, in this order. Returns the tables that
    /// have rows.
    ///
    /// # Errors
    /// The files cannot be written.
    pub fn tables_of_events(&self, recordings: &[usize]) -> Result<Vec<CsvTable>, AnalysisWriteError> {
        let mut filled = Vec::new();
        for table in CsvTable::OF_EVENTS {
            let path = self.folder.join(format!("{}.csv", table.name()));
            let write = || {
                let mut out = begin_table(&path, table)?;
                let mut bytes = 0;
                for &index in recordings {
                    bytes += io::copy(&mut File::open(self.part(index, table.name()))?, &mut out)?;
                }
                out.finish().map(|()| (bytes > 0).then_some(table))
            };
            filled.extend(write().map_err(|reason| AnalysisWriteError { path: path.clone(), reason })?);
        }
        Ok(filled)
    }

    /// Writes the analysis report and returns its path.
    ///
    /// # Errors
    /// The report cannot be written.
    pub fn report(&self, page: &str) -> Result<PathBuf, AnalysisWriteError> {
        let path = self.folder.join(REPORT_NAME);
        match replace_file::replace(&path, page.as_bytes()) {
            Ok(()) => Ok(path),
            Err(reason) => Err(AnalysisWriteError { path, reason }),
        }
    }
}

/// Begins the file of a table with the header line.
fn begin_table(path: &Path, table: CsvTable) -> io::Result<Replacement> {
    let mut out = Replacement::begin(path)?;
    let names: Vec<Cow<str>> = columns(table).into_iter().map(|column| column.column).collect();
    writeln!(out, "{}", names.join(","))?;
    Ok(out)
}

/// Removes the folder of temporary files that an analysis has left. Files that this program did not write stay, and
/// then the folder stays, too.
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
