//! Bits that stand for rays, or boxes.

/// The positions of the set bits, the lowest first.
#[inline(always)] // in innermost loops
pub(super) fn set_bits(bits: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut bits = bits.into();
    std::iter::from_fn(move || {
        let place = (bits != 0).then_some(bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        place
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_bits() {
        let places = |bits: u64| set_bits(bits).collect::<Vec<_>>();
        assert!(places(0).is_empty());
        assert_eq!(set_bits(6u32).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(places(1 | 1 << 5 | 1 << 63), [0, 5, 63]);
        assert_eq!(places(u64::MAX).len(), 64);
    }
}
