//! The estimate of a belief as it is written down: short, and in words.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::WORTH_TELLING;
use super::dirichlet::DirichletBelief;
use super::filter::Evidence;
use crate::kitchen::{Aspect, AspectId, Kitchen, State};

/// What was estimated of the human's belief before a press of the human.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimateWitness {
    /// The number of the press in the log.
    pub press: u64,
    /// ln p of that press under the estimate, in nats.
    pub log_p: f64,
    /// The effective number of belief samples behind it.
    pub effective: f64,
    /// One entry per state aspect, in the order of the kitchen's aspects.
    pub aspects: Vec<AspectEstimate>,
}

/// The estimated belief about one aspect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectEstimate {
    pub aspect: String,
    /// The value that is expected to be believed most.
    pub believes: String,
    /// The expected probability of the truth.
    pub p_truth: f64,
    /// The precision of the Dirichlet: the sum of its alphas.
    pub precision: f64,
    /// The expected probability of every value that has at least [`WORTH_TELLING`].
    pub values: BTreeMap<String, f64>,
}

impl EstimateWitness {
    /// What was estimated before a press that met `state`, and how likely the press was then.
    pub fn new(
        kitchen: &Kitchen,
        press: u64,
        belief: &DirichletBelief,
        state: State,
        evidence: Evidence,
    ) -> EstimateWitness {
        let of = |(index, aspect): (usize, &Aspect)| {
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
        EstimateWitness {
            press,
            log_p: rounded(evidence.log_p),
            effective: rounded(evidence.effective),
            aspects: kitchen.aspects.iter().enumerate().map(of).collect(),
        }
    }
}

/// Four digits are enough for an estimate.
pub fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
