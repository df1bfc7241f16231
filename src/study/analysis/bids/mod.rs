//! Recordings as the tables of the Brain Imaging Data Structure (BIDS): a recording becomes a session with behaviour,
//! gaze becomes an eye-tracking recording, and questionnaires become phenotype tables.
//!
//! Column names and required fields are those of BIDS 1.10 and later (behavioral experiments, physiological recordings,
//! phenotypic data). This module makes the content of the files; its caller writes the files.

mod belief_rows;
mod dataset;
mod event_cells;
mod event_columns;
mod event_levels;
mod labels;
mod phenotype;
mod recording_tables;
mod sample_rows;
mod session_rows;
mod spans;
mod tsv;

pub use self::dataset::{
    BidsParticipant, CODE_COLUMN, DESCRIPTION_NAME, PARTICIPANTS_NAME, PROGRAM_NAME, dataset_files,
};
pub use self::event_levels::LEVELS;
pub use self::labels::{BidsLabelMap, letters_and_digits, session_label};
pub use self::phenotype::QuestionnairePhenotypes;
pub use self::recording_tables::{BidsRowCounts, PressOutcome, RecordingTables};
pub use self::sample_rows::{LongTable, LongTableFacts, LongTableRow};
pub use self::session_rows::{BidsSessionRow, sessions_files};
pub use self::tsv::BidsFile;
