//! Bounds in two bytes.

use crate::math::rounding;

/// A number not below zero, rounded up: the upper half of an f32. It is larger by less than 1 %.
#[derive(Clone, Copy, Debug)]
pub(super) struct Up16(u16);

impl Up16 {
    /// The least such number that is not below `x`; infinity for NaN.
    pub(super) fn above(x: f64) -> Self {
        if x.is_nan() {
            return Self::above(f64::INFINITY);
        }
        let bits = rounding::f32_above(x).to_bits();
        Self(((bits + 0xffff) >> 16) as u16)
    }

    #[inline(always)]
    pub(super) fn value(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_not_below() {
        for x in [0.0, 1.0, 0.1, 3.0, 1e-60, 1e-40, 1e-38, 7e37, 3.4e38, 1e60, f64::INFINITY] {
            let up = f64::from(Up16::above(x).value());
            assert!(x <= up, "{x}: {up}");
            assert!(up <= 1.008 * x || !(1e-37..3.3e38).contains(&x), "{x}: {up}");
        }
        assert_eq!(Up16::above(f64::NAN).value(), f32::INFINITY);
        assert_eq!(Up16::above(0.0).value(), 0.0);
    }
}
