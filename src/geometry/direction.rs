//! The two parameters of a surface.

use std::fmt;
use std::ops::{Index, IndexMut};

use glam::DVec2;

/// One of the two parameters of a surface; of a Bézier piece on its unit square, `s` is the first
/// and `t` the second.
///
/// It is an index into pairs with one entry for each parameter:
///
/// ```
/// use glam::DVec2;
/// use nurbray::geometry::{Direction, shapes};
///
/// let cylinder = shapes::cylinder(1.0, 2.0)?;
/// let [start, end] = cylinder.domain()[Direction::V];
/// let mut middle = DVec2::ZERO;
/// middle[Direction::V] = 0.5 * (start + end);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Direction {
    /// The first parameter; it runs along the columns of the control net.
    U,
    /// The second parameter; it runs along the rows of the control net.
    V,
}

impl Direction {
    /// Both, in order.
    pub const BOTH: [Self; 2] = [Self::U, Self::V];

    /// The other parameter.
    #[inline(always)]
    pub const fn other(self) -> Self {
        match self {
            Self::U => Self::V,
            Self::V => Self::U,
        }
    }

    /// A pair of which one entry belongs to this parameter, and one to the other.
    #[inline(always)]
    pub fn pair<T>(self, own: T, others: T) -> [T; 2] {
        match self {
            Self::U => [own, others],
            Self::V => [others, own],
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U => "u",
            Self::V => "v",
        })
    }
}

impl<T> Index<Direction> for [T; 2] {
    type Output = T;

    #[inline(always)]
    fn index(&self, direction: Direction) -> &T {
        &self[direction as usize]
    }
}

impl<T> IndexMut<Direction> for [T; 2] {
    #[inline(always)]
    fn index_mut(&mut self, direction: Direction) -> &mut T {
        &mut self[direction as usize]
    }
}

impl Index<Direction> for DVec2 {
    type Output = f64;

    #[inline(always)]
    fn index(&self, direction: Direction) -> &f64 {
        &self[direction as usize]
    }
}

impl IndexMut<Direction> for DVec2 {
    #[inline(always)]
    fn index_mut(&mut self, direction: Direction) -> &mut f64 {
        &mut self[direction as usize]
    }
}
