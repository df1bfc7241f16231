//! Bit sets: sets of small integers, one bit per integer.

/// The positions of the set bits, in ascending order.
#[inline]
pub fn ones(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let position = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (position < u32::BITS).then_some(position as usize)
    })
}
