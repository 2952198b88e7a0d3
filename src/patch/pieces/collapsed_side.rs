//! Sides of a unit square that a surface maps to a point.

use glam::DVec2;

use crate::patch::StRect;

/// Which side of a rectangle is collapsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CollapsedSide {
    /// `s` is constant: 0 or 1 tells which end.
    S(usize),
    /// `t` is constant: 0 or 1 tells which end.
    T(usize),
}

impl CollapsedSide {
    /// All four, in the order in which sides are counted.
    pub const ALL: [Self; 4] = [Self::S(0), Self::S(1), Self::T(0), Self::T(1)];

    /// Which parameter is constant: 0 for `s`, 1 for `t`.
    pub fn parameter(self) -> usize {
        match self {
            Self::S(_) => 0,
            Self::T(_) => 1,
        }
    }

    /// The value of the constant parameter: 0 or 1.
    pub fn end(self) -> usize {
        match self {
            Self::S(end) | Self::T(end) => end,
        }
    }

    /// Its index among [all](Self::ALL).
    pub fn number(self) -> usize {
        2 * self.parameter() + self.end()
    }

    /// Whether a rectangle within the unit square reaches this side.
    pub fn is_reached_by(self, rect: &StRect) -> bool {
        rect[self.parameter()][self.end()] == self.end() as f64
    }

    /// A rectangle, or range of parameters, made to end at this side.
    #[inline(always)]
    pub(in crate::patch) fn ended_at_it(self, [s, t]: StRect) -> StRect {
        match self {
            Self::S(0) => [[0.0, s[1]], t],
            Self::S(_) => [[s[0], 1.0], t],
            Self::T(0) => [s, [0.0, t[1]]],
            Self::T(_) => [s, [t[0], 1.0]],
        }
    }

    /// The point of this side that is beside a place: all points of the side are the same in space.
    pub fn beside(self, mut st: DVec2) -> DVec2 {
        st[self.parameter()] = self.end() as f64;
        st
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_counted_by_parameter_and_end() {
        for (number, side) in CollapsedSide::ALL.into_iter().enumerate() {
            assert_eq!(side.number(), number);
            let on_it = side.beside(DVec2::new(0.3, 0.7));
            let kept = 1 - side.parameter();
            assert_eq!(on_it[kept], [0.3, 0.7][kept]);
            let rect = [[0.25, 0.5]; 2];
            assert!(!side.is_reached_by(&rect));
            let rect = side.ended_at_it(rect);
            assert!(side.is_reached_by(&rect));
            assert_eq!(rect[side.parameter()][side.end()], on_it[side.parameter()]);
            assert_eq!(rect[kept], [0.25, 0.5]);
        }
    }
}
