//! What reports call borders and trim edges.

use std::fmt;

use nurbray::geometry::TriangleSide;

use super::super::border::Border;

/// Which border or trim edge of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Which {
    /// A border of a domain that is a rectangle.
    Border(Border),
    /// A side of a triangle.
    Side(TriangleSide),
    /// A trim edge, from corner to corner, counted from 0.
    Trim(usize),
}

impl fmt::Display for Which {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Border(border) => border.fmt(f),
            Self::Side(TriangleSide::W) => f.write_str("u + v = 1"),
            Self::Side(side) => write!(f, "{side} = 0"),
            Self::Trim(number) => write!(f, "trim edge {number}"),
        }
    }
}
