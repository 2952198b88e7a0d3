//! Bits that stand for rays, boxes or sides.

/// The positions of the set bits, the lowest first.
#[inline(always)] // in innermost loops
pub(crate) fn set_bits(bits: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut bits = bits.into();
    std::iter::from_fn(move || {
        let place = (bits != 0).then_some(bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        place
    })
}

/// Whether the bit at a position is set.
#[inline(always)]
pub(crate) fn has(bits: impl Into<u64>, place: usize) -> bool {
    bits.into() >> place & 1 != 0
}

/// The lower (0) or the upper (1) half of sixteen bits.
#[inline(always)]
pub(crate) fn half_of_sixteen(bits: u32, half: usize) -> u64 {
    u64::from(bits >> (8 * half)) & 0xff
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

    #[test]
    fn single_bits_and_halves() {
        assert!(has(6u8, 1) && has(6u32, 2) && !has(6u64, 0) && has(1u64 << 63, 63));
        assert_eq!([0, 1].map(|half| half_of_sixteen(0xab12, half)), [0x12, 0xab]);
    }
}
