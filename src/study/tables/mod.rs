//! Declarations of the CSV tables of a study: the type of a row, and the columns.

pub mod actions;
mod arm_columns;
pub mod aspect_beliefs;
pub mod communications;
pub mod concept_table;
pub mod gaze_runs;
pub mod offer_table;
pub mod participants;
pub mod probe_table;
pub mod questionnaires;
mod trial_column;
pub mod trials;
pub mod tutorial_answers;
