//! Sets of bits, the beta distribution, and the curve of a motion.

use statrs::function::beta::beta_reg;

/// The positions of the set bits, in ascending order.
#[inline]
pub fn ones(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let position = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (position < u32::BITS).then_some(position as usize)
    })
}

/// Share of the way that a motion has covered after this share of its time, where its speed and acceleration begin and end
/// at 0: the quintic polynomial from 0 to 1, which also has the smallest jerk.
pub fn eased(share: f64) -> f64 {
    share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
}

/// I_x(a, b): the probability that a variate of the beta distribution with parameters `a` and `b` is at most `x`, between
/// 0 and 1. With `a` = 0 the variate is 0, with `b` = 0 it is 1.
pub fn regularized_incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    match () {
        () if a <= 0.0 => 1.0,
        () if b <= 0.0 => 0.0,
        () => beta_reg(a, b, x),
    }
}
