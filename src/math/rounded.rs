//! Numbers in one, two or four bytes.

use super::rounding;

/// A number not below zero, rounded up: the upper half of an f32. It is larger by less than 1 %.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Up16(u16);

impl Up16 {
    /// The least such number that is not below `x`; infinity for NaN.
    pub(crate) fn above(x: f64) -> Self {
        if x.is_nan() {
            return Self::above(f64::INFINITY);
        }
        let bits = rounding::f32_above(x).to_bits();
        Self(((bits + 0xffff) >> 16) as u16)
    }

    #[inline(always)]
    pub(crate) fn value(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}

/// A number rounded to nearest: the upper half of an f32, with eight binary digits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near16(u16);

impl Near16 {
    pub(crate) fn to(x: f64) -> Self {
        let bits = (x as f32).to_bits();
        Self((bits.saturating_add(0x8000) >> 16) as u16)
    }

    #[inline(always)]
    pub(crate) fn value(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}

/// A number not below zero, rounded up to four digits: zero, or from 1.125 · 2⁻²¹ to 1.75 · 2¹⁰, or
/// infinity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Up8(u8);

impl Up8 {
    /// How much larger the exponent's code is in f32.
    const BIAS: u32 = (127 - 21) << 3;

    /// The least such number that is not below `x`; infinity for NaN.
    pub(crate) fn above(x: f64) -> Self {
        let bits = u32::from(Up16::above(x).0);
        // The upper twelve bits, rounded up, are eight of exponent and three of mantissa, after the
        // sign.
        let code = ((bits + 0xf) >> 4).saturating_sub(Self::BIAS);
        Self(if x == 0.0 { 0 } else { code.clamp(1, 0xff) as u8 })
    }

    #[inline(always)]
    pub(crate) fn value(self) -> f32 {
        match self.0 {
            0 => 0.0,
            0xff => f32::INFINITY,
            code => f32::from_bits((u32::from(code) + Self::BIAS) << 20),
        }
    }
}

/// A number not below zero, rounded up: the upper half of an f64, which keeps its range in less
/// room.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Up32(u32);

impl Up32 {
    pub(crate) fn above(x: f64) -> Self {
        let bits = x.to_bits();
        let cut_off = bits & 0xffff_ffff != 0;
        Self((bits >> 32) as u32 + u32::from(cut_off))
    }

    pub(crate) fn value(self) -> f64 {
        f64::from_bits(u64::from(self.0) << 32)
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
        for x in [0.0, 1.0, 0.1, 3.0, 1e-60, 1e-40, 1e-6, 999.0, 2e3, 1e4, 3.4e38, 1e60] {
            let up = f64::from(Up8::above(x).value());
            assert!(x <= up, "{x}: {up}");
            assert!(up <= 1.126 * x || !(1e-6..1.9e3).contains(&x), "{x}: {up}");
        }
        assert_eq!(Up8::above(0.0).value(), 0.0);
        assert_eq!(Up8::above(f64::NAN).value(), f32::INFINITY);
        assert_eq!(Up8::above(f64::INFINITY).value(), f32::INFINITY);
        for x in [0.0, 1.0, -0.1, 3.3, -1e-30] {
            let near = f64::from(Near16::to(x).value());
            assert!((near - x).abs() <= x.abs() / 256.0, "{x}: {near}");
        }
        assert_eq!(Up16::above(f64::NAN).value(), f32::INFINITY);
        assert_eq!(Up16::above(0.0).value(), 0.0);
    }

    #[test]
    fn longer_numbers_are_not_below() {
        for x in [0.0, 1.0, 0.1, 1.0 / 3.0, 1e70, 3e-70, 1.999_999_999, 5e-324] {
            let up = Up32::above(x).value();
            assert!(x <= up && up <= x * (1.0 + 2e-6) + 1e-300, "{x}: {up}");
        }
    }
}
