//! Tab-separated tables, and the JSON sidecar files that describe their columns, as BIDS wants them.

use std::borrow::Cow;

use serde_json::{Map, Value, json};

use tomcom_core::base::text::without_formula;
use tomcom_core::base::time::SessionTime;

pub(super) const NOTHING: &str = "n/a";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BidsFile {
    /// Path of the file below the data set's root, or the end of a recording's file name, as in `events.tsv`. Files
    /// whose name ends with `.gz` are to be compressed by the caller.
    pub name: String,
    pub text: String,
}

impl BidsFile {
    pub(super) fn new(name: impl Into<String>, text: impl Into<String>) -> BidsFile {
        BidsFile { name: name.into(), text: text.into() }
    }

    pub(super) fn json(name: impl Into<String>, value: &Value) -> BidsFile {
        // Writing JSON cannot fail here, because it contains only strings and finite numbers.
        BidsFile::new(name, format!("{value:#}\n"))
    }
}

#[derive(Clone, Debug)]
pub(super) struct TaskFacts {
    pub name: String,
    pub title: String,
}

impl TaskFacts {
    /// Adds the fields that describe the experimental task to a sidecar file.
    pub(super) fn tell(&self, sidecar: &mut Map<String, Value>) {
        sidecar.insert("TaskName".to_string(), json!(self.name));
        let told = format!("A person and a robot cook together what is ordered, by pressing buttons: {}", self.title);
        sidecar.insert("TaskDescription".to_string(), json!(told));
    }
}

/// A column of a BIDS table: how a sidecar file describes it, and the text of its cell in a row.
pub(super) struct BidsColumn<Row> {
    name: &'static str,
    description: &'static str,
    /// Empty if the values have no unit.
    units: &'static str,
    /// Possible values of the column with their meanings; empty if the values are not from a list.
    levels: &'static [(&'static str, &'static str)],
    cell: fn(&Row) -> String,
}

impl<Row> BidsColumn<Row> {
    pub(super) const fn new(name: &'static str, description: &'static str, cell: fn(&Row) -> String) -> Self {
        BidsColumn { name, description, units: "", levels: &[], cell }
    }

    pub(super) const fn of_unit(
        name: &'static str,
        units: &'static str,
        description: &'static str,
        cell: fn(&Row) -> String,
    ) -> Self {
        BidsColumn { name, description, units, levels: &[], cell }
    }

    pub(super) const fn of_levels(
        name: &'static str,
        levels: &'static [(&'static str, &'static str)],
        description: &'static str,
        cell: fn(&Row) -> String,
    ) -> Self {
        BidsColumn { name, description, units: "", levels, cell }
    }

    fn described(&self) -> Value {
        let mut about = Map::new();
        about.insert("Description".to_string(), json!(self.description));
        if !self.units.is_empty() {
            about.insert("Units".to_string(), json!(self.units));
        }
        if !self.levels.is_empty() {
            let levels: Map<String, Value> =
                self.levels.iter().map(|(value, meaning)| ((*value).to_string(), json!(meaning))).collect();
            about.insert("Levels".to_string(), Value::Object(levels));
        }
        Value::Object(about)
    }
}

pub(super) fn described<Row>(columns: &[BidsColumn<Row>]) -> Map<String, Value> {
    columns.iter().map(|column| (column.name.to_string(), column.described())).collect()
}

pub(super) fn names<Row>(columns: &[BidsColumn<Row>]) -> Vec<&'static str> {
    columns.iter().map(|column| column.name).collect()
}

/// The row as a line of the table with these columns.
pub(super) fn row<Row>(columns: &[BidsColumn<Row>], row: &Row) -> String {
    line(columns.iter().map(|column| (column.cell)(row)))
}

/// A line of a tab-separated table, including the line end.
pub fn line<'a>(cells: impl IntoIterator<Item = impl Into<Cow<'a, str>>>) -> String {
    let cells: Vec<String> = cells.into_iter().map(|one| cell(&one.into())).collect();
    cells.join("\t") + "\n"
}

/// Text of one table cell: tabs and line ends become spaces, text that a spreadsheet would compute gets a `'` in front,
/// and text that contains quotation marks is quoted.
fn cell(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match &*without_formula(plain.trim()) {
        "" => NOTHING.to_string(),
        trimmed if trimmed.contains('"') => format!("\"{}\"", trimmed.replace('"', "\"\"")),
        trimmed => trimmed.to_string(),
    }
}

/// Session time in seconds with nine decimals (nanoseconds), for a table cell.
pub(super) fn seconds(time: SessionTime) -> String {
    format!("{}.{:09}", time.0 / 1_000_000_000, time.0 % 1_000_000_000)
}

/// Time on a tracker's clock in seconds with nine decimals, which can be negative, for a table cell.
pub(super) fn device_seconds(ns: i64) -> String {
    let sign = if ns < 0 { "-" } else { "" };
    format!("{sign}{}", seconds(SessionTime(ns.unsigned_abs())))
}

/// A value as text of a BIDS cell, or "n/a" for `None`.
pub(super) fn or_nothing<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(|| NOTHING.to_string(), |value| value.to_string())
}

pub(super) const YES_NO: &[(&str, &str)] = &[("0", "No"), ("1", "Yes")];

/// BIDS cell of a truth value: 1 for yes, 0 for no.
pub(super) fn yes(is: bool) -> String {
    u8::from(is).to_string()
}
