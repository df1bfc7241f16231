//! The estimate of the human's belief as recordings contain it: rounded numbers, and names of values.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::WORTH_TELLING;
use super::dirichlet::DirichletBelief;
use super::filter::PressEvidence;
use crate::kitchen::{AspectId, Kitchen, State, StateAspect};

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
