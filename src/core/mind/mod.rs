//! The human's mind: what a human believes about the kitchen, one categorical distribution per state aspect, and how
//! the human decides.

pub mod belief;
pub mod choice;
pub mod choice_parameters;
pub mod dirichlet;
pub mod filter;
pub mod fitting;
pub mod gaze_presence;
pub mod model;
pub mod model_table;
pub mod named_models;
pub mod observation;
pub mod recorded_estimate;
pub mod signal_model;

use std::collections::BTreeMap;

pub use choice::ChoiceModel;
use serde::{Deserialize, Serialize};

/// The recorded belief of a simulated participant at one time, with the reason for its next press.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordedBelief {
    /// The participant's belief about each state aspect, in the order of the kitchen's aspects.
    pub aspects: Vec<AspectBelief>,
    /// Reason for the participant's next press: "as believed", "slip: hit a button nearby, meant cut", …
    pub cause: String,
    /// Origin of the participant's next press, found by repeating the participant's decision with the truth; `None` at
    /// a freeze probe, which leads to no press.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<PressOrigin>,
    /// Names of the aspects whose replacement by the truth changes a press that a false belief caused.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<String>,
}

/// Origin of a press of a simulated participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PressOrigin {
    /// The press comes from the participant's plan (it would be the same with true beliefs), or the display proposed
    /// it.
    Plan,
    /// The press comes from a false belief: with true beliefs the participant would press something else.
    Belief,
    /// The press is a slip: the participant pressed another button than decided.
    Slip,
}

/// A participant's belief about one state aspect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectBelief {
    /// Name of the state aspect.
    pub aspect: String,
    /// Name of the value that the participant believes most probable.
    pub believes: String,
    /// Probability that the participant gives to the aspect's true value.
    pub p_truth: f64,
    /// Probability of every value that has at least [`WORTH_TELLING`]; the remaining probability is spread over the
    /// other values.
    pub values: BTreeMap<String, f64>,
}

/// Least probability of a value that a [`RecordedBelief`] lists.
pub const WORTH_TELLING: f64 = 0.01;
