//! Recognition of tables that this program wrote: by the columns that this version's tables have, or by the data
//! dictionary beside the table.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::Path;

use csv::{ByteRecord, ReaderBuilder};

use crate::column::CsvTable;
use crate::dictionary::columns;

/// Tables that the data dictionary in a folder lists, with their columns.
#[derive(Debug, Default)]
pub struct ListedTables {
    columns: BTreeMap<Vec<u8>, Vec<Vec<u8>>>,
}

impl ListedTables {
    /// Reads the data dictionary in a folder, if the folder has one.
    ///
    /// # Errors
    /// The data dictionary exists but cannot be read.
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

    /// Whether the folder has a data dictionary that this program wrote.
    pub fn is_listed(&self) -> bool {
        !self.columns.is_empty()
    }

    /// Whether this program wrote the table with this name and header.
    pub fn has(&self, name: &str, header: &ByteRecord) -> bool {
        let listed = self.columns.get(name.as_bytes());
        listed.is_some_and(|columns| header.iter().eq(columns.iter().map(Vec::as_slice)))
            || table_named(name).is_some_and(|table| has_columns_of(header, table))
    }
}

/// The table of a study that has this name.
pub fn table_named(name: &str) -> Option<CsvTable> {
    CsvTable::ALL.into_iter().find(|table| table.name() == name)
}

fn has_columns_of(header: &ByteRecord, table: CsvTable) -> bool {
    header.iter().eq(columns(table).iter().map(|row| row.column.as_bytes()))
}

/// A CSV reader of all records including the header, which accepts any number of cells and any bytes.
pub fn reader<R: io::Read>(table: R) -> csv::Reader<R> {
    ReaderBuilder::new().has_headers(false).flexible(true).from_reader(table)
}

/// All records of a CSV table; empty if the file does not exist.
///
/// # Errors
/// The file exists but cannot be read.
pub fn records(path: &Path) -> io::Result<Vec<ByteRecord>> {
    match path.symlink_metadata() {
        Ok(data) if data.is_file() => Ok(reader(File::open(path)?).into_byte_records().collect::<csv::Result<_>>()?),
        Ok(_) => Ok(Vec::new()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}
