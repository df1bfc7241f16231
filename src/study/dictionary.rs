//! Data dictionary of all table columns, generated from their declarations.

use std::borrow::Cow;

use super::column::{Column, Table, TableRow};
use super::tables::actions::ActionRow;
use super::tables::aspect_beliefs::BeliefRow;
use super::tables::communications::CommunicationRow;
use super::tables::concept_table::ConceptRow;
use super::tables::gaze_runs::GazeRow;
use super::tables::offer_table::OfferRow;
use super::tables::participants::ParticipantRow;
use super::tables::probe_table::ProbeRow;
use super::tables::questionnaires::AnswerRow;
use super::tables::tutorial_answers::TutorialAnswer;
use super::trial_statistics::Trial;

/// Data dictionary entry of one table column.
#[derive(Clone, Debug, PartialEq)]
pub struct DictionaryRow {
    /// Table of the column.
    pub table: Table,
    /// Name of the column.
    pub column: Cow<'static, str>,
    /// Unit of the column; empty for none.
    pub unit: &'static str,
    /// Meaning of the column.
    pub meaning: Cow<'static, str>,
}

impl TableRow for DictionaryRow {
    const TABLE: Table = Table::Dictionary;

    fn columns() -> Vec<Column<Self>> {
        vec![
            Self::column("table", "", "name of the table's file without .csv", |row| row.table.name().into()),
            Self::column("column", "", "", |row| row.column.as_ref().into()),
            Self::column("unit", "", "empty: none", |row| row.unit.into()),
            Self::column("meaning", "", "", |row| row.meaning.as_ref().into()),
        ]
    }
}

/// Data dictionary entries of a table, in the order of its columns.
pub fn columns(table: Table) -> Vec<DictionaryRow> {
    match table {
        Table::Participants => declared::<ParticipantRow>(),
        Table::Trials => declared::<Trial>(),
        Table::Questionnaires => declared::<AnswerRow>(),
        Table::Tutorial => declared::<TutorialAnswer>(),
        Table::Concepts => declared::<ConceptRow>(),
        Table::Actions => declared::<ActionRow>(),
        Table::Communications => declared::<CommunicationRow>(),
        Table::Offers => declared::<OfferRow>(),
        Table::Beliefs => declared::<BeliefRow>(),
        Table::Gaze => declared::<GazeRow>(),
        Table::Probes => declared::<ProbeRow>(),
        Table::Dictionary => declared::<DictionaryRow>(),
    }
}

fn declared<Row: TableRow>() -> Vec<DictionaryRow> {
    let row = |Column { name, unit, meaning, .. }: Column<Row>| DictionaryRow {
        table: Row::TABLE,
        column: name,
        unit,
        meaning,
    };
    Row::columns().into_iter().map(row).collect()
}

/// Data dictionary entries of all tables, by table and column.
pub fn dictionary() -> impl Iterator<Item = DictionaryRow> {
    Table::ALL.into_iter().flat_map(columns)
}
