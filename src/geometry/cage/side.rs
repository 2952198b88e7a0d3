//! Sides of patches of a limit surface, on lines of the cage.

use crate::geometry::{Direction, RectSide};

/// A line on the cage along which patches lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Line {
    /// An edge of the cage, directed from the vertex of its first corner.
    Edge(u32),
    /// From the middle of the edge that leaves a corner to the middle of the face.
    Spoke(u32),
    /// A line inside a unit square: the constant parameter, and the bits of its value.
    Inside { unit: u32, fixed: Direction, at: u64 },
}

/// The number of a side among those of all patches: four times that of the patch, and the place of
/// the side in [`RectSide::ALL`].
pub(super) type SideNumber = u32;

/// A side of a patch on its line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) line: Line,
    /// Where the side begins and ends on the line.
    pub(super) from: f64,
    pub(super) to: f64,
    /// Whether the patch's parameter runs against the line.
    pub(super) reversed: bool,
    /// Its length relative to the side of a quad; squares of other faces are half as large.
    pub(super) length: f64,
    /// When it is settled: long ones first, as [`seams`](super::seams) says.
    pub(super) rank: f64,
    pub(super) exact: bool,
    pub(super) patch: usize,
    /// Which of the patch's.
    pub(super) which: RectSide,
}
