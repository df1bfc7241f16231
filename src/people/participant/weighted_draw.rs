//! Draws in proportion to weights.

use rand::RngExt;

use tomcom_core::base::rng::Stream;

/// Draws an index in proportion to these weights, with one random number. `None` if there are no weights, or if
/// rounding leaves a remainder after the last weight.
pub(super) fn drawn_by_weight(random: &mut Stream, weights: &[f64]) -> Option<usize> {
    let mut left = random.random::<f64>() * weights.iter().sum::<f64>();
    weights.iter().position(|weight| {
        left -= weight;
        left < 0.0
    })
}
