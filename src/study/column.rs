//! Columns of tables for other programs: one row per observation, one column per variable (Wickham 2014, "Tidy Data").
//! Each column is declared once with name, unit, meaning and value; header line, rows and data dictionary are generated
//! from the declaration.

use std::borrow::Cow;

use serde::Serialize;

/// Tables that the analysis of a study writes as CSV files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Table {
    /// A row for each participant.
    Participants,
    /// A row for each trial.
    Trials,
    /// A row for each answer to a questionnaire's item.
    Questionnaires,
    /// A row for each question of a tutorial.
    Tutorial,
    /// A row for each unassisted trial, concept and value of its parameter.
    Concepts,
    /// A row for each press of the human or the robot.
    Actions,
    /// A row for each signal that was sent, or would have been.
    Communications,
    /// A row for each offer that a wizard could see.
    Offers,
    /// A row for each press of the human and state aspect.
    Beliefs,
    /// A row for each run of gaze samples on one location.
    Gaze,
    /// A row for each question of a probe.
    Probes,
    /// A row for each column of every table: its unit and meaning.
    Dictionary,
}

impl Table {
    /// All tables.
    pub const ALL: [Table; 12] = [
        Table::Participants,
        Table::Trials,
        Table::Questionnaires,
        Table::Tutorial,
        Table::Concepts,
        Table::Actions,
        Table::Communications,
        Table::Offers,
        Table::Beliefs,
        Table::Gaze,
        Table::Probes,
        Table::Dictionary,
    ];
    /// Tables whose rows are events of a trial.
    pub const OF_EVENTS: [Table; 5] =
        [Table::Actions, Table::Communications, Table::Offers, Table::Beliefs, Table::Gaze];

    /// File name of the table without `.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Table::Participants => "participants",
            Table::Trials => "trials",
            Table::Questionnaires => "questionnaires",
            Table::Tutorial => "tutorial",
            Table::Concepts => "concepts",
            Table::Actions => "actions",
            Table::Communications => "communications",
            Table::Offers => "offers",
            Table::Beliefs => "beliefs",
            Table::Gaze => "gaze",
            Table::Probes => "probes",
            Table::Dictionary => "dictionary",
        }
    }
}

/// Type from which the rows of a table are made.
pub trait TableRow: Sized {
    /// Table that the row belongs to.
    const TABLE: Table;

    /// Columns of the table, in file order.
    fn columns() -> Vec<Column<Self>>;

    /// Declares a column with its name, unit (empty for none), meaning, and function from row to value.
    fn column(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&Self) -> TableCell<'_> + 'static,
    ) -> Column<Self> {
        Column { name: name.into(), unit, meaning: meaning.into(), value: Box::new(value) }
    }

    /// Cells of this row, one per column.
    fn cells(&self) -> Vec<TableCell<'_>> {
        Self::columns().iter().map(|column| column.cell(self)).collect()
    }
}

/// Declaration of a table's column; `Row` is the type from which rows are made.
pub struct Column<Row> {
    /// Name of the column.
    pub name: Cow<'static, str>,
    /// Unit of the column; empty for none.
    pub unit: &'static str,
    /// Meaning of the column, for the data dictionary.
    pub meaning: Cow<'static, str>,
    value: Box<dyn Fn(&Row) -> TableCell<'_>>,
}

impl<Row> Column<Row> {
    /// Value of the column in a row.
    pub fn cell<'a>(&self, row: &'a Row) -> TableCell<'a> {
        (self.value)(row)
    }
}

/// Value of one table column in one row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TableCell<'a> {
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
        $(impl From<$from> for TableCell<'_> {
            fn from(value: $from) -> Self {
                TableCell::$kind(value.into())
            }
        })*
    };
}

cell_from!(bool => Flag, u8 => Count, u32 => Count, u64 => Count, i32 => Whole, i64 => Whole, f64 => Number);

impl<'a> From<&'a str> for TableCell<'a> {
    fn from(text: &'a str) -> Self {
        TableCell::Text(Cow::Borrowed(text))
    }
}

impl<'a> From<&'a String> for TableCell<'a> {
    fn from(text: &'a String) -> Self {
        TableCell::Text(Cow::Borrowed(text))
    }
}

impl From<String> for TableCell<'_> {
    fn from(text: String) -> Self {
        TableCell::Text(Cow::Owned(text))
    }
}

impl<'a, T: Into<TableCell<'a>>> From<Option<T>> for TableCell<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(TableCell::Unknown, Into::into)
    }
}
