//! State of the study protocol in a recording: phase, completed steps, and answers.

use super::answer_value::AnswerValue;
use super::tutorial_state::TutorialState;

/// An answer to an item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ItemAnswer {
    /// What the participant answered.
    Given(AnswerValue),
    /// The participant gave no answer.
    Skipped,
}

/// Result of the practice.
#[derive(Clone, Debug, PartialEq)]
pub struct Practice {
    /// Whether the criterion was met.
    pub met: bool,
    /// Orders served.
    pub orders: u32,
    /// The participant's presses.
    pub presses: u32,
    /// Of these, errors.
    pub errors: u32,
    /// Reason for waiving the criterion, if it was waived.
    pub waived: Option<String>,
}

/// State of the study protocol in a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Protocol {
    /// The participant agreed to what the plan asks.
    pub consent: bool,
    /// Number of the phase, from 1; 0 before the first.
    pub number: usize,
    /// Whether each step of the phase is done.
    pub ticks: Vec<bool>,
    /// Answers to the items of the phase.
    pub answers: Vec<Option<ItemAnswer>>,
    /// Index of the shown item; the number of items while all answers are shown for confirmation.
    pub item: usize,
    /// The answers of the phase are confirmed.
    pub confirmed: bool,
    /// How the practice went, once it is over.
    pub practice: Option<Practice>,
    /// The tutorial, in its phase.
    pub tutorial: Option<TutorialState>,
}

impl ItemAnswer {
    /// The answer; `None` if the participant gave none.
    pub fn value(&self) -> Option<&AnswerValue> {
        match self {
            ItemAnswer::Given(value) => Some(value),
            ItemAnswer::Skipped => None,
        }
    }
}

impl Protocol {
    /// The answer to the item with this index, if one was given.
    pub fn given(&self, index: usize) -> Option<&AnswerValue> {
        self.answers.get(index)?.as_ref()?.value()
    }

    /// Records the answer to the shown item and shows the next one, unless this one stays; after the last item, the first unanswered
    /// one or all answers.
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

    /// The first item without an answer.
    pub fn open_item(&self) -> Option<usize> {
        self.answers.iter().position(Option::is_none)
    }
}
