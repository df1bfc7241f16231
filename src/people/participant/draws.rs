//! Random draws of simulated participants: whether something happens, and normal deviations.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use tomcom_core::base::rng::Stream;

/// A draw from the standard normal distribution.
pub(super) fn normal(random: &mut Stream) -> f64 {
    StandardNormal.sample(random)
}

/// Draws whether an event with probability `p` happens.
pub(super) fn chance(random: &mut Stream, p: f64) -> bool {
    random.random::<f64>() < p
}

/// Draws whether an event with probability `p` happens. If `p` is 0 no random number is drawn, so that a new trait does
/// not change participants without the trait.
pub(super) fn rare_chance(random: &mut Stream, p: f64) -> bool {
    p > 0.0 && chance(random, p)
}
