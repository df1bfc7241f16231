//! What was known right before a press: what the participant believed, and what an estimate said of it.

use super::sequences::FALSE_BELOW;
use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::witness::EstimateWitness;

/// What was known right before a press of the human.
#[derive(Clone, Debug, PartialEq)]
pub struct PressView {
    /// The state that the press met, and the button.
    pub state: State,
    pub button: ButtonId,
    /// The participant's own P(truth) of each aspect; `None` where nobody knows, as with people.
    pub held: Option<Vec<f64>>,
    /// The estimate before the press; `None` where nothing estimates.
    pub estimate: Option<EstimateView>,
    /// For each location whether somebody else changed it since the human last looked at it: all that the baseline knows.
    pub unseen_change: Vec<bool>,
    /// The false aspects that this press, if it was an error, is put down to.
    pub errs_about: Vec<AspectId>,
}

/// What an estimate says before a press.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateView {
    /// For each aspect the expected share of the belief that is not on the truth. People hold point-like beliefs, so this
    /// is also the probability that the participant's own P(truth) is below 0.5.
    pub p_wrong: Vec<f64>,
    /// The log of the probability of the press, given that one is made, in nats.
    pub log_p: f64,
}

impl EstimateView {
    /// Of an estimate as it is written down.
    pub fn from_witness(witness: &EstimateWitness) -> EstimateView {
        let p_wrong = witness.aspects.iter().map(|aspect| 1.0 - aspect.p_truth);
        EstimateView { p_wrong: p_wrong.collect(), log_p: witness.log_p }
    }
}

/// The presses of one trial, in their order.
pub type TrialView = Vec<PressView>;

impl PressView {
    /// Whether an aspect is believed wrong; `None` where nobody knows.
    pub fn is_wrong(&self, aspect: usize) -> Option<bool> {
        self.held.as_ref().map(|held| held[aspect] < FALSE_BELOW)
    }
}
