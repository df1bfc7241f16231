//! The mind: what a human believes about the kitchen, one categorical distribution per state aspect, and how it decides.

pub mod belief;
pub mod choice;
pub mod choice_parameters;
pub mod dirichlet;
pub mod filter;
pub mod fitting;
pub mod gaze_presence;
pub mod lapse_posterior;
pub mod model;
pub mod observation;
pub mod recorded_estimate;
pub mod reference;
pub mod signal_model;

use std::collections::BTreeMap;

pub use choice::ChoiceModel;
use serde::{Deserialize, Serialize};

/// The recorded belief of a simulated participant at one time, with the reason for its next press.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeliefWitness {
    /// One entry per state aspect, in the order of the kitchen's aspects.
    pub aspects: Vec<AspectBelief>,
    /// Reason for its next press: "as believed", "slip to the neighbouring button", …
    pub cause: String,
    /// Where its next press comes from, by its own decision repeated with the truth; `None` in recordings before version 0.2.0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<PressOrigin>,
    /// Names of the aspects whose replacement by the truth changes a press that comes from a false belief.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<String>,
}

/// Where a press of a simulated participant comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PressOrigin {
    /// From its plan: with the truth it would press the same; or it was proposed on the display.
    Plan,
    /// From a false belief: with the truth it would press something else.
    Belief,
    /// It pressed something else than it decided to.
    Slip,
}

/// A participant's belief about one aspect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectBelief {
    /// The aspect's name.
    pub aspect: String,
    /// Name of the most probable value.
    pub believes: String,
    /// Probability of the true value.
    pub p_truth: f64,
    /// Probability of every value with at least [`WORTH_TELLING`]; the remaining probability is spread over the other values.
    pub values: BTreeMap<String, f64>,
}

/// Least probability of a value that a [`BeliefWitness`] lists.
pub const WORTH_TELLING: f64 = 0.01;
