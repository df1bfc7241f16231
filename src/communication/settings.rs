//! Settings of the assistant in a session file.

use serde::{Deserialize, Serialize};

use super::concept_name::ConceptName;
use crate::mind::model::LookingModel;

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
    /// Whether it is also asked when the human has not pressed for unusually long (`human_waits`).
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub asks_in_silence: bool,
    /// Whether it is also asked when, by the gaze alone, the human seems to believe something wrong (`seems_unaware`).
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub asks_by_gaze: bool,
    /// Whether the assistant of a live session works ahead between requests for advice, which makes its answers come sooner, and
    /// changes nothing else. Recordings name it only where it is off.
    #[serde(skip_serializing_if = "Clone::clone")]
    pub works_ahead: bool,
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
            asks_in_silence: false,
            asks_by_gaze: false,
            works_ahead: true,
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
    /// Looks a second in rollouts, where they are not to be those of the human model: see [`LookingModel`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks_hz: Option<f64>,
    /// The same at places that the next press does not need.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_looks_hz: Option<f64>,
    /// The same of the share of changes by others that draw the eye at once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capture: Option<f64>,
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
            looks_hz: None,
            other_looks_hz: None,
            capture: None,
            enough_error: 0.08,
            least_rollouts: 32,
        }
    }
}

impl RolloutModel {
    /// Where the human looks in rollouts: as its model says, or as the settings of the rollouts say.
    pub fn looking(&self, human: &LookingModel) -> LookingModel {
        LookingModel {
            looks_hz: self.looks_hz.unwrap_or(human.looks_hz),
            other_looks_hz: self.other_looks_hz.unwrap_or(human.other_looks_hz),
            capture: self.capture.unwrap_or(human.capture),
            ..human.clone()
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

    /// The parameter by which the concept is compared: the cost of communication, ToM's threshold, or the number of presses that DEV proposes.
    pub fn parameter(&self) -> f64 {
        match self.concept {
            ConceptName::Dev => self.proposed_presses as f64,
            ConceptName::TomCom | ConceptName::Tom | ConceptName::None => self.price(),
        }
    }
}
