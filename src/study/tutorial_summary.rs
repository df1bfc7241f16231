//! Summary of the comprehension questions in tutorials.

use serde::Serialize;

use super::tables::tutorial_answers::TutorialQuestionRow;

/// Summary of the answers to the tutorials' comprehension questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TutorialSummary {
    /// Number of participants who answered a tutorial question.
    pub participants: u64,
    /// Number of tutorial questions that were answered.
    pub questions: u64,
    /// Number of tutorial questions whose first answer was right.
    pub right_at_once: u64,
}

impl TutorialSummary {
    /// Summarizes answers, which must be ordered by participant; `None` if no question was answered.
    pub fn from_answers(answers: &[TutorialQuestionRow]) -> Option<TutorialSummary> {
        let answered: Vec<&TutorialQuestionRow> = answers.iter().filter(|answer| answer.tries > 0).collect();
        let mut participants: Vec<&str> = answered.iter().map(|answer| answer.participant.as_str()).collect();
        participants.dedup();
        (!answered.is_empty()).then(|| TutorialSummary {
            participants: participants.len() as u64,
            questions: answered.len() as u64,
            right_at_once: answered.iter().filter(|answer| answer.is_right_at_once()).count() as u64,
        })
    }
}
