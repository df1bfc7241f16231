//! Recordings as the tables of the Brain Imaging Data Structure (BIDS): a recording becomes a session with behaviour,
//! gaze becomes an eye-tracking recording, and questionnaires become phenotype tables. Tables are tab-separated, each with
//! a JSON sidecar file that describes its columns.
//!
//! Column names and required fields are those of BIDS 1.10 and later (behavioral experiments, physiological recordings,
//! phenotypic data). This module makes the content of the files; its caller writes the files.

pub mod dataset;
pub mod events;
pub(crate) mod recording_tables;

use std::borrow::Cow;

use serde_json::{Map, Value, json};

use crate::column::{ColumnValues, Levels, TableCell, TableColumn};
use tomcom_core::base::text::without_formula;
use tomcom_core::base::time::SessionTime;

const NOTHING: &str = "n/a";
const YES_NO: Levels = &[("0", "No"), ("1", "Yes")];

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BidsFile {
    /// Path of the file below the data set's root, or the end of a recording's file name, as in `events.tsv`. Files
    /// whose name ends with `.gz` are to be compressed by the caller.
    pub name: String,
    pub text: String,
}

impl BidsFile {
    fn new(name: impl Into<String>, text: impl Into<String>) -> BidsFile {
        BidsFile { name: name.into(), text: text.into() }
    }

    fn json(name: impl Into<String>, value: &Value) -> BidsFile {
        // Writing JSON cannot fail here, because it contains only strings and finite numbers.
        BidsFile::new(name, format!("{value:#}\n"))
    }

    /// A table with its first line, and its sidecar file.
    fn table<Row>(path: &str, columns: &[TableColumn<Row>], rows: &str, about: Map<String, Value>) -> [BidsFile; 2] {
        [
            BidsFile::new(format!("{path}.tsv"), heading(columns) + rows),
            BidsFile::json(format!("{path}.json"), &about.into()),
        ]
    }
}

fn described<Row>(columns: &[TableColumn<Row>]) -> Map<String, Value> {
    let one = |column: &TableColumn<Row>| {
        let mut about = json!({ "Description": column.meaning });
        let ColumnValues { unit, levels } = column.values;
        if !unit.is_empty() {
            about["Units"] = json!(unit);
        }
        if !levels.is_empty() {
            about["Levels"] = levels.iter().map(|(value, meaning)| (value.to_string(), json!(meaning))).collect();
        }
        (column.name.to_string(), about)
    };
    columns.iter().map(one).collect()
}

fn names<Row>(columns: &[TableColumn<Row>]) -> Vec<&str> {
    columns.iter().map(|column| column.name.as_ref()).collect()
}

fn heading<Row>(columns: &[TableColumn<Row>]) -> String {
    line(names(columns))
}

fn row<Row>(columns: &[TableColumn<Row>], row: &Row) -> String {
    line(columns.iter().map(|column| match column.cell(row) {
        TableCell::Unknown => NOTHING.into(),
        TableCell::Flag(is) => u8::from(is).to_string().into(),
        TableCell::Count(number) => number.to_string().into(),
        TableCell::Whole(number) => number.to_string().into(),
        TableCell::Number(number) => number.to_string().into(),
        TableCell::Text(text) => text,
    }))
}

/// A line of a tab-separated table, including the line end. In its cells tabs and line ends become spaces, text that a
/// spreadsheet would compute gets a `'` in front, and text that contains quotation marks is quoted.
pub fn line<'a>(cells: impl IntoIterator<Item = impl Into<Cow<'a, str>>>) -> String {
    let cell = |text: Cow<str>| {
        let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        match &*without_formula(plain.trim()) {
            "" => NOTHING.to_string(),
            trimmed if trimmed.contains('"') => format!("\"{}\"", trimmed.replace('"', "\"\"")),
            trimmed => trimmed.to_string(),
        }
    };
    let cells: Vec<String> = cells.into_iter().map(|one| cell(one.into())).collect();
    cells.join("\t") + "\n"
}

/// Session time in seconds with nine decimals (nanoseconds).
fn seconds(time: SessionTime) -> String {
    format!("{}.{:09}", time.0 / 1_000_000_000, time.0 % 1_000_000_000)
}
