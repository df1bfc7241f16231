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

#[cfg(test)]
mod tests {
    use super::ones;

    #[test]
    fn every_bit_once_and_in_order() {
        assert_eq!(ones(0).count(), 0);
        assert_eq!(ones(0x8000_0101).collect::<Vec<_>>(), [0, 8, 31]);
        assert_eq!(ones(u32::MAX).count(), 32);
    }
}
