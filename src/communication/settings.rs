//! Settings of the assistant in a session file.

use serde::{Deserialize, Serialize};

use super::concept_name::ConceptName;

/// Settings of the assistant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AssistantSpec {
    /// Whether it advises in trials in which it does not act.
    pub shadow: Shadow,
    /// The communication concept that decides.
    pub concept: ConceptName,
    /// Cost of communication in presses: the expected saving of a signal must exceed it (1.5 in the paper).
    pub cost_of_communication: f64,
    /// Expected belief deviation, a probability, above which ToM sends a signal.
    pub belief_threshold: f64,
    /// Number of presses that DEV proposes after an error.
    pub proposed_presses: usize,
    /// How finely the planner computes.
    pub rollout: RolloutModel,
}

/// Whether the assistant computes recommendations in conditions in which it does not send signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shadow {
    /// It computes recommendations beside the wizard, who may see them.
    #[default]
    On,
    /// It computes nothing where it does not act.
    Off,
}

impl Default for AssistantSpec {
    fn default() -> Self {
        AssistantSpec {
            shadow: Shadow::On,
            concept: ConceptName::TomCom,
            cost_of_communication: 1.5,
            // The definition of a false belief.
            belief_threshold: 0.5,
            proposed_presses: 1,
            rollout: RolloutModel::default(),
        }
    }
}

/// Settings of the planner's rollouts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RolloutModel {
    /// Number of human decisions in a rollout (horizon).
    pub horizon: usize,
    /// Largest number of paired rollouts per signal.
    pub rollouts: usize,
    /// Number of worlds drawn from each belief sample.
    pub states: usize,
    /// Time between presses of the human, in seconds.
    pub human_press_s: f64,
    /// Looks a second at each place that the next press needs; before something is fetched, also at the robot's hand, which
    /// may be bringing it. Measured on unassisted simulated participants: 1.1 and 0.7.
    pub looks_hz: f64,
    /// Looks a second at each other place; none, as long as nobody has measured them. Unassisted simulated participants look
    /// 0.25 to 0.4 times a second at what has changed more than a second ago and was not seen since.
    pub other_looks_hz: f64,
    /// Share of the changes by others that draw the eye at once; none, as long as nobody has measured it. Of simulated
    /// participants, beyond those looks: 0.3 at the robot's hand and at places, 0.4 at orders.
    pub capture: f64,
    /// Rollouts of a signal end when the standard error of its benefit is at most this, in presses, or at most twice this if the net
    /// benefit differs from zero by three standard errors.
    pub enough_error: f64,
    /// Least number of paired rollouts per signal.
    pub least_rollouts: usize,
}

impl Default for RolloutModel {
    fn default() -> Self {
        RolloutModel {
            horizon: 8,
            rollouts: 256,
            states: 32,
            human_press_s: 2.0,
            looks_hz: 1.0,
            other_looks_hz: 0.0,
            capture: 0.0,
            enough_error: 0.08,
            least_rollouts: 32,
        }
    }
}

impl AssistantSpec {
    /// The value that an option's benefit must exceed: the cost of communication in presses, or ToM's threshold.
    pub fn price(&self) -> f64 {
        match self.concept {
            ConceptName::Tom => self.belief_threshold,
            ConceptName::TomCom | ConceptName::Dev | ConceptName::None => self.cost_of_communication,
        }
    }
}
