//! The comparison of wizard and assistants at the console: which difference is looked at.

use crate::history::comparison::{LaneComparison, UnmatchedCommunication};

/// What a key asks of the list of differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparisonKey {
    /// Go to the next difference.
    Next,
    /// Go to the difference before.
    Last,
    /// Shows what each knew then.
    Open,
}

/// The comparison at the console, and the difference that is looked at.
#[derive(Clone, Debug, Default)]
pub struct ComparisonView {
    /// None until the first press or order.
    pub seen: Option<LaneComparison>,
    /// None: the newest.
    chosen: Option<UnmatchedCommunication>,
}

impl ComparisonView {
    /// Takes over what was compared meanwhile; what was chosen stays chosen.
    pub fn show(&mut self, newest: LaneComparison) {
        self.chosen = self.chosen.filter(|chosen| newest.differences.contains(chosen));
        self.seen = Some(newest);
    }

    /// The difference that is looked at: its place in the list, and the comparison.
    pub fn chosen(&self) -> Option<(usize, &LaneComparison)> {
        let seen = self.seen.as_ref()?;
        let newest = seen.differences.len().checked_sub(1)?;
        let is_it = |chosen: UnmatchedCommunication| seen.differences.iter().position(|one| *one == chosen);
        Some((self.chosen.and_then(is_it).unwrap_or(newest), seen))
    }

    /// Goes on to the next difference, or back to the last; at the newest the newest is followed.
    pub fn choose(&mut self, step: ComparisonKey) {
        let Some((at, seen)) = self.chosen() else { return };
        let to = match step {
            ComparisonKey::Next => at + 1,
            ComparisonKey::Last => at.saturating_sub(1),
            ComparisonKey::Open => at,
        };
        self.chosen = seen.differences.get(to).copied().filter(|_| to + 1 < seen.differences.len());
    }
}
