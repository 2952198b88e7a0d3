//! Numbers of twice the digits of f64: the truth must be more exact than what is judged.

use std::ops::{Add, Mul, Neg, Sub};

/// The unevaluated sum of two f64, the second at most half a last digit of the first: about
/// 32 decimal digits (Dekker 1971; Hida, Li & Bailey 2001).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// The exact sum of two numbers (Knuth).
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    /// The nearest f64.
    pub(crate) fn round(self) -> f64 {
        self.high
    }

    pub(crate) fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// The quotient, to twice the digits: one step of Newton's iteration from that of f64.
    pub(crate) fn over(self, divisor: Self) -> Self {
        let first = self.high / divisor.high;
        let rest = self - divisor * Self::from(first);
        Self::sum(first, rest.high / divisor.high)
    }
}

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let once = Self::sum(high.high, high.low + low.high);
        Self::sum(once.high, once.low + low.low)
    }
}

impl Neg for Double {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let rest = self.high.mul_add(other.high, -high);
        Self::sum(high, rest + (self.high * other.low + self.low * other.high))
    }
}

impl Mul<f64> for Double {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self * Self::from(factor)
    }
}

#[test]
fn has_twice_the_digits() {
    // (1 + 2⁻⁶⁰)² − 1 = 2⁻⁵⁹ + 2⁻¹²⁰, of which f64 sees nothing.
    let small = f64::powi(2.0, -60);
    let x = Double::from(1.0) + Double::from(small);
    let rest = x * x - Double::from(1.0);
    assert_eq!(rest.round(), 2.0 * small);
    let third = Double::from(1.0).over(Double::from(3.0));
    let off = third * Double::from(3.0) - Double::from(1.0);
    assert!(off.abs().round() < 1e-31);
}
