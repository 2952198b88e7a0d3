//! The sides of a rectangle of parameters.

use std::ops::{Index, IndexMut};

use glam::DVec2;

use super::Direction;

/// A side of a rectangle of parameters, such as the domain of a surface or the unit square of a
/// Bézier piece: one parameter is fixed at the first or the last of its values, the other runs.
///
/// It is an index into arrays with one entry for each side, in the order of [`Self::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RectSide {
    /// The first `u`; of the unit square, `s = 0`.
    FirstU,
    /// The last `u`; of the unit square, `s = 1`.
    LastU,
    /// The first `v`; of the unit square, `t = 0`.
    FirstV,
    /// The last `v`; of the unit square, `t = 1`.
    LastV,
}

impl RectSide {
    /// All four, in the order in which they are counted.
    pub const ALL: [Self; 4] = [Self::FirstU, Self::LastU, Self::FirstV, Self::LastV];

    /// The sides at which a parameter has the first and the last of its values.
    #[inline(always)]
    pub const fn ends_of(fixed: Direction) -> [Self; 2] {
        match fixed {
            Direction::U => [Self::FirstU, Self::LastU],
            Direction::V => [Self::FirstV, Self::LastV],
        }
    }

    /// The parameter that has one value all along the side.
    #[inline(always)]
    pub const fn fixed(self) -> Direction {
        match self {
            Self::FirstU | Self::LastU => Direction::U,
            Self::FirstV | Self::LastV => Direction::V,
        }
    }

    /// The parameter that runs along the side.
    #[inline(always)]
    pub const fn along(self) -> Direction {
        self.fixed().other()
    }

    /// Whether the fixed parameter has the last of its values, not the first.
    #[inline(always)]
    pub const fn is_last(self) -> bool {
        matches!(self, Self::LastU | Self::LastV)
    }

    /// Which end of its range the fixed parameter is at: 0 or 1.
    #[inline(always)]
    pub const fn end(self) -> usize {
        self.is_last() as usize
    }

    /// The value of the fixed parameter in a rectangle: from and to in `u`, then in `v`.
    #[inline(always)]
    pub fn value_in(self, rect: &[[f64; 2]; 2]) -> f64 {
        rect[self.fixed()][self.end()]
    }

    /// The value of the fixed parameter on the unit square: 0 or 1.
    #[inline(always)]
    pub fn value(self) -> f64 {
        self.end() as f64
    }

    /// The place on this side of the unit square where the running parameter is `t`.
    pub fn place(self, t: f64) -> DVec2 {
        self.fixed().pair(self.value(), t).into()
    }

    /// The place on this side of the unit square with the same running parameter as another place.
    #[inline(always)]
    pub fn beside(self, st: DVec2) -> DVec2 {
        self.place(st[self.along()])
    }

    /// Which control point `(i, j)` of a Bézier net is the `k`-th along this side.
    #[inline(always)]
    pub fn control_point(self, degree: [usize; 2], k: usize) -> [usize; 2] {
        self.fixed().pair(self.end() * degree[self.fixed()], k)
    }

    /// How far a place of the unit square is from each side.
    #[inline(always)]
    pub fn distances(st: DVec2) -> [f64; 4] {
        [st.x, 1.0 - st.x, st.y, 1.0 - st.y]
    }

    /// Whether a rectangle within the unit square reaches this side of it.
    #[inline(always)]
    pub fn is_reached_by(self, rect: &[[f64; 2]; 2]) -> bool {
        self.value_in(rect) == self.value()
    }

    /// A rectangle, which may reach beyond the unit square, made to end at this side of it.
    #[inline(always)]
    pub fn ended_at_it(self, mut rect: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        rect[self.fixed()][self.end()] = self.value();
        rect
    }
}

impl<T> Index<RectSide> for [T; 4] {
    type Output = T;

    #[inline(always)]
    fn index(&self, side: RectSide) -> &T {
        &self[side as usize]
    }
}

impl<T> IndexMut<RectSide> for [T; 4] {
    #[inline(always)]
    fn index_mut(&mut self, side: RectSide) -> &mut T {
        &mut self[side as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_counted_by_parameter_and_end() {
        assert_eq!(RectSide::ALL, Direction::BOTH.map(RectSide::ends_of).as_flattened());
        for (number, side) in RectSide::ALL.into_iter().enumerate() {
            assert_eq!((side as usize, RectSide::ALL[side]), (number, side));
            assert_eq!(RectSide::ends_of(side.fixed())[side.end()], side);
            let place = DVec2::new(0.3, 0.7);
            let on_it = side.beside(place);
            assert_eq!(
                (on_it[side.fixed()], on_it[side.along()]),
                (side.value(), place[side.along()])
            );
            assert_eq!(RectSide::distances(on_it)[side], 0.0);
            let rect = [[0.25, 0.5]; 2];
            assert!(!side.is_reached_by(&rect));
            let rect = side.ended_at_it(rect);
            assert!(side.is_reached_by(&rect));
            assert_eq!((side.value_in(&rect), rect[side.along()]), (side.value(), [0.25, 0.5]));
        }
        assert_eq!(RectSide::FirstU.control_point([2, 3], 1), [0, 1]);
        assert_eq!(RectSide::LastU.control_point([2, 3], 1), [2, 1]);
        assert_eq!(RectSide::FirstV.control_point([2, 3], 1), [1, 0]);
        assert_eq!(RectSide::LastV.control_point([2, 3], 1), [1, 3]);
    }
}
