//! The tables and their dictionary.

use csv::Writer;
use serde::Serialize;
use tomcom::study::tables::{
    ActionRow, AnswerRow, BeliefRow, CommunicationRow, ConceptRow, DictionaryRow, GazeRow, ParticipantRow, Table,
};
use tomcom::study::trial_row::TrialRow;

/// The names of the fields of a row, as they are written.
fn columns(row: &impl Serialize) -> Vec<String> {
    let mut out = Writer::from_writer(Vec::new());
    out.serialize(row).expect("a flat row");
    let text = String::from_utf8(out.into_inner().expect("bytes")).expect("text");
    text.lines().next().unwrap_or_default().split(',').map(str::to_string).collect()
}

#[test]
fn the_dictionary_says_what_every_column_means() {
    let of_table = |table: Table| match table {
        Table::Participants => columns(&ParticipantRow::default()),
        Table::Trials => columns(&TrialRow::default()),
        Table::Questionnaires => columns(&AnswerRow::default()),
        Table::Concepts => columns(&ConceptRow::default()),
        Table::Actions => columns(&ActionRow::default()),
        Table::Communications => columns(&CommunicationRow::default()),
        Table::Beliefs => columns(&BeliefRow::default()),
        Table::Gaze => columns(&GazeRow::default()),
        Table::Dictionary => columns(&DictionaryRow { table: "", column: "", unit: "", meaning: "" }),
    };
    for table in Table::ALL {
        assert_eq!(of_table(table), table.columns().collect::<Vec<_>>(), "{}", table.name());
    }
}
