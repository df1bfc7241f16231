//! The human's mind: what a human believes about the kitchen, one categorical distribution per state aspect, and how
//! the human decides.

pub mod belief;
pub mod choice;
pub mod dirichlet;
pub mod filter;
pub mod fitting;
pub mod model;
pub mod observation;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use self::dirichlet::DirichletBelief;
use self::filter::PressEvidence;
use crate::kitchen::{AspectId, Kitchen, State, StateAspect};
pub use choice::ChoiceModel;

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

/// The recorded estimate of the human's belief before one press of the human.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedEstimate {
    /// Sequence number of the press in the log.
    pub press: u64,
    /// ln p(press) under the estimate before the press, in nats.
    pub log_p: f64,
    /// Effective sample size of the belief samples by which the press was evaluated.
    pub effective: f64,
    /// The estimated belief about each state aspect, in the order of the kitchen's aspects.
    pub aspects: Vec<AspectEstimate>,
}

/// The estimated belief about one state aspect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectEstimate {
    /// Name of the state aspect.
    pub aspect: String,
    /// Name of the value with the highest expected probability.
    pub believes: String,
    /// Expected probability that the belief gives to the true value.
    pub p_truth: f64,
    /// The precision of the aspect's Dirichlet: the sum of its alphas.
    pub precision: f64,
    /// Expected probability of every value that has at least [`WORTH_TELLING`].
    pub values: BTreeMap<String, f64>,
}

impl RecordedEstimate {
    /// The record of an estimate before the press with number `press` in `state`, with the evidence of that press.
    pub fn new(
        kitchen: &Kitchen,
        press: u64,
        belief: &DirichletBelief,
        state: State,
        evidence: PressEvidence,
    ) -> RecordedEstimate {
        let of = |(index, aspect): (usize, &StateAspect)| {
            let of_aspect = &belief.aspects[index];
            let values = aspect.labels.iter().zip(of_aspect.mean()).filter(|(_, p)| **p >= WORTH_TELLING);
            AspectEstimate {
                aspect: aspect.name.clone(),
                believes: aspect.labels[of_aspect.most_likely()].clone(),
                p_truth: rounded(belief.p_truth(kitchen, state, AspectId(index as u8))),
                precision: rounded(of_aspect.precision()),
                values: values.map(|(label, &p)| (label.clone(), rounded(p))).collect(),
            }
        };
        RecordedEstimate {
            press,
            log_p: rounded(evidence.log_p),
            effective: rounded(evidence.effective),
            aspects: kitchen.aspects.iter().enumerate().map(of).collect(),
        }
    }
}

/// Rounds to four digits after the point, the precision of recorded estimates.
pub fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
