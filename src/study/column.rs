//! Columns of tables for other programs: one row per observation, one column per variable (Wickham 2014, "Tidy Data").
//! Each column is declared once, as an entry of `columns!`; header lines, rows, the data dictionary and the sidecar files
//! of BIDS are generated from these entries.

use std::borrow::Cow;

use serde::Serialize;

use crate::tables::actions::ActionRow;
use crate::tables::communications::{BeliefRow, CommunicationRow, ConceptRow, GazeRow, OfferRow};
use crate::tables::participants::{AnswerRow, ParticipantRow, TutorialQuestionRow};
use crate::tables::probe_table::ProbeRow;
use crate::trial_statistics::TrialStatistics;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::IntoStaticStr, strum::VariantArray)]
#[strum(serialize_all = "snake_case")]
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
    /// A row for each column of every table: the column's unit and meaning.
    Dictionary,
}

impl CsvTable {
    pub const ALL: &[CsvTable] = <CsvTable as strum::VariantArray>::VARIANTS;
    pub const OF_EVENTS: [CsvTable; 5] =
        [CsvTable::Actions, CsvTable::Communications, CsvTable::Offers, CsvTable::Beliefs, CsvTable::Gaze];

    /// File name without `.csv`.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

pub trait CsvRow: Sized {
    const TABLE: CsvTable;

    /// In the order of the file.
    fn columns() -> Vec<TableColumn<Self>>;

    fn cells(&self) -> Vec<TableCell<'_>> {
        Self::columns().iter().map(|column| column.cell(self)).collect()
    }
}

/// Possible values of a column with their meanings.
pub type Levels = &'static [(&'static str, &'static str)];

pub struct TableColumn<Row> {
    pub name: Cow<'static, str>,
    pub values: ColumnValues,
    pub meaning: Cow<'static, str>,
    value: Box<dyn Fn(&Row) -> TableCell<'_>>,
}

/// What the values of a column are: numbers of a unit, some of a list, or texts.
pub struct ColumnValues {
    /// Empty: none.
    pub unit: &'static str,
    /// Empty if the values are not from a list.
    pub levels: Levels,
}

impl From<&'static str> for ColumnValues {
    fn from(unit: &'static str) -> Self {
        ColumnValues { unit, levels: &[] }
    }
}

impl From<Levels> for ColumnValues {
    fn from(levels: Levels) -> Self {
        ColumnValues { unit: "", levels }
    }
}

impl<Row> TableColumn<Row> {
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        values: impl Into<ColumnValues>,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&Row) -> TableCell<'_> + 'static,
    ) -> TableColumn<Row> {
        TableColumn { name: name.into(), values: values.into(), meaning: meaning.into(), value: Box::new(value) }
    }

    pub fn cell<'a>(&self, row: &'a Row) -> TableCell<'a> {
        (self.value)(row)
    }
}

/// The columns of a table, an entry each: name; unit (empty: none) or list of values; meaning; value in a row.
macro_rules! columns {
    (|$row:tt: $Row:ty| $($name:expr, $values:expr, $meaning:expr => $value:expr;)*) => {
        vec![$($crate::column::TableColumn::new($name, $values, $meaning, |$row: &$Row| $value.into())),*]
    };
}

pub(crate) use columns;

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TableCell<'a> {
    /// Unknown or missing: an empty field.
    Unknown,
    Flag(bool),
    Count(u64),
    Whole(i64),
    Number(f64),
    Text(Cow<'a, str>),
}

macro_rules! cell_from {
    ($($from:ty => $kind:ident),*) => {
        $(impl<'a> From<$from> for TableCell<'a> {
            fn from(value: $from) -> Self {
                TableCell::$kind(value.into())
            }
        })*
    };
}

cell_from!(bool => Flag, u8 => Count, u32 => Count, u64 => Count, i32 => Whole, i64 => Whole, f64 => Number,
    &'a str => Text, &'a String => Text, String => Text);

impl<'a, T: Into<TableCell<'a>>> From<Option<T>> for TableCell<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(TableCell::Unknown, Into::into)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct DataDictionaryRow {
    pub table: CsvTable,
    pub column: Cow<'static, str>,
    pub unit: &'static str,
    pub meaning: Cow<'static, str>,
}

impl CsvRow for DataDictionaryRow {
    const TABLE: CsvTable = CsvTable::Dictionary;

    fn columns() -> Vec<TableColumn<Self>> {
        columns! { |row: Self|
            "table", "", "name of the table's file without .csv" => row.table.name();
            "column", "", "" => row.column.as_ref();
            "unit", "", "empty: none" => row.unit;
            "meaning", "", "" => row.meaning.as_ref();
        }
    }
}

/// Data dictionary entries of a table, in the order of its columns.
pub fn described(table: CsvTable) -> Vec<DataDictionaryRow> {
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
    entries(Row::columns())
}

/// Data dictionary entries of these columns.
pub fn entries<Row: CsvRow>(columns: Vec<TableColumn<Row>>) -> Vec<DataDictionaryRow> {
    let row = |TableColumn { name: column, values, meaning, .. }: TableColumn<Row>| DataDictionaryRow {
        table: Row::TABLE,
        column,
        unit: values.unit,
        meaning,
    };
    columns.into_iter().map(row).collect()
}

/// The data dictionary of the tables about these trials.
pub fn dictionary(trials: &[TrialStatistics]) -> impl Iterator<Item = DataDictionaryRow> {
    CsvTable::ALL.iter().copied().flat_map(|table| match table {
        CsvTable::Participants => entries(ParticipantRow::columns_of(trials)),
        table => described(table),
    })
}
