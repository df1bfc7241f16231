//! The parameters of the choice model (see [`super::choice`]).

use super::belief::Belief;
use super::model_table::model_table;
use crate::base::rng::Stream;
use crate::kitchen::{Kitchen, WeightedWorlds};

model_table! {
    /// Parameters of the choice model (paper, section "Human model").
    ChoiceParameters, GivenChoice {
        /// Softmax rationality tau, per press: how strongly a lower expected cost to go is preferred.
        tau: f64,
        /// The lapse rate: share of presses that are slips.
        lapse: f64,
        /// Share of the slips that hit any button at random. The other slips hit the neighbouring button and the
        /// look-alike button with equal probability.
        lapse_anywhere: f64,
        /// Cost of waiting instead of pressing, in presses, in the choice model.
        wait_cost: f64,
        /// Number of drawn worlds that represent a belief.
        cases: usize,
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
