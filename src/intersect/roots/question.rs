//! The question that a ray puts to leaves.

use glam::DVec3;

use super::borders::{at_border, step_towards, trim_reach};
use crate::geometry::RectSide;
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

    /// The place the ray starts at, if it leaves a root of these surfaces.
    pub(super) fn start(&self) -> Option<Start<'a>> {
        let root = self.from?;
        let piece = &self.set.pieces()[root.piece as usize];
        let jet = piece.patch.jet(root.st);
        let cosine = piece.normal(root.st, &jet).map_or(0.0, |normal| normal.dot(self.ray.axis));
        // A quotient that is not a number counts for nothing.
        let error = root.error.min(Root::START_OFF * root.across() / cosine.abs());
        let rounding = piece.patch.error_bound(self.ray.magnitude);
        Some(Start { root, piece, jet, cosine, error, rounding })
    }
}

/// The cosine above which it is clear on which side a ray leaves an edge.
const CLEAR_SIDE: f64 = 1e-4;

/// Two surfaces share a border if it is no farther off, in errors, than both may be.
const SHARED: f64 = 2.0;

/// The root that a ray starts on, seen from another one.
pub(super) struct Start<'a> {
    pub(super) root: &'a Root,
    pub(super) piece: &'a Piece,
    pub(super) jet: Jet,
    /// `N · d`, or 0 without a normal.
    cosine: f64,
    /// How far from the origin, along the ray that starts there, the true root may be: less than
    /// along the ray that found it, if that was grazing.
    pub(super) error: f64,
    /// Error bound of a computed point.
    rounding: f64,
}

/// How a ray goes through two surfaces, or two places of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sense {
    /// In through both, or out through both.
    Same,
    /// In through one, and out through the other.
    Opposite,
    /// It is too flat on one of them to tell.
    Unclear,
}

impl Start<'_> {
    /// How the ray goes through the surface here, compared with a place where `N · d` is `cosine`.
    pub(super) fn sense(&self, cosine: f64) -> Sense {
        if cosine.abs().min(self.cosine.abs()) <= CLEAR_SIDE {
            Sense::Unclear
        } else if cosine * self.cosine > 0.0 {
            Sense::Same
        } else {
            Sense::Opposite
        }
    }

    /// Whether the start is within this distance of a side of its piece.
    pub(super) fn is_at_side(&self, reach: f64) -> bool {
        let distances = self.piece.side_distances(self.root.st, &self.jet);
        distances.into_iter().any(|distance| distance <= reach)
    }

    /// Whether the start is on a border or a trim edge, to within rounding.
    pub(super) fn is_on_edge(&self) -> bool {
        self.is_beside_edge(0.0, self.rounding)
    }

    /// Whether the start may be on a border or a trim edge, if it may be off by `more` than rounding:
    /// on trims, by more than its error.
    pub(super) fn may_be_on_edge(&self, more: f64) -> bool {
        self.is_beside_edge(more, self.root.error + more)
    }

    fn is_beside_edge(&self, more: f64, at_trims: f64) -> bool {
        let Self { root, piece, ref jet, .. } = *self;
        at_border(piece, root.st, jet, self.rounding + more)
            || matches!(piece.side(root.st, trim_reach(jet, at_trims)), Side::Edge { .. })
    }

    /// Whether the surface's border, or a trim edge of it, passes a point near the start within
    /// rounding, to first order: whether an edge that another surface has there may be this one's.
    pub(super) fn has_edge_at(&self, point: DVec3) -> bool {
        let Self { root, piece, ref jet, rounding, .. } = *self;
        let st = root.st + step_towards(jet, point - jet.point);
        if !st.is_finite() {
            return false; // at a pole
        }
        let distances = piece.side_distances(st, jet);
        let mut borders = RectSide::ALL.into_iter().filter(|side| piece.is_border(*side));
        borders.any(|side| distances[side].abs() <= SHARED * rounding)
            || matches!(piece.side(st, trim_reach(jet, rounding)), Side::Edge { .. })
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
