//! The question that a ray puts to leaves, and what is found.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use crate::geometry::trim::Side;
use crate::intersect::crossings::borders::{at_border, error_bound, trim_reach};
use crate::intersect::exact::{ExactSolver, Solution};
use crate::intersect::hit::StartIn;
use crate::intersect::{HitFlags, Occlusion, Query, Root, Statistics};
use crate::math::RayFrame;
use crate::patch::{Jet, Leaf, OrientedBox, Passage, PatchSet, Piece, ScaledFrame};

/// A place where a ray meets a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// The ray parameter.
    pub t: f64,
    /// Error bounds of `t`, and of the distance along the ray in scene units.
    pub t_error: f64,
    pub z_error: f64,
    pub surface: u32,
    pub piece: u32,
    pub st: DVec2,
    pub jet: Jet,
    /// The unit normal, where there is one.
    pub normal: Option<DVec3>,
    pub flags: HitFlags,
    /// How far the surface's point may be from the ray.
    pub error: f64,
    /// How far the point may be from the trim edge it is at; zero elsewhere.
    pub edge: f64,
    /// The cosine between the ray and the normal, signed; zero where there is no normal.
    pub cosine: f64,
    /// The stretch along which the ray runs inside the surface, as ray parameters.
    pub stretch: Option<[f64; 2]>,
    /// Whether the ray passes a side of the piece, or an edge of its trims, on the outside, by more
    /// than the rounding of a ray aimed at it.
    pub beyond: bool,
}

impl Meeting {
    /// Which of two comes first: the nearer one, of those at one `t` that on the surface, then the
    /// piece that was given first, and last by the place on the piece, so that the order of the
    /// search does not matter.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        let place = |m: &Self| (m.surface, m.piece);
        let by_piece = self.t.total_cmp(&other.t).then_with(|| place(self).cmp(&place(other)));
        let (a, b) = (self.st, other.st);
        by_piece.then_with(|| a.x.total_cmp(&b.x)).then_with(|| a.y.total_cmp(&b.y))
    }

    /// Whether floating point has decided that the ray meets the leaf here.
    pub(crate) fn is_certain(&self) -> bool {
        !self.flags.contains(HitFlags::DOUBTFUL)
    }
}

/// A hit that is certain, as the fast kernels find it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CertainHit {
    pub t: f64,
    /// Error bound of the distance along the ray, in scene units.
    pub z_error: f64,
    pub piece: u32,
    pub st: DVec2,
    pub jet: Jet,
    pub normal: Option<DVec3>,
    pub flags: HitFlags,
}

impl CertainHit {
    /// The meeting as the scalar search would have found it; `piece` is the hit's piece.
    pub(crate) fn meeting(self, piece: &Piece, frame: &RayFrame) -> Meeting {
        let Self { t, z_error, st, jet, normal, flags, .. } = self;
        Meeting {
            t,
            t_error: z_error * frame.t_from_z,
            z_error,
            surface: piece.surface,
            piece: self.piece,
            st,
            jet,
            normal,
            flags,
            error: error_bound(piece, frame),
            edge: 0.0,
            cosine: normal.map_or(0.0, |normal| normal.dot(frame.axis)),
            stretch: None,
            beyond: false,
        }
    }
}

/// The answer of an any-hit search that found these meetings; `doubt` is the smallest ray parameter
/// at which something may have been missed.
pub(crate) fn occlusion<'m>(meetings: impl Iterator<Item = &'m Meeting>, doubt: f64) -> Occlusion {
    let (mut occluded, mut certain) = (false, false);
    for meeting in meetings {
        occluded = true;
        certain |= meeting.is_certain();
    }
    let doubtful = !certain && (occluded || doubt < f64::INFINITY);
    Occlusion { occluded, doubtful }
}

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
        let slack = error_bound(self.piece, ray);
        let passage = self.oriented.passage(ray, scaled, slack)?;
        let apart = passage.entry > limit + slack || passage.exit < ray.z_range[0] - slack;
        (!apart).then_some(passage)
    }
}

impl<'a> Question<'a> {
    /// The root the ray starts on, and its piece, if it lies on that surface.
    pub(super) fn start_on(&self, surface: u32) -> Option<(&'a Root, &'a Piece)> {
        let root = self.from?;
        let piece = &self.set.pieces()[root.piece as usize];
        (piece.surface == surface).then_some((root, piece))
    }

    /// Whether the crossing of an edge at `point` is that of the edge, of another surface, which
    /// the ray starts on: at the same place, to within both error bounds, and with the same sign of
    /// `N · d`, as in [`crossings`](crate::intersect::crossings).
    pub(super) fn starts_on_edge_at(&self, point: DVec3, cosine: f64, z_error: f64) -> bool {
        let Some(root) = self.from else { return false };
        let piece = &self.set.pieces()[root.piece as usize];
        let jet = piece.patch.jet(root.st);
        let near = point.distance(jet.point) <= 2.0 * (z_error + root.error);
        let edge = || {
            at_border(piece, root.st, &jet, error_bound(piece, self.ray))
                || matches!(piece.side(root.st, trim_reach(&jet, root.error)), Side::Edge { .. })
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

/// What a search found, and its scratch memory.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub meetings: Vec<Meeting>,
    /// The smallest ray parameter at which something may have been missed.
    pub doubt: f64,
    pub statistics: Statistics,
    /// Boxes the exact solver has looked at for this ray, weighted by cost; to be set to zero for
    /// the next ray.
    pub(super) effort: u64,
    pub(super) solver: ExactSolver,
    pub(super) solutions: Vec<Solution>,
}

impl Findings {
    /// Forgets what was found, but keeps memory and statistics.
    pub(crate) fn clear(&mut self) {
        self.meetings.clear();
        self.doubt = f64::INFINITY;
        self.effort = 0;
    }

    /// The answer of an any-hit search that found this.
    pub(crate) fn occlusion(&mut self) -> Occlusion {
        let occlusion = occlusion(self.meetings.iter(), self.doubt);
        self.statistics.count_doubt(occlusion.doubtful);
        occlusion
    }

    pub(super) fn doubt_at(&mut self, t: f64) {
        self.doubt = self.doubt.min(t);
    }
}
