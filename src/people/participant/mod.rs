//! Simulated participants for tests and simulated studies, with errors of known cause.
//!
//! A simulated participant differs from the assistant's human model: a participant acts on one most probable world,
//! plans by backward chaining, sees only fixated locations, and forgets recipes in steps. A participant knows nothing
//! of the cost to go that drives the assistant and defines errors.

pub mod beliefs;
mod decision;
pub mod eyes;
mod goals;
pub mod hand;
mod looking;
mod planning;
pub mod population;
mod signals;
mod simulated;
mod thinking;
mod witness;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use tomcom_core::base::rng::Stream;

pub use simulated::{ParticipantAction, SimulatedParticipant};

fn normal(random: &mut Stream) -> f64 {
    StandardNormal.sample(random)
}

fn chance(random: &mut Stream, p: f64) -> bool {
    random.random::<f64>() < p
}

/// As [`chance`], but no random number is drawn if `p` is 0, so that a new trait does not change participants without it.
fn rare_chance(random: &mut Stream, p: f64) -> bool {
    p > 0.0 && chance(random, p)
}

/// Draws an index in proportion to these weights, with one random number. `None` if there are no weights, or if
/// rounding leaves a remainder after the last weight.
fn drawn_by_weight(random: &mut Stream, weights: &[f64]) -> Option<usize> {
    let mut left = random.random::<f64>() * weights.iter().sum::<f64>();
    weights.iter().position(|weight| {
        left -= weight;
        left < 0.0
    })
}
