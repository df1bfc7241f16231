//! Belief and estimate directly before a press, the unit of the check of the belief estimate.

use super::sequences::FALSE_BELOW;
use crate::base::incomplete_beta::regularized_incomplete_beta;
use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::recorded_estimate::RecordedEstimate;

/// The participant's belief and its estimate directly before a press of the human.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefsBeforePress {
    /// State of the kitchen before the press.
    pub state: State,
    /// The pressed button, as an index into the human's buttons.
    pub button: ButtonId,
    /// The participant's own P(truth) of each aspect; `None` where this belief is not known, as for people.
    pub held: Option<Vec<f64>>,
    /// The estimate of the participant's belief before the press, if there is one.
    pub estimate: Option<EstimateBeforePress>,
    /// For each location, whether somebody else changed the location since the human last looked at it: the input of
    /// the baseline.
    pub unseen_change: Vec<bool>,
    /// For each location, the time since somebody other than the human last changed the location, in seconds; `None` if
    /// the human changed the location later, or nobody changed it.
    pub since_change_s: Vec<Option<f64>>,
    /// The aspects about which a false belief caused the press, if the press was an error.
    pub errs_about: Vec<AspectId>,
}

/// An estimate of the human's belief before a press.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateBeforePress {
    /// For each aspect, the probability that the participant's own P(truth) is below [`FALSE_BELOW`], by the marginal
    /// of the Dirichlet: I_.5(alpha_truth, A - alpha_truth), with A the sum of the alphas. Detection, flags and
    /// calibration judge this predicted probability.
    pub p_false: Vec<f64>,
    /// The log probability of the press under the estimate, given that a button is pressed, in nats.
    pub log_p: f64,
}

impl EstimateBeforePress {
    /// The estimate before a press, from an estimate that a recording contains.
    pub fn from_witness(witness: &RecordedEstimate) -> EstimateBeforePress {
        let p_false = witness.aspects.iter().map(|aspect| {
            let [of_truth, of_others] = [aspect.p_truth, 1.0 - aspect.p_truth].map(|mean| mean * aspect.precision);
            regularized_incomplete_beta(FALSE_BELOW, of_truth, of_others)
        });
        EstimateBeforePress { p_false: p_false.collect(), log_p: witness.log_p }
    }
}

/// The presses of one trial with the human's beliefs and their estimates, in order of time.
pub type TrialBeliefs = Vec<BeliefsBeforePress>;

impl BeliefsBeforePress {
    /// Whether the participant's belief about an aspect is false; `None` where the belief is not known.
    pub fn is_wrong(&self, aspect: usize) -> Option<bool> {
        self.held.as_ref().map(|held| held[aspect] < FALSE_BELOW)
    }

    /// The predicted probability that the participant's belief about an aspect is false; `None` without an estimate.
    pub fn p_false(&self, aspect: usize) -> Option<f64> {
        self.estimate.as_ref().map(|estimate| estimate.p_false[aspect])
    }
}
