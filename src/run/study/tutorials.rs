//! Reads the answers to the comprehension questions of tutorials, including those in practice recordings, which are not
//! analysed as trials.

use std::path::Path;

use crate::edge::file_error::FileResult;
use crate::edge::log::LogReader;
use crate::study::tables::tutorial_answers::{TutorialAnswer, TutorialAnswers};

/// The answers in a recording; empty if it has no tutorial. `name`: name of the recording in tables.
///
/// # Errors
/// The recording cannot be read.
pub(super) fn read(recording: &Path, name: &str) -> FileResult<Vec<TutorialAnswer>> {
    let mut log = LogReader::open(recording)?;
    let spec = log.header.session.clone();
    let Some(mut answers) = TutorialAnswers::new(name, &spec) else { return Ok(Vec::new()) };
    while let Some(line) = log.next_line()? {
        answers.note(&line.stamped);
    }
    Ok(answers.finish())
}
