//! Columns of tables for other programs: one row per observation, one column per variable (Wickham 2014, "Tidy Data").
//! Each column is declared once with name, unit, meaning and value; the header line, the rows and the data dictionary
//! are generated from these declarations.

use std::borrow::Cow;

use serde::Serialize;

use crate::tables::actions::ActionRow;
use crate::tables::communications::{BeliefRow, CommunicationRow, ConceptRow, GazeRow, OfferRow};
use crate::tables::participants::{AnswerRow, ParticipantRow, TutorialQuestionRow};
use crate::tables::probe_table::ProbeRow;
use crate::trial_statistics::TrialStatistics;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CsvTable {
    Participants,
    Trials,
    Questionnaires,
    Tutorial,
    Concepts,
    Actions,
    Communications,
    Offers,
    Beliefs,
    Gaze,
    Probes,
    /// Table with a row for each column of every table: the column's unit and meaning.
    Dictionary,
}

impl CsvTable {
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

pub trait CsvRow: Sized {
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

    fn cells(&self) -> Vec<CsvCell<'_>> {
        Self::columns().iter().map(|column| column.cell(self)).collect()
    }
}

pub struct CsvColumn<Row> {
    pub name: Cow<'static, str>,
    /// Unit of the column's values; empty if they have none.
    pub unit: &'static str,
    pub meaning: Cow<'static, str>,
    value: Box<dyn Fn(&Row) -> CsvCell<'_>>,
}

impl<Row> CsvColumn<Row> {
    pub fn cell<'a>(&self, row: &'a Row) -> CsvCell<'a> {
        (self.value)(row)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum CsvCell<'a> {
    /// Unknown or missing value, written as an empty field.
    Unknown,
    Flag(bool),
    Count(u64),
    Whole(i64),
    Number(f64),
    Text(Cow<'a, str>),
}

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

#[derive(Clone, Debug, PartialEq)]
pub struct DataDictionaryRow {
    pub table: CsvTable,
    pub column: Cow<'static, str>,
    /// Unit of the column's values; empty if they have none.
    pub unit: &'static str,
    pub meaning: Cow<'static, str>,
}

impl CsvRow for DataDictionaryRow {
    const TABLE: CsvTable = CsvTable::Dictionary;

    fn columns() -> Vec<CsvColumn<Self>> {
        vec![
            Self::column("table", "", "name of the table's file without .csv", |row| row.table.name().into()),
            Self::column("column", "", "", |row| row.column.as_ref().into()),
            Self::column("unit", "", "empty: none", |row| row.unit.into()),
            Self::column("meaning", "", "", |row| row.meaning.as_ref().into()),
        ]
    }
}

/// Data dictionary entries of a table, in the order of its columns.
pub fn columns(table: CsvTable) -> Vec<DataDictionaryRow> {
    match table {
        CsvTable::Participants => declared::<ParticipantRow>(),
        CsvTable::Trials => declared::<TrialStatistics>(),
        CsvTable::Questionnaires => declared::<AnswerRow>(),
        CsvTable::Tutorial => declared::<TutorialQuestionRow>(),
        CsvTable::Concepts => declared::<ConceptRow>(),
        CsvTable::Actions => declared::<ActionRow>(),
        CsvTable::Communications => declared::<CommunicationRow>(),
        CsvTable::Offers => declared::<OfferRow>(),
        CsvTable::Beliefs => declared::<BeliefRow>(),
        CsvTable::Gaze => declared::<GazeRow>(),
        CsvTable::Probes => declared::<ProbeRow>(),
        CsvTable::Dictionary => declared::<DataDictionaryRow>(),
    }
}

fn declared<Row: CsvRow>() -> Vec<DataDictionaryRow> {
    let row = |CsvColumn { name, unit, meaning, .. }: CsvColumn<Row>| DataDictionaryRow {
        table: Row::TABLE,
        column: name,
        unit,
        meaning,
    };
    Row::columns().into_iter().map(row).collect()
}

pub fn dictionary() -> impl Iterator<Item = DataDictionaryRow> {
    CsvTable::ALL.into_iter().flat_map(columns)
}
