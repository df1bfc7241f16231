//! State of the study protocol in a recording: phase, completed steps, and answers to the questionnaire.

use super::answer_value::AnswerValue;
use super::tutorial_state::TutorialState;

/// The answer to a questionnaire item, or that it was skipped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ItemAnswer {
    /// The participant's answer to the questionnaire item.
    Given(AnswerValue),
    /// The participant gave no answer to the questionnaire item.
    Skipped,
}

/// Result of the practice trial.
#[derive(Clone, Debug, PartialEq)]
pub struct PracticeResult {
    /// Whether the practice trial met the criterion.
    pub met: bool,
    /// Number of orders served in the practice trial.
    pub orders: u32,
    /// Number of the participant's presses in the practice trial.
    pub presses: u32,
    /// Number of errors among the participant's presses in the practice trial.
    pub errors: u32,
    /// The wizard's reason for waiving the criterion, if it was waived.
    pub waived: Option<String>,
}

/// State of the study protocol in a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyProtocolState {
    /// Whether the participant consented to what the plan asks for.
    pub consent: bool,
    /// Number of the recording's present phase, from 1; 0 before the first phase.
    pub number: usize,
    /// Whether each step of the present instruction or debriefing is done.
    pub ticks: Vec<bool>,
    /// Answers to the items of the present phase's questionnaire.
    pub answers: Vec<Option<ItemAnswer>>,
    /// Index of the shown questionnaire item; the number of items while all answers are shown for confirmation.
    pub item: usize,
    /// Whether the participant has confirmed the answers to the phase's questionnaire.
    pub confirmed: bool,
    /// Result of the practice trial, once it is over.
    pub practice: Option<PracticeResult>,
    /// State of the tutorial, if the present phase is the tutorial.
    pub tutorial: Option<TutorialState>,
}

impl ItemAnswer {
    /// The value that the participant answered; `None` if the questionnaire item was skipped.
    pub fn value(&self) -> Option<&AnswerValue> {
        match self {
            ItemAnswer::Given(value) => Some(value),
            ItemAnswer::Skipped => None,
        }
    }
}

impl StudyProtocolState {
    /// The answer to the questionnaire item with this index, if the participant gave one.
    pub fn given(&self, index: usize) -> Option<&AnswerValue> {
        self.answers.get(index)?.as_ref()?.value()
    }

    /// Records the answer to the shown questionnaire item and shows the next one, unless the shown item stays; after
    /// the last item, the first unanswered one or all answers are shown.
    pub(super) fn answer(&mut self, answer: ItemAnswer, stays: bool) {
        if let Some(place) = self.answers.get_mut(self.item) {
            *place = Some(answer);
        }
        if stays {
            return;
        }
        let next = self.item + 1;
        self.item = match self.open_item() {
            None => self.answers.len(),
            Some(open) if next == self.answers.len() => open,
            Some(_) => next,
        };
    }

    /// Index of the first questionnaire item without an answer.
    pub fn open_item(&self) -> Option<usize> {
        self.answers.iter().position(Option::is_none)
    }
}
