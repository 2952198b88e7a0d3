//! What is known of a place where a ray meets a leaf.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::reach::{AIMED, rounding_at};
use crate::intersect::HitFlags;
use crate::math::RayFrame;
use crate::patch::{Jet, Piece};

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
    /// Whether it is at a trim curve, to within rounding. A curve along the border of the domain
    /// counts, though it is no trim edge to report.
    pub at_trims: bool,
    /// How far the point may be from the trim edge it is at; zero elsewhere.
    pub edge: f64,
    /// The cosine between the ray and the normal, signed; zero where there is no normal, or where
    /// the ray may go either way.
    pub cosine: f64,
    /// The stretch along which the ray runs inside the surface, as ray parameters.
    pub stretch: Option<[f64; 2]>,
    /// Whether the ray passes a side of the piece, or an edge of its trims, on the outside, by more
    /// than the rounding of a ray aimed at it.
    pub beyond: bool,
    /// Whether a ray that was aimed at a trim edge may be this one: which side of the edge it
    /// passes is not known. (Known only where all hits are asked for.)
    pub on_edge: bool,
    /// How far a ray may pass a point there and still be one that was aimed at it.
    pub aimed: f64,
    /// What the piece covers of a disk of that radius about the ray.
    pub cover: Cover,
    /// The number, from 1, of the place where it is met together with other faces, if these must
    /// balance; 0 elsewhere.
    pub place: u32,
}

/// What a piece covers of the surroundings of a ray that meets it: of a disk across the ray, so
/// small that rays within it cannot be told apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cover {
    Nothing,
    Whole,
    /// That of the sector between the sides and trim edges that pass through the disk.
    Sector,
    Unknown,
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
            error: piece.patch.error_bound(frame.magnitude),
            at_trims: false,
            on_edge: false,
            edge: 0.0,
            cosine: normal.map_or(0.0, |normal| normal.dot(frame.axis)),
            stretch: None,
            beyond: false,
            aimed: AIMED * rounding_at(jet.point, piece, frame),
            cover: Cover::Sector,
            place: 0,
        }
    }
}
