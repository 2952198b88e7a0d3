//! Bits that stand for rays, or boxes.

/// The places of the bits that are set, the lowest first.
pub(super) fn set_bits(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (place < u64::BITS).then_some(place as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_bits() {
        let places = |bits: u64| set_bits(bits).collect::<Vec<_>>();
        assert!(places(0).is_empty());
        assert_eq!(places(1 | 1 << 5 | 1 << 63), [0, 5, 63]);
        assert_eq!(places(u64::MAX).len(), 64);
    }
}
