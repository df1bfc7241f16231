//! What the rollouts of one signal came to.

use super::human::Deed;
use crate::kitchen::ButtonId;

/// Differences between paired rollouts.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    count: u32,
    sum: f64,
    squares: f64,
    /// What was done without the signal and with it where they first differ, and what that saved in all.
    partings: Vec<(Deed, Deed, f64)>,
}

impl Tally {
    /// Adds what a rollout saved, and where it parted from the silent one.
    pub fn add(&mut self, saved: f64, parted: Option<(Deed, Deed)>) {
        self.count += 1;
        self.sum += saved;
        self.squares += saved * saved;
        if let Some((silent, told)) = parted {
            match self.partings.iter_mut().find(|(a, b, _)| *a == silent && *b == told) {
                Some((_, _, sum)) => *sum += saved,
                None => self.partings.push((silent, told, saved)),
            }
        }
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.count.max(1))
    }

    pub fn standard_error(&self) -> f64 {
        self.error_with(0.0)
    }

    /// The standard error, if a further rollout might save three presses: no difference so far is no proof that there is
    /// none.
    pub fn cautious_error(&self) -> f64 {
        self.error_with(9.0)
    }

    fn error_with(&self, square: f64) -> f64 {
        let n = f64::from(self.count.max(2));
        let spread = (self.squares - self.sum * self.sum / n).max(0.0) + square;
        (spread / (n - 1.0) / n).sqrt()
    }

    /// The press that the signal prevents where that saves most, and what is pressed instead (nothing: waiting).
    pub fn turning_point(&self) -> Option<(ButtonId, Option<ButtonId>)> {
        let presses = self.partings.iter().filter_map(|&(silent, told, saved)| match (silent, told) {
            (Deed::Press(silent), Deed::Press(told)) => Some((silent, Some(told), saved)),
            (Deed::Press(silent), Deed::Wait) => Some((silent, None, saved)),
            (Deed::Wait, _) => None,
        });
        let most = presses.reduce(|best, one| if one.2 > best.2 { one } else { best })?;
        (most.2 > 0.0).then_some((most.0, most.1))
    }
}
