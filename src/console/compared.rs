//! Which difference between wizard and assistant the console's comparison shows.

use tomcom_session::history::comparison::{SenderComparison, UnmatchedCommunication};

/// Action of a key in the list of differences between wizard and assistant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparisonAction {
    /// Go to the next difference between wizard and assistant.
    Next,
    /// Go to the previous difference between wizard and assistant.
    Last,
    /// Show what the wizard and the assistant each knew at the time of the difference.
    Open,
}

/// Comparison of wizard and assistants at the console, with the selected difference.
#[derive(Clone, Debug, Default)]
pub struct SenderComparisonView {
    /// Newest comparison; `None` until the trial's first press or order.
    pub seen: Option<SenderComparison>,
    /// Selected communication that has no match; `None` selects the newest one.
    chosen: Option<UnmatchedCommunication>,
}

impl SenderComparisonView {
    /// Takes over the newest comparison; the selected difference stays selected if it is still one.
    pub fn show(&mut self, newest: SenderComparison) {
        self.chosen = self.chosen.filter(|chosen| newest.differences.contains(chosen));
        self.seen = Some(newest);
    }

    /// Index of the selected difference, and the comparison that contains it.
    pub fn chosen(&self) -> Option<(usize, &SenderComparison)> {
        let seen = self.seen.as_ref()?;
        let newest = seen.differences.len().checked_sub(1)?;
        let is_it = |chosen: UnmatchedCommunication| seen.differences.iter().position(|one| *one == chosen);
        Some((self.chosen.and_then(is_it).unwrap_or(newest), seen))
    }

    /// Selects the next or the previous difference. From the last one on, the newest difference is always selected.
    pub fn choose(&mut self, step: ComparisonAction) {
        let Some((at, seen)) = self.chosen() else { return };
        let to = match step {
            ComparisonAction::Next => at + 1,
            ComparisonAction::Last => at.saturating_sub(1),
            ComparisonAction::Open => at,
        };
        self.chosen = seen.differences.get(to).copied().filter(|_| to + 1 < seen.differences.len());
    }
}
