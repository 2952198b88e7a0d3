//! The question that a ray puts to leaves.

use super::borders::{at_border, trim_reach};
use crate::geometry::trim::Side;
use crate::intersect::query::StartIn;
use crate::intersect::{Query, Root};
use crate::math::RayFrame;
use crate::patch::{Jet, Leaf, OrientedBox, Passage, PatchSet, Piece, ScaledFrame};

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

    /// The start of a ray whose `N · d` there has clearly the sign of `cosine`, as where it goes
    /// through another surface of a body in the same sense, in or out.
    pub(super) fn start_in_sense_of(&self, cosine: f64) -> Option<Start<'a>> {
        let root = self.from?;
        let piece = &self.set.pieces()[root.piece as usize];
        let jet = piece.patch.jet(root.st);
        let other = piece.normal(root.st, &jet)?.dot(self.ray.axis);
        let alike = cosine * other > 0.0 && cosine.abs().min(other.abs()) > CLEAR_SIDE;
        let error = root.error.min(START_OFF * root.across() / other.abs());
        let rounding = piece.patch.error_bound(self.ray.magnitude);
        alike.then_some(Start { root, piece, jet, error, rounding })
    }
}

/// The cosine above which it is clear on which side a ray leaves an edge.
const CLEAR_SIDE: f64 = 1e-4;

/// A ray may start as far from the point of a root as twice the root's error (see
/// [`Query::leaving`]), and the point is off by once that.
const START_OFF: f64 = 3.0;

/// The root that a ray starts on, seen from another surface.
pub(super) struct Start<'a> {
    root: &'a Root,
    piece: &'a Piece,
    pub(super) jet: Jet,
    /// How far from the origin, along the ray that starts there, the true root may be: less than
    /// along the ray that found it, if that was grazing.
    pub(super) error: f64,
    /// Error bound of a computed point.
    rounding: f64,
}

impl Start<'_> {
    /// Whether the start is on a border or a trim edge, if it may be off by `more` than rounding: on
    /// trims, by more than its error.
    pub(super) fn is_at_edge(&self, more: f64) -> bool {
        let Self { root, piece, ref jet, .. } = *self;
        let trim_reach = || trim_reach(jet, root.error + more);
        at_border(piece, root.st, jet, self.rounding + more)
            || matches!(piece.side(root.st, trim_reach()), Side::Edge { .. })
    }
}

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
