//! Where a recording of a plan is: its phase, the steps that are done, and the answers.

/// An answer to an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemAnswer {
    Rated(u8),
    Skipped,
}

/// How the practice went.
#[derive(Clone, Debug, PartialEq)]
pub struct Practice {
    pub met: bool,
    pub orders: u32,
    pub presses: u32,
    pub errors: u32,
    /// Why the participant goes on all the same.
    pub waived: Option<String>,
}

/// Where a recording of a plan is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Protocol {
    pub consent: bool,
    /// The number of the phase, from 1; 0: before the first.
    pub number: usize,
    /// The steps of the phase that are done.
    pub ticks: Vec<bool>,
    /// The answers to the items of the phase.
    pub answers: Vec<Option<ItemAnswer>>,
    /// The item in front of the participant; the number of items: all of them, to be confirmed.
    pub item: usize,
    pub confirmed: bool,
    pub practice: Option<Practice>,
}

impl Protocol {
    /// Answers the shown item, and shows the next one; after the last, the first that was left out, or all answers.
    pub(super) fn answer(&mut self, answer: ItemAnswer) {
        if let Some(place) = self.answers.get_mut(self.item) {
            *place = Some(answer);
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
