//! The allowed ranges of all numbers in session files, in files with parameters of the human model, and in
//! questionnaires. Those of layouts are in [`tomcom_core::kitchen::files`]; `docs/settings.md` shows both.
//! A file with a number outside of its allowed range is refused, and so is the header of a recording.

mod human;
mod people;
mod trial;

use serde::Serialize;

use tomcom_core::base::number_range::{self, NumberRange, OutOfRange, numbers};

/// The table of a session file that contains the parameters of the human model; a separate file of parameters has no
/// such table.
pub const HUMAN: &str = "human";

/// Allowed ranges of all numbers in session files.
pub fn of_sessions() -> Vec<NumberRange> {
    [&trial::RANGES[..], &people::RANGES, &human::RANGES].concat()
}

/// Allowed ranges of all numbers in questionnaires.
pub const OF_QUESTIONNAIRES: [NumberRange; 6] = trial::OF_ITEMS;

/// Checks that all numbers of a session file are in their allowed ranges.
///
/// # Errors
/// The first number outside of its allowed range.
pub fn check_session(spec: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&of_sessions(), &numbers(spec, "")?)
}

/// Checks that all parameters of the human model in a file are in their allowed ranges.
///
/// # Errors
/// The first number outside of its allowed range; its path begins with [`HUMAN`].
pub fn check_human_model(model: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&human::RANGES, &numbers(model, HUMAN)?)
}

/// Checks that all numbers of a questionnaire are in their allowed ranges.
///
/// # Errors
/// The first number outside of its allowed range.
pub fn check_questionnaire(questionnaire: &impl Serialize) -> Result<(), OutOfRange> {
    number_range::check_file(&OF_QUESTIONNAIRES, &numbers(questionnaire, "")?)
}
