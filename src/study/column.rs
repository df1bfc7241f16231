//! Columns of tables for other programs: one row per observation, one column per variable (Wickham 2014, "Tidy Data").
//! Each column is declared once with name, unit, meaning and value; the header line, the rows and the data dictionary
//! are generated from these declarations.

use std::borrow::Cow;

use serde::Serialize;

/// Tables that the analysis of a study writes as CSV files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CsvTable {
    /// Table with a row for each participant.
    Participants,
    /// Table with a row for each trial.
    Trials,
    /// Table with a row for each answer to a questionnaire's item.
    Questionnaires,
    /// Table with a row for each question of a tutorial.
    Tutorial,
    /// Table with a row for each unassisted trial, concept and value of the concept's parameter.
    Concepts,
    /// Table with a row for each press of the human or the robot.
    Actions,
    /// Table with a row for each signal that was sent, or that a concept would have sent.
    Communications,
    /// Table with a row for each offer that a wizard could see.
    Offers,
    /// Table with a row for each press of the human and each state aspect.
    Beliefs,
    /// Table with a row for each run of gaze samples on one location.
    Gaze,
    /// Table with a row for each question of a freeze probe.
    Probes,
    /// Table with a row for each column of every table: the column's unit and meaning.
    Dictionary,
}

impl CsvTable {
    /// All CSV tables of a study.
    pub const ALL: [CsvTable; 12] = [
        CsvTable::Participants,
        CsvTable::Trials,
        CsvTable::Questionnaires,
        CsvTable::Tutorial,
        CsvTable::Concepts,
        CsvTable::Actions,
        CsvTable::Communications,
        CsvTable::Offers,
        CsvTable::Beliefs,
        CsvTable::Gaze,
        CsvTable::Probes,
        CsvTable::Dictionary,
    ];
    /// CSV tables whose rows are events of a trial.
    pub const OF_EVENTS: [CsvTable; 5] =
        [CsvTable::Actions, CsvTable::Communications, CsvTable::Offers, CsvTable::Beliefs, CsvTable::Gaze];

    /// File name of the CSV table without `.csv`.
    pub fn name(self) -> &'static str {
        match self {
            CsvTable::Participants => "participants",
            CsvTable::Trials => "trials",
            CsvTable::Questionnaires => "questionnaires",
            CsvTable::Tutorial => "tutorial",
            CsvTable::Concepts => "concepts",
            CsvTable::Actions => "actions",
            CsvTable::Communications => "communications",
            CsvTable::Offers => "offers",
            CsvTable::Beliefs => "beliefs",
            CsvTable::Gaze => "gaze",
            CsvTable::Probes => "probes",
            CsvTable::Dictionary => "dictionary",
        }
    }
}

/// Type of a table's row, from which the row's cells are made.
pub trait CsvRow: Sized {
    /// Table to which a row of this type belongs.
    const TABLE: CsvTable;

    /// Columns of the table, in the order of the file.
    fn columns() -> Vec<CsvColumn<Self>>;

    /// Declares a column with its name, unit (empty for none), meaning, and the function from row to value.
    fn column(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&Self) -> CsvCell<'_> + 'static,
    ) -> CsvColumn<Self> {
        CsvColumn { name: name.into(), unit, meaning: meaning.into(), value: Box::new(value) }
    }

    /// Cells of this row of the table, one per column.
    fn cells(&self) -> Vec<CsvCell<'_>> {
        Self::columns().iter().map(|column| column.cell(self)).collect()
    }
}

/// Declaration of a table's column; `Row` is the type from which rows are made.
pub struct CsvColumn<Row> {
    /// Name of the column.
    pub name: Cow<'static, str>,
    /// Unit of the column's values; empty if they have none.
    pub unit: &'static str,
    /// Meaning of the column, for the data dictionary.
    pub meaning: Cow<'static, str>,
    value: Box<dyn Fn(&Row) -> CsvCell<'_>>,
}

impl<Row> CsvColumn<Row> {
    /// Value of the column in a row of the table.
    pub fn cell<'a>(&self, row: &'a Row) -> CsvCell<'a> {
        (self.value)(row)
    }
}

/// Value of one column of a table in one row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum CsvCell<'a> {
    /// Unknown or missing value, written as an empty field.
    Unknown,
    /// A truth value in a table's cell.
    Flag(bool),
    /// A count of events or items in a table's cell.
    Count(u64),
    /// A signed integer in a table's cell.
    Whole(i64),
    /// A number with decimals in a table's cell.
    Number(f64),
    /// Text in a table's cell.
    Text(Cow<'a, str>),
}

/// Conversions of numbers and truth values into cells.
macro_rules! cell_from {
    ($($from:ty => $kind:ident),*) => {
        $(impl From<$from> for CsvCell<'_> {
            fn from(value: $from) -> Self {
                CsvCell::$kind(value.into())
            }
        })*
    };
}

cell_from!(bool => Flag, u8 => Count, u32 => Count, u64 => Count, i32 => Whole, i64 => Whole, f64 => Number);

impl<'a> From<&'a str> for CsvCell<'a> {
    fn from(text: &'a str) -> Self {
        CsvCell::Text(Cow::Borrowed(text))
    }
}

impl<'a> From<&'a String> for CsvCell<'a> {
    fn from(text: &'a String) -> Self {
        CsvCell::Text(Cow::Borrowed(text))
    }
}

impl From<String> for CsvCell<'_> {
    fn from(text: String) -> Self {
        CsvCell::Text(Cow::Owned(text))
    }
}

impl<'a, T: Into<CsvCell<'a>>> From<Option<T>> for CsvCell<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(CsvCell::Unknown, Into::into)
    }
}
