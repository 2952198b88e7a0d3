//! The question that a ray puts to leaves.

use glam::DVec3;

use super::borders::{at_border, trim_reach};
use crate::geometry::trim::Side;
use crate::intersect::hit::StartIn;
use crate::intersect::{Query, Root};
use crate::math::RayFrame;
use crate::patch::{Leaf, OrientedBox, Passage, PatchSet, Piece, ScaledFrame};

/// Everything a search of leaves needs to know about a query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<'a> {
    pub set: &'a PatchSet,
    pub ray: &'a RayFrame,
    pub t_range: [f64; 2],
    pub from: Option<&'a Root>,
    /// Whether all hits are wanted: then a root just beyond a trim edge, which another search may
    /// have found at the edge, is doubtful.
    pub all_hits: bool,
}

impl<'a> Question<'a> {
    /// A query about these pieces; `ray` is its frame.
    pub(crate) fn new(set: &'a PatchSet, query: &'a Query, ray: &'a RayFrame) -> Self {
        let t_range = [query.ray.t_min(), query.ray.t_max()];
        Self { set, ray, t_range, from: query.start_in(set), all_hits: false }
    }

    /// The root the ray starts on, and its piece, if it lies on that surface.
    pub(super) fn start_on(&self, surface: u32) -> Option<(&'a Root, &'a Piece)> {
        let root = self.from?;
        let piece = &self.set.pieces()[root.piece as usize];
        (piece.surface == surface).then_some((root, piece))
    }

    /// Whether the crossing of an edge at `point` is that of the edge, of another surface, which
    /// the ray starts on: at the same place, to within both error bounds, and with the same sign of
    /// `N · d`, as in [`crossings`](crate::intersect::crossings).
    ///
    /// The start counts as on an edge if it is as near to one as both may be off: the ray crosses
    /// one of the two surfaces beside the edge that they share, by rounding perhaps both.
    pub(super) fn starts_on_edge_at(&self, point: DVec3, cosine: f64, z_error: f64) -> bool {
        let Some(root) = self.from else { return false };
        let piece = &self.set.pieces()[root.piece as usize];
        let jet = piece.patch.jet(root.st);
        let off = z_error + root.error;
        let near = point.distance(jet.point) <= 2.0 * off;
        let edge = || {
            at_border(piece, root.st, &jet, piece.patch.error_bound(self.ray.magnitude) + off)
                || matches!(piece.side(root.st, trim_reach(&jet, off)), Side::Edge { .. })
        };
        let same_side = || {
            let other = piece.normal(root.st, &jet).map_or(0.0, |normal| normal.dot(self.ray.axis));
            cosine * other > 0.0 && cosine.abs().min(other.abs()) > CLEAR_SIDE
        };
        near && edge() && same_side()
    }
}

/// The cosine above which it is clear on which side a ray leaves an edge.
const CLEAR_SIDE: f64 = 1e-4;

/// A leaf, with its box and its piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedLeaf<'a> {
    pub leaf: &'a Leaf,
    pub oriented: &'a OrientedBox,
    pub piece: &'a Piece,
}

impl PlacedLeaf<'_> {
    /// The ray's passage through the leaf's box, if the ray may meet the leaf, to within rounding,
    /// between the start of its range and `limit`, both in scene units along the ray.
    pub(crate) fn passage(
        &self,
        ray: &RayFrame,
        scaled: &ScaledFrame,
        limit: f64,
    ) -> Option<Passage> {
        let slack = self.piece.patch.error_bound(ray.magnitude);
        let passage = self.oriented.passage(ray, scaled, slack)?;
        let apart = passage.entry > limit + slack || passage.exit < ray.z_range[0] - slack;
        (!apart).then_some(passage)
    }
}
