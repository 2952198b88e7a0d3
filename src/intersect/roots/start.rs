//! The root that a ray leaves, seen from other roots.

use glam::{DVec2, DVec3};

use super::around::{Turn, edges_within};
use super::borders::at_border;
use super::reach::{step_towards, trim_reach};
use super::spot::Spot;
use crate::geometry::RectSide;
use crate::geometry::trim::Side;
use crate::intersect::Root;
use crate::math::RayFrame;
use crate::patch::{Jet, PatchSet, Piece};

/// The cosine above which it is clear on which side a ray leaves an edge.
const CLEAR_SIDE: f64 = 1e-4;

/// Two surfaces share a border if it is no farther off, in errors, than both may be.
const SHARED: f64 = 2.0;

/// By how much errors that are compared to tell whether a ray is flat may have grown by rounding: to
/// f32, or of the normal.
const ROUNDED_UP: f64 = 1.001;

/// The root that a ray starts on, seen from another one.
pub(super) struct StartRoot<'a> {
    pub(super) root: &'a Root,
    pub(super) piece: &'a Piece,
    pub(super) jet: Jet,
    /// `N · d`, or 0 without a normal.
    cosine: f64,
    /// How far from the origin, along the ray that starts there, the true root may be: less than
    /// along the ray that found it, if that was grazing.
    pub(super) error: f64,
    /// How far across the surface the true root may be, from the ray's origin and from the point.
    across: f64,
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

impl<'a> StartRoot<'a> {
    /// The root of these surfaces that a ray leaves.
    pub(super) fn new(root: &'a Root, set: &'a PatchSet, ray: &RayFrame) -> Self {
        let piece = &set.pieces()[root.piece as usize];
        let jet = piece.patch.jet(root.st);
        let cosine = piece.normal(root.st, &jet).map_or(0.0, |normal| normal.dot(ray.axis));
        let rounding = piece.patch.error_bound(ray.magnitude);
        // The ray that found the root may have come from far away: then the point that is left may
        // be known far better than that ray's bound says. A quotient that is not a number counts
        // for nothing.
        let across = root.across().min(jet.point.distance(ray.origin) + rounding);
        let error = root.error.min(Root::START_OFF * across / cosine.abs());
        Self { root, piece, jet, cosine, error, across, rounding }
    }

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
        is_at_side(self.piece, self.root.st, &self.jet, reach)
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

    /// Whether the root's error is no larger than it may be along this ray, which then is flatter on
    /// the surface than the one that found the root, or not much steeper: see [`Root::seen_along`].
    pub(super) fn is_flat(&self) -> bool {
        let along = Root::START_OFF * self.root.across() / self.cosine.abs();
        self.root.error <= ROUNDED_UP * along
    }

    /// How the start's surface and that of another place are turned, if they share an edge there:
    /// one within rounding of the start, to which `more` is added, and within `error` of the other
    /// place.
    pub(super) fn turn(&self, other: &Spot<'_>, more: f64, error: f64) -> Turn {
        let own = edges_within(self.piece, self.root.st, &self.jet, self.rounding + more);
        Turn::of(&own, &edges_within(other.piece, other.st, &other.jet, error))
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

    /// Whether an edge of the surface may pass a point, perhaps far from the start, that is known to
    /// within `error`, and that the start's own error may lift off the surface.
    pub(super) fn may_have_edge_at(&self, point: DVec3, error: f64) -> bool {
        let Self { root, piece, mut jet, rounding, .. } = *self;
        let mut st = root.st;
        for _ in 0..STEPS {
            st += step_towards(&jet, point - jet.point);
            if !st.is_finite() {
                return true; // at a pole
            }
            jet = piece.patch.jet(st);
        }
        let near = SHARED * rounding + self.across + error;
        let distances = piece.side_distances(st, &jet);
        let mut borders = RectSide::ALL.into_iter().filter(|side| piece.is_border(*side));
        borders.any(|side| distances[side].abs() <= near)
            || matches!(piece.side(st, trim_reach(&jet, near)), Side::Edge { .. })
    }
}

/// Gauss–Newton steps to the place under a point, from a place near it.
const STEPS: usize = 3;

/// Whether a place is within this distance of a side of its piece.
pub(super) fn is_at_side(piece: &Piece, st: DVec2, jet: &Jet, reach: f64) -> bool {
    piece.side_distances(st, jet).into_iter().any(|distance| distance <= reach)
}
