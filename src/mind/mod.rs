//! The mind: what a human believes about the kitchen, one categorical distribution per state aspect, and how it decides.

pub mod belief;
pub mod choice;
pub mod decision;
pub mod dirichlet;
pub mod filter;
pub mod fitting;
pub mod model;
pub mod observation;
pub mod reference;
pub mod witness;

use std::collections::BTreeMap;

pub use choice::ChoiceModel;
use serde::{Deserialize, Serialize};

/// What a simulated participant believes at a moment, and why it presses what it presses next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeliefWitness {
    /// One entry per state aspect, in the order of the kitchen's aspects.
    pub aspects: Vec<AspectBelief>,
    /// Why it presses what it presses next: "as believed", "slip to the neighbouring button", …
    pub cause: String,
}

/// A participant's belief about one aspect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AspectBelief {
    pub aspect: String,
    /// The value that it holds most likely.
    pub believes: String,
    /// The probability that it gives to the truth.
    pub p_truth: f64,
    /// The probability of every value that has at least [`WORTH_TELLING`]; what is left is spread over the others.
    pub values: BTreeMap<String, f64>,
}

/// Less likely values are not told one by one in a [`BeliefWitness`].
pub const WORTH_TELLING: f64 = 0.01;
