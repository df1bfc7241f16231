//! The parameters of the choice model (see [`super::choice`]).

use serde::{Deserialize, Serialize};

use super::belief::Belief;
use crate::base::rng::Stream;
use crate::kitchen::{Kitchen, WeightedWorlds};

/// Parameters of the choice model (paper, section "Human model").
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChoiceParameters {
    /// Softmax rationality tau, per press: how strongly a lower expected cost to go is preferred.
    pub tau: f64,
    /// The lapse rate: share of presses that are slips.
    pub lapse: f64,
    /// Share of the slips that hit any button at random. The other slips hit the neighbouring button and the look-alike
    /// button with equal probability.
    pub lapse_anywhere: f64,
    /// Cost of waiting instead of pressing, in presses, in the choice model.
    pub wait_cost: f64,
    /// Number of drawn worlds that represent a belief.
    pub cases: usize,
}

impl Default for ChoiceParameters {
    fn default() -> Self {
        ChoiceParameters { tau: 4.0, lapse: 0.03, lapse_anywhere: 0.3, wait_cost: 0.5, cases: 32 }
    }
}

impl ChoiceParameters {
    /// The worlds that represent the human's belief in this choice model.
    pub fn worlds(&self, kitchen: &Kitchen, belief: &Belief, random: &mut Stream) -> WeightedWorlds {
        belief.worlds(kitchen, self.cases.max(1), random)
    }

    /// For a kitchen with `buttons` buttons: the probability that a press slips to one given button, whichever is
    /// intended, and the probability that it slips to the neighbour or, respectively, to the look-alike.
    pub fn slip_probabilities(&self, buttons: usize) -> [f64; 2] {
        [self.lapse * self.lapse_anywhere / buttons as f64, self.lapse * (1.0 - self.lapse_anywhere) / 2.0]
    }

    /// exp(tau Q) relative to the best button, for a button whose cost to go, summed over `draws` draws, is higher by
    /// `more` presses.
    pub fn weight(&self, more: usize, draws: usize) -> f64 {
        (-self.tau * more as f64 / draws as f64).exp()
    }
}
