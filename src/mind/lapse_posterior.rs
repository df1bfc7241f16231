//! How often this person slips: a discrete posterior over the lapse, updated by every press of the trial.
//!
//! p(a | b) = (1 - lapse) c(b) + lapse s(b) is linear in the lapse, with c the probability of choosing the press and s that of slipping to it. So
//! the likelihood of a lapse needs only the means of c and s over the belief samples, and the evidence about the belief only the expected
//! lapse. Both are exact.

/// The lapses, in multiples of the human model's, with their probabilities before the first press.
pub const LAPSES: [(f64, f64); 5] = [(0.25, 0.1), (0.5, 0.2), (1.0, 0.4), (2.0, 0.2), (4.0, 0.1)];
/// No lapse is larger.
pub const MOST_LAPSE: f64 = 0.9;

/// Likelihood of a press in two parts: without a slip, and given a slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressParts {
    /// Probability that the press is chosen.
    pub chosen: f64,
    /// Probability that a slip hits its button.
    pub slipped: f64,
}

impl PressParts {
    /// The likelihood with this lapse.
    #[inline]
    pub fn likelihood(&self, lapse: f64) -> f64 {
        (1.0 - lapse) * self.chosen + lapse * self.slipped
    }
}

/// Probabilities of a handful of lapses.
#[derive(Clone, Debug, PartialEq)]
pub struct LapsePosterior {
    /// Each lapse with its probability.
    weighted: [(f64, f64); LAPSES.len()],
}

impl LapsePosterior {
    /// Before the first press, for a human model with this lapse.
    pub fn around(lapse: f64) -> LapsePosterior {
        LapsePosterior { weighted: LAPSES.map(|(times, p)| ((times * lapse).min(MOST_LAPSE), p)) }
    }

    /// The expected lapse.
    pub fn expected(&self) -> f64 {
        self.weighted.iter().map(|(lapse, p)| lapse * p).sum()
    }

    /// Updates the probabilities by a press with these likelihoods.
    pub fn learn(&mut self, likelihood: impl Fn(f64) -> f64) {
        self.weighted.iter_mut().for_each(|(lapse, p)| *p *= likelihood(*lapse));
        let total: f64 = self.weighted.iter().map(|(_, p)| p).sum();
        self.weighted.iter_mut().for_each(|(_, p)| *p /= total);
    }
}
