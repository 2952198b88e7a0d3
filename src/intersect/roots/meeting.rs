//! What is known of a place where a ray meets a leaf.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::reach::{AIMED, rounding_at};
use crate::intersect::HitFlags;
use crate::intersect::exact::End;
use crate::math::RayFrame;
use crate::patch::{Jet, Piece};

/// A place where a ray meets a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// The ray parameter.
    pub t: f64,
    /// Error bound of the distance along the ray, in scene units, and what makes such a distance a
    /// ray parameter.
    pub z_error: f64,
    pub t_from_z: f64,
    pub surface: u32,
    pub piece: u32,
    pub st: DVec2,
    pub jet: Jet,
    /// The unit normal, where there is one.
    pub normal: Option<DVec3>,
    pub flags: HitFlags,
    /// How far the surface's point may be from the ray.
    pub error: f64,
    /// The trim curve it is at, if it is at one.
    pub trim_curve: Option<TrimCurve>,
    /// The cosine between the ray and the normal, signed; zero where there is no normal, or where
    /// the ray may go either way.
    pub cosine: f64,
    /// The stretch along which the ray runs inside the surface, if the place is an end of one.
    pub stretch: Option<Stretch>,
    /// Whether the ray passes a side of the piece, or an edge of its trims, on the outside, by more
    /// than the rounding of a ray aimed at it.
    pub beyond: bool,
    /// How far a ray may pass a point there and still be one that was aimed at it.
    pub aimed: f64,
    /// What the piece covers of a disk of that radius about the ray.
    pub cover: Cover,
    /// The number of the place where it is met together with other faces, if these must balance.
    pub place: Option<u32>,
}

/// A stretch along which a ray runs inside a surface, as seen from one of its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    /// From one ray parameter to another.
    pub t: [f64; 2],
    pub end: End,
}

/// A trim curve that a place is at, to within rounding. One along the border of the domain counts,
/// though it is no trim edge to report.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrimCurve {
    /// How far the point may be from the curve.
    pub off: f64,
    /// Whether a ray that was aimed at the curve may be this one: which side of it the ray passes is
    /// not known. (Told only where all hits are asked for.)
    pub on_either_side: bool,
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

    /// Error bound of `t`.
    pub(crate) fn t_error(&self) -> f64 {
        self.z_error * self.t_from_z
    }

    /// How far the point may be from the trim curve it is at; zero elsewhere.
    pub(crate) fn off_trim_curve(&self) -> f64 {
        self.trim_curve.map_or(0.0, |curve| curve.off)
    }

    /// Whether the ray may pass the trim curve there on either side.
    pub(crate) fn on_either_side(&self) -> bool {
        self.trim_curve.is_some_and(|curve| curve.on_either_side)
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
            z_error,
            t_from_z: frame.t_from_z,
            surface: piece.surface,
            piece: self.piece,
            st,
            jet,
            normal,
            flags,
            error: piece.patch.error_bound(frame.magnitude),
            trim_curve: None,
            cosine: normal.map_or(0.0, |normal| normal.dot(frame.axis)),
            stretch: None,
            beyond: false,
            aimed: AIMED * rounding_at(jet.point, piece, frame),
            cover: Cover::Sector,
            place: None,
        }
    }
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// A meeting at `t` along the z axis, in the middle of the first piece, with an error of 1e-15
    /// across the ray.
    pub(crate) fn view(t: f64, cosine: f64, flags: HitFlags) -> Meeting {
        let jet = Jet { point: t * DVec3::Z, ds: DVec3::X, dt: DVec3::Y };
        Meeting {
            t,
            z_error: 1e-15 / cosine,
            t_from_z: 1.0,
            surface: 0,
            piece: 0,
            st: DVec2::splat(0.5),
            jet,
            normal: Some(DVec3::Z),
            flags,
            error: 1e-15,
            trim_curve: None,
            cosine,
            stretch: None,
            beyond: false,
            aimed: 1e-16,
            cover: Cover::Sector,
            place: None,
        }
    }
}
