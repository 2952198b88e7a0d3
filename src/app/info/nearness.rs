//! How near borders must be to each other to count as nearly meeting.

use super::edges::Edges;

/// Borders farther apart than this share of the larger one of their objects' sizes are apart on
/// purpose: a model of that size is as exact as that.
pub(crate) const NEAR: f64 = 1e-3;

/// Nor is there a gap between borders farther apart than this share of the smaller object's
/// size: a teapot on a large table has no more gaps than without the table.
pub(crate) const NEAR_SMALLER: f64 = 1e-2;

/// Nor do borders nearly meet if they are farther apart than this share of the shorter one's
/// length: at a corner of a small surface all of its borders are near one another.
pub(crate) const NEAR_LENGTH: f64 = 0.05;

/// The largest distance at which borders of objects of these sizes nearly meet.
fn near([a, b]: [f64; 2]) -> f64 {
    (NEAR * a.max(b)).min(NEAR_SMALLER * a.min(b))
}

/// How near curves must be to each other.
pub(super) struct Nearness<'a> {
    edges: &'a Edges<'a>,
    /// Those of the objects of the surfaces.
    sizes: &'a [f64],
    largest: f64,
}

impl<'a> Nearness<'a> {
    pub(super) fn new(edges: &'a Edges<'a>, sizes: &'a [f64]) -> Self {
        let largest = sizes.iter().fold(0.0, |a: f64, &b| a.max(b));
        Self { edges, sizes, largest }
    }

    /// The largest distance at which two curves nearly meet.
    pub(super) fn of(&self, pair: [usize; 2]) -> f64 {
        let [(a, first), (b, second)] = pair.map(|k| &self.edges.curves[k]);
        let shorter = first.length().min(second.length());
        near([self.sizes[a.surface], self.sizes[b.surface]]).min(NEAR_LENGTH * shorter)
    }

    /// The largest distance at which a curve may nearly meet any other: by no more than its length
    /// allows, or every short one would be near thousands.
    pub(super) fn reach(&self, curve: usize) -> f64 {
        let (edge, curve) = &self.edges.curves[curve];
        near([self.sizes[edge.surface], self.largest]).min(NEAR_LENGTH * curve.length())
    }
}
