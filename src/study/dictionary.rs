//! Data dictionary of all columns of the study's tables, generated from the columns' declarations.

use std::borrow::Cow;

use super::column::{CsvColumn, CsvRow, CsvTable};
use super::tables::actions::ActionRow;
use super::tables::aspect_beliefs::BeliefRow;
use super::tables::communications::CommunicationRow;
use super::tables::concept_table::ConceptRow;
use super::tables::gaze_runs::GazeRow;
use super::tables::offer_table::OfferRow;
use super::tables::participants::ParticipantRow;
use super::tables::probe_table::ProbeRow;
use super::tables::questionnaires::AnswerRow;
use super::tables::tutorial_answers::TutorialQuestionRow;
use super::trial_statistics::TrialStatistics;

/// Data dictionary entry of one table column.
#[derive(Clone, Debug, PartialEq)]
pub struct DataDictionaryRow {
    /// Table that has the column.
    pub table: CsvTable,
    /// Name of the column.
    pub column: Cow<'static, str>,
    /// Unit of the column's values; empty if they have none.
    pub unit: &'static str,
    /// Meaning of the column, in words.
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

/// Data dictionary entries of all tables, by table and column.
pub fn dictionary() -> impl Iterator<Item = DataDictionaryRow> {
    CsvTable::ALL.into_iter().flat_map(columns)
}
