//! What else is known about a hit.

use std::fmt;
use std::ops::{BitOr, BitOrAssign};

use crate::math::bits::has;

/// Facts about a hit, one bit each; the numbers are the `flags` column of `cast`.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct HitFlags(u8);

impl HitFlags {
    /// No facts.
    pub const NONE: Self = Self(0);
    /// Floating point could not decide the answer.
    pub const DOUBTFUL: Self = Self(1);
    /// The hit lies on the border of the surface's domain, to within rounding.
    pub const BORDER: Self = Self(2);
    /// The surface has no normal here.
    pub const NO_NORMAL: Self = Self(4);
    /// The hit lies on a trim edge, to within rounding. Sides of loops along the border or the seam
    /// of a surface are only [`BORDER`](Self::BORDER)s.
    pub const TRIM_EDGE: Self = Self(8);
    /// The ray runs in the surface itself, as in a plane or along a line of a cylinder, and the hit is
    /// an end of that stretch. (This says nothing of the inside of a body.)
    pub const INSIDE: Self = Self(16);

    /// The names of the bits, the lowest first.
    const NAMES: [&str; 5] = ["DOUBTFUL", "BORDER", "NO_NORMAL", "TRIM_EDGE", "INSIDE"];

    /// Whether every bit of `other` is set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// These bits and those of `other`.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// These bits except those of `other`.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Sets the bits of `other`.
    pub fn insert(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// The bits as a number.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The flags with these bits; `None` if one of them has no meaning.
    pub fn from_bits(bits: u8) -> Option<Self> {
        (bits >> Self::NAMES.len() == 0).then_some(Self(bits))
    }

    /// Whether no bit is set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl BitOr for HitFlags {
    type Output = Self;

    /// As [`HitFlags::with`].
    fn bitor(self, other: Self) -> Self {
        self.with(other)
    }
}

impl BitOrAssign for HitFlags {
    /// As [`HitFlags::insert`].
    fn bitor_assign(&mut self, other: Self) {
        self.insert(other);
    }
}

/// The names of the bits, as `BORDER | TRIM_EDGE`, or `NONE`.
impl fmt::Display for HitFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let set = Self::NAMES.iter().enumerate().filter(|&(bit, _)| has(self.0, bit));
        let names: Vec<_> = set.map(|(_, name)| *name).collect();
        f.pad(&if names.is_empty() { "NONE".into() } else { names.join(" | ") })
    }
}

impl fmt::Debug for HitFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "HitFlags({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_shown_by_name() {
        let shown = |flags: HitFlags| format!("{flags:?}");
        assert_eq!(shown(HitFlags::NONE), "HitFlags(NONE)");
        assert_eq!(shown(HitFlags::BORDER), "HitFlags(BORDER)");
        assert_eq!(shown(HitFlags::NO_NORMAL), "HitFlags(NO_NORMAL)");
        assert_eq!(shown(HitFlags::INSIDE), "HitFlags(INSIDE)");
        let both = HitFlags::TRIM_EDGE.with(HitFlags::DOUBTFUL);
        assert_eq!(shown(both), "HitFlags(DOUBTFUL | TRIM_EDGE)");
        let all = [HitFlags::BORDER, HitFlags::NO_NORMAL, HitFlags::INSIDE].into_iter();
        assert_eq!(shown(all.fold(both, HitFlags::with)).matches('|').count(), 4);
        assert_eq!(both.to_string(), "DOUBTFUL | TRIM_EDGE");
        assert_eq!(format!("{:>6}|", HitFlags::NONE), "  NONE|");
    }

    #[test]
    fn flags_are_their_bits() {
        for bits in 0..32 {
            assert_eq!(HitFlags::from_bits(bits).unwrap().bits(), bits);
        }
        assert_eq!(HitFlags::from_bits(32), None);
        assert_eq!(HitFlags::from_bits(129), None);
        let mut flags = HitFlags::BORDER | HitFlags::INSIDE;
        assert_eq!(flags.bits(), 18);
        flags |= HitFlags::DOUBTFUL;
        assert_eq!(flags.bits(), 19);
    }
}
