//! Trims as written: loops of curves in a surface's (u, v).

use std::fmt;

use glam::DVec2;

use super::{CurveSpec, Place};
use crate::geometry::trim::Kept;

/// Which part of a surface is kept, as written.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimSpec {
    /// Where it was written.
    pub place: Place,
    /// Which side of the loops stays.
    pub kept: Kept,
    /// The loops.
    pub loops: Vec<LoopSpec>,
}

/// A closed loop as written.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopSpec {
    /// Where it was written.
    pub place: Place,
    /// What it is.
    pub kind: LoopKind,
    /// What its file says it is; the number of loops around it must agree.
    pub sense: Option<LoopSense>,
}

/// What a loop is said to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopSense {
    /// The region inside the loop is kept.
    Outline,
    /// The region inside the loop is cut off.
    Hole,
}

impl fmt::Display for LoopSense {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Outline => "an outline",
            Self::Hole => "a hole",
        })
    }
}

/// The kinds of loops an author can write.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoopKind {
    /// Straight lines from corner to corner, and back to the first.
    Polygon(Vec<DVec2>),
    /// A circle in (u, v).
    Circle {
        /// Its middle.
        center: DVec2,
        /// Its radius.
        radius: f64,
    },
    /// Curves in the plane z = 0, whose x and y are u and v, each from where the one before it
    /// ends, the last one to where the first begins.
    Curves(Vec<CurveSpec>),
}
