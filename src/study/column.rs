//! What the tables are made of, which other programs read: one row an observation, one column a variable (Wickham 2014, "Tidy
//! Data"). A column is declared once, with name, unit, meaning and value; the first line of its table, the rows and the
//! dictionary follow from the declaration.

use std::borrow::Cow;

use serde::Serialize;

/// A table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Table {
    Participants,
    Trials,
    Questionnaires,
    Concepts,
    Actions,
    Communications,
    Beliefs,
    Gaze,
    Dictionary,
}

impl Table {
    pub const ALL: [Table; 9] = [
        Table::Participants,
        Table::Trials,
        Table::Questionnaires,
        Table::Concepts,
        Table::Actions,
        Table::Communications,
        Table::Beliefs,
        Table::Gaze,
        Table::Dictionary,
    ];
    /// Those that grow with what happens in a trial.
    pub const OF_EVENTS: [Table; 4] = [Table::Actions, Table::Communications, Table::Beliefs, Table::Gaze];

    /// The name of its file is this with `.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Table::Participants => "participants",
            Table::Trials => "trials",
            Table::Questionnaires => "questionnaires",
            Table::Concepts => "concepts",
            Table::Actions => "actions",
            Table::Communications => "communications",
            Table::Beliefs => "beliefs",
            Table::Gaze => "gaze",
            Table::Dictionary => "dictionary",
        }
    }
}

/// What a row of a table is made from.
pub trait TableRow: Sized {
    /// The table that the row belongs to.
    const TABLE: Table;

    /// The columns of the table, in their order.
    fn columns() -> Vec<Column<Self>>;

    /// A column: its name, its unit (empty: none), what it means, and what stands in it.
    fn column(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&Self) -> TableCell<'_> + 'static,
    ) -> Column<Self> {
        Column { name: name.into(), unit, meaning: meaning.into(), value: Box::new(value) }
    }

    /// The cells of this row, one per column.
    fn cells(&self) -> Vec<TableCell<'_>> {
        Self::columns().iter().map(|column| column.cell(self)).collect()
    }
}

/// A column of a table whose rows are made from `Row`.
pub struct Column<Row> {
    pub name: Cow<'static, str>,
    /// Empty: none.
    pub unit: &'static str,
    pub meaning: Cow<'static, str>,
    value: Box<dyn Fn(&Row) -> TableCell<'_>>,
}

impl<Row> Column<Row> {
    /// What stands in this column of a row.
    pub fn cell<'a>(&self, row: &'a Row) -> TableCell<'a> {
        (self.value)(row)
    }
}

/// What stands in one column of one row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TableCell<'a> {
    /// Nobody knows, or there is none: an empty field.
    Unknown,
    Flag(bool),
    Count(u64),
    Whole(i64),
    Number(f64),
    Text(Cow<'a, str>),
}

/// Numbers and truth values become cells of their kind.
macro_rules! cell_from {
    ($($from:ty => $kind:ident),*) => {
        $(impl From<$from> for TableCell<'_> {
            fn from(value: $from) -> Self {
                TableCell::$kind(value.into())
            }
        })*
    };
}

cell_from!(bool => Flag, u8 => Count, u32 => Count, u64 => Count, i32 => Whole, f64 => Number);

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
