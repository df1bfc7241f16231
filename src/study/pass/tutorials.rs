//! Reads the answers to the comprehension questions of tutorials, including those in practice recordings, which are not
//! analysed as trials.

use crate::tables::tutorial_answers::{TutorialAnswerCollector, TutorialQuestionRow};
use tomcom_session::files::file_error::FileResult;
use tomcom_session::log::LogReader;

/// The participant's answers in a log of which nothing was read yet; `name` is the recording's name in tables. None if
/// the recording has no tutorial.
///
/// # Errors
/// The recording cannot be read.
pub(super) fn read(mut log: LogReader, name: &str) -> FileResult<Vec<TutorialQuestionRow>> {
    let spec = log.header.session.clone();
    let Some(mut answers) = TutorialAnswerCollector::new(name, &spec) else { return Ok(Vec::new()) };
    while let Some(line) = log.next_line()? {
        answers.note(&line.stamped);
    }
    Ok(answers.finish())
}
