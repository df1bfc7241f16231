//! The parameters of the choice model (see [`super::choice`]).

use serde::{Deserialize, Serialize};

use super::belief::Belief;
use crate::base::rng::Stream;
use crate::kitchen::{Kitchen, WeightedWorlds};

/// The parameters of a decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DecisionModel {
    /// How strictly fewer expected presses are preferred, per press.
    pub tau: f64,
    /// The share of presses that slip.
    pub lapse: f64,
    /// The share of the slips that go to any button; the others go to the neighbour and to the look-alike, evenly.
    pub lapse_anywhere: f64,
    /// What waiting costs, in presses.
    pub wait_cost: f64,
    /// Number of worlds that stand for a belief.
    pub cases: usize,
}

impl Default for DecisionModel {
    fn default() -> Self {
        DecisionModel { tau: 4.0, lapse: 0.03, lapse_anywhere: 0.3, wait_cost: 0.5, cases: 32 }
    }
}

impl DecisionModel {
    /// The worlds that stand for a belief in this model.
    pub fn worlds(&self, kitchen: &Kitchen, belief: &Belief, random: &mut Stream) -> WeightedWorlds {
        belief.worlds(kitchen, self.cases.max(1), random)
    }

    /// The probability that a press slips to one given button of so many, whatever was intended, and that it slips to each of
    /// the two buttons that its own may be taken for.
    pub fn slip_probabilities(&self, buttons: usize) -> [f64; 2] {
        [self.lapse * self.lapse_anywhere / buttons as f64, self.lapse * (1.0 - self.lapse_anywhere) / 2.0]
    }

    /// exp(tau Q) relative to the best button, for a button that takes `more` presses more, summed over `draws` draws.
    pub fn weight(&self, more: usize, draws: usize) -> f64 {
        (-self.tau * more as f64 / draws as f64).exp()
    }
}
