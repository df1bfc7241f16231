//! Tab separated tables, and the sidecars that describe their columns.

use std::borrow::Cow;

use serde_json::{Map, Value, json};

use crate::base::time::SessionTime;

/// What BIDS writes where there is no value.
pub(super) const NOTHING: &str = "n/a";

/// A file of the tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BidsFile {
    /// Its path below the tree, or what follows the entities of a recording in its name, as in `events.tsv`. What ends with `.gz` is to
    /// be compressed.
    pub name: String,
    /// Its text, not compressed.
    pub text: String,
}

impl BidsFile {
    pub(super) fn new(name: impl Into<String>, text: impl Into<String>) -> BidsFile {
        BidsFile { name: name.into(), text: text.into() }
    }

    pub(super) fn json(name: impl Into<String>, value: &Value) -> BidsFile {
        // A value of strings and finite numbers is always written.
        BidsFile::new(name, format!("{value:#}\n"))
    }
}

/// The task, as sidecars name it.
#[derive(Clone, Debug)]
pub(super) struct TaskFacts {
    pub name: String,
    pub title: String,
}

impl TaskFacts {
    /// Adds the task to a sidecar.
    pub(super) fn tell(&self, sidecar: &mut Map<String, Value>) {
        sidecar.insert("TaskName".to_string(), json!(self.name));
        let told = format!("A person and a robot cook together what is ordered, by pressing buttons: {}", self.title);
        sidecar.insert("TaskDescription".to_string(), json!(told));
    }
}

/// A column, as a sidecar describes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BidsColumn {
    pub name: &'static str,
    pub description: &'static str,
    /// Empty: no unit.
    pub units: &'static str,
    /// Values with their meanings; none: not a list of values.
    pub levels: &'static [(&'static str, &'static str)],
}

impl BidsColumn {
    pub(super) const fn new(name: &'static str, description: &'static str) -> BidsColumn {
        BidsColumn { name, description, units: "", levels: &[] }
    }

    pub(super) const fn of_unit(name: &'static str, units: &'static str, description: &'static str) -> BidsColumn {
        BidsColumn { name, description, units, levels: &[] }
    }

    pub(super) const fn of_levels(
        name: &'static str,
        levels: &'static [(&'static str, &'static str)],
        description: &'static str,
    ) -> BidsColumn {
        BidsColumn { name, description, units: "", levels }
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

/// Descriptions of columns as the fields of a sidecar.
pub(super) fn described(columns: &[BidsColumn]) -> Map<String, Value> {
    columns.iter().map(|column| (column.name.to_string(), column.described())).collect()
}

/// The names of columns.
pub(super) fn names(columns: &[BidsColumn]) -> Vec<&'static str> {
    columns.iter().map(|column| column.name).collect()
}

/// A line of a table with its end.
pub(super) fn line<'a>(cells: impl IntoIterator<Item = impl Into<Cow<'a, str>>>) -> String {
    let cells: Vec<String> = cells.into_iter().map(|one| cell(&one.into())).collect();
    cells.join("\t") + "\n"
}

/// A cell: without tabs and line ends, which would end it, and in quotes where it has quotes.
fn cell(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match plain.trim() {
        "" => NOTHING.to_string(),
        trimmed if trimmed.contains('"') => format!("\"{}\"", trimmed.replace('"', "\"\"")),
        trimmed => trimmed.to_string(),
    }
}

/// A time in seconds, to the nanosecond.
pub(super) fn seconds(time: SessionTime) -> String {
    format!("{}.{:09}", time.0 / 1_000_000_000, time.0 % 1_000_000_000)
}

/// A value, or nothing.
pub(super) fn or_nothing<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(|| NOTHING.to_string(), |value| value.to_string())
}

/// 1 for yes, 0 for no.
pub(super) fn yes(is: bool) -> String {
    u8::from(is).to_string()
}
