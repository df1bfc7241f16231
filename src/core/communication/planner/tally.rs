//! Statistics of the differences between paired rollouts, one with and one without a signal.

use crate::mind::choice::HumanChoice;

/// Running statistics of the differences between paired rollouts, one with and one without a signal.
#[derive(Clone, Debug, Default)]
pub struct PairedDifferences {
    count: u32,
    sum: f64,
    squares: f64,
    divergences: Vec<Divergence>,
}

/// A pair of different choices of the human, at which the rollouts without and with the signal separate.
#[derive(Clone, Copy, Debug)]
struct Divergence {
    baseline: HumanChoice,
    signalled: HumanChoice,
    /// Sum of the savings in rollouts with this pair of choices, and sum of their squares, in presses.
    sum: f64,
    squares: f64,
}

impl Divergence {
    /// Total saving of rollouts with this pair of choices minus one standard error, so that a single large saving by
    /// chance does not count as the reason.
    fn surely_saved(&self) -> f64 {
        self.sum - self.squares.sqrt()
    }
}

impl PairedDifferences {
    /// Adds the saving of a rollout, in presses, and the human's choices at which it diverged from the baseline.
    pub fn add(&mut self, saved: f64, diverged: Option<(HumanChoice, HumanChoice)>) {
        self.count += 1;
        self.sum += saved;
        self.squares += saved * saved;
        if let Some((baseline, signalled)) = diverged {
            match self
                .divergences
                .iter_mut()
                .find(|divergence| divergence.baseline == baseline && divergence.signalled == signalled)
            {
                Some(divergence) => {
                    divergence.sum += saved;
                    divergence.squares += saved * saved;
                }
                None => self.divergences.push(Divergence { baseline, signalled, sum: saved, squares: saved * saved }),
            }
        }
    }

    /// Number of pairs of rollouts so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean saving of the rollouts with the signal, in presses; 0 without rollouts.
    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.count.max(1))
    }

    /// Standard error of the mean saving, in presses.
    pub fn standard_error(&self) -> f64 {
        self.error_with(0.0)
    }

    /// Standard error of the mean saving if one further rollout saved three presses: while no rollout differed, the
    /// plain standard error would be 0.
    pub fn cautious_error(&self) -> f64 {
        self.error_with(9.0)
    }

    fn error_with(&self, square: f64) -> f64 {
        let n = f64::from(self.count.max(2));
        let spread = (self.squares - self.sum * self.sum / n).max(0.0) + square;
        (spread / (n - 1.0) / n).sqrt()
    }

    /// The choice that the signal prevents with the largest saving, and the choice that replaces it.
    pub fn turning_point(&self) -> Option<[HumanChoice; 2]> {
        let all = self.divergences.iter();
        let most = all.reduce(|best, one| if one.surely_saved() > best.surely_saved() { one } else { best })?;
        (most.sum > 0.0).then_some([most.baseline, most.signalled])
    }
}
