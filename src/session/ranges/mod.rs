//! The ranges of all numbers in session files, files with parameters of the human model, and questionnaires. Those of layouts
//! are in [`crate::kitchen::layout_ranges`]; `docs/settings.md` shows both.
//!
//! A number outside of its range is refused where its file is read. Of the header of a recording the
//! program only warns, where an earlier version took the number.

mod human;
mod people;
mod trial;

use serde::Serialize;

use crate::base::number_range::{self, NumberRange, OutOfRange, numbers};

/// The table of a session file around the parameters of the human model; a file of their own has none.
pub const HUMAN: &str = "human";

/// Those of session files.
pub fn of_sessions() -> Vec<NumberRange> {
    [&trial::RANGES[..], &people::RANGES, &human::RANGES].concat()
}

/// Those of questionnaires.
pub const OF_QUESTIONNAIRES: [NumberRange; 6] = trial::OF_ITEMS;

/// Whether a session file may have all these numbers.
///
/// # Errors
/// The first number outside of its range.
pub fn check_session(spec: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&of_sessions(), &numbers(spec, "")?)
}

/// Whether a file may have all these parameters of the human model.
///
/// # Errors
/// The first number outside of its range; its path begins with [`HUMAN`].
pub fn check_human_model(model: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&human::RANGES, &numbers(model, HUMAN)?)
}

/// Whether a questionnaire may have all these numbers.
///
/// # Errors
/// The first number outside of its range.
pub fn check_questionnaire(questionnaire: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&OF_QUESTIONNAIRES, &numbers(questionnaire, "")?)
}

/// Whether the settings of a session in a recording may have all these numbers.
///
/// # Errors
/// The first number that no version of the program took.
pub fn check_recorded(spec: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_recorded(&of_sessions(), &numbers(spec, "")?)
}
