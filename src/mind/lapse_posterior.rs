//! How often this person slips: a discrete posterior distribution over the lapse (share of slips), updated by every
//! press of the trial.
//!
//! p(a | b) = (1 - lapse) c(b) + lapse s(b) is linear in the lapse, with c the probability of choosing the press and s
//! the probability of slipping to it. So the likelihood of a lapse needs only the means of c and s over the belief
//! samples, and the evidence about the belief needs only the expected lapse. Both are exact.

/// Possible lapses as multiples of the human model's lapse, with their probabilities before the first press.
pub const LAPSES: [(f64, f64); 5] = [(0.25, 0.1), (0.5, 0.2), (1.0, 0.4), (2.0, 0.2), (4.0, 0.1)];
/// Largest possible lapse (share of slips).
pub const MOST_LAPSE: f64 = 0.9;

/// Likelihood of a press in two parts: without a slip, and given a slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressParts {
    /// Probability that the human chooses the press, given no slip.
    pub chosen: f64,
    /// Probability that a slip hits the pressed button.
    pub slipped: f64,
}

impl PressParts {
    /// The likelihood of the press with this lapse.
    #[inline]
    pub fn likelihood(&self, lapse: f64) -> f64 {
        (1.0 - lapse) * self.chosen + lapse * self.slipped
    }
}

/// Posterior probabilities of a handful of lapses (shares of slips).
#[derive(Clone, Debug, PartialEq)]
pub struct LapsePosterior {
    /// Each possible lapse with its probability.
    weighted: [(f64, f64); LAPSES.len()],
}

impl LapsePosterior {
    /// The distribution over lapses before the first press, for a human model with this lapse.
    pub fn around(lapse: f64) -> LapsePosterior {
        LapsePosterior { weighted: LAPSES.map(|(times, p)| ((times * lapse).min(MOST_LAPSE), p)) }
    }

    /// The expected lapse (share of slips) of this person.
    pub fn expected(&self) -> f64 {
        self.weighted.iter().map(|(lapse, p)| lapse * p).sum()
    }

    /// Updates the probabilities of the lapses by a press; `likelihood` gives the press's likelihood for a lapse.
    pub fn learn(&mut self, likelihood: impl Fn(f64) -> f64) {
        self.weighted.iter_mut().for_each(|(lapse, p)| *p *= likelihood(*lapse));
        let total: f64 = self.weighted.iter().map(|(_, p)| p).sum();
        self.weighted.iter_mut().for_each(|(_, p)| *p /= total);
    }
}
