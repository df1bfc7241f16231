//! What a session file asks of the assistant.

use serde::{Deserialize, Serialize};

use super::concept_name::ConceptName;

/// The assistant: what it advises by, how carefully, and whether it does so beside a wizard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AssistantSpec {
    pub shadow: Shadow,
    pub concept: ConceptName,
    /// What a signal costs, in presses: a signal has to save more than that (1.5 in the paper).
    pub cost_of_communication: f64,
    /// The expected deviation of a belief, as a probability, above which ToM tells the truth.
    pub belief_threshold: f64,
    /// How many presses DEV proposes after an error.
    pub proposed_presses: usize,
    pub rollout: RolloutModel,
}

/// Whether the assistant advises where it does not act.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shadow {
    #[default]
    On,
    Off,
}

impl Default for AssistantSpec {
    fn default() -> Self {
        AssistantSpec {
            shadow: Shadow::On,
            concept: ConceptName::TomCom,
            cost_of_communication: 1.5,
            // Believed wrong, as false belief episodes are defined.
            belief_threshold: 0.5,
            proposed_presses: 1,
            rollout: RolloutModel::default(),
        }
    }
}

/// How far and how often the future is tried out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RolloutModel {
    /// Decisions of the human in a rollout.
    pub horizon: usize,
    /// Rollouts of each signal and of saying nothing, paired by their random numbers; at most so many.
    pub rollouts: usize,
    /// States and recipes drawn from each sample of the belief.
    pub states: usize,
    /// From one press of the human to the next, in seconds.
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
    /// No more rollouts of a signal are made when the standard error of its benefit is at most this, in presses, or at most
    /// twice this where it is clear whether it pays: where the net benefit is off zero by three standard errors.
    pub enough_error: f64,
    /// At least so many are made.
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
    /// What the worth of an option has to exceed to be said, in the concept's unit: presses, of ToM a deviation.
    pub fn price(&self) -> f64 {
        match self.concept {
            ConceptName::Tom => self.belief_threshold,
            ConceptName::TomCom | ConceptName::Dev | ConceptName::None => self.cost_of_communication,
        }
    }
}
