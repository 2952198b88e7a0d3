//! A ray prepared for all that is done with a single ray.

use fearless_simd::{Simd, SimdBase, f64x4};
use glam::DVec3;

use crate::intersect::Root;
use crate::intersect::hit::SPARE;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::box_ray::BoxRay;
use crate::intersect::wide::frames::{END_SPARE, shift_to_scene};
use crate::intersect::wide::hit_place::HitPlace;
use crate::intersect::wide::start::Start;
use crate::math::RayFrame;
use crate::patch::{Leaf, ScaledFrame};

/// Where to look for the one root of a ray in a leaf whose certificate holds for the ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guess {
    /// The start, in box coordinates.
    pub start: [f32; 2],
    /// If the root lies farther than this beyond a side of the piece, in box coordinates, the piece
    /// is missed there.
    pub clearance: f64,
}

impl Guess {
    /// Makes a guess from the slopes of the direction by the box's rows, and the error bound of a
    /// point's distance from the ray; `None` where the leaf's certificate does not hold for the
    /// ray.
    #[inline(always)]
    pub(crate) fn of(leaf: &Leaf, start: [f32; 2], slopes: [f32; 3], error: f64) -> Option<Self> {
        let certificate = &leaf.certificate;
        // How far rays pass from a pole is not examined here, only by the scalar search and the
        // packets.
        if leaf.has_pole() {
            return None;
        }
        let steepness = certificate.steepness_if_valid(slopes.map(f64::from), error)?;
        Some(Self { start, clearance: certificate.clearance_per_error() * error / steepness })
    }
}

/// A hit that is certain.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SingleHit {
    pub place: HitPlace,
    pub point: DVec3,
    /// The unit normal along `S_s × S_t`; the last number means nothing. All four are written at
    /// once: numbers written one by one and read as a vector have to reach the cache first.
    normal: [f64; 4],
}

/// One ray, in f64 and in scaled f32 coordinates.
#[derive(Clone, Debug)]
pub(crate) struct SingleRay<'a> {
    pub(super) frame: &'a RayFrame,
    pub start: Start<'a>,
    wanted: Wanted,
    /// In scaled coordinates, the origin moved along the ray by `shift`.
    pub(super) boxes: BoxRay,
    /// The distance by which the f32 origin was moved along the ray, in scene units.
    shift: f64,
    /// Scene units to scaled coordinates.
    scale: f64,
}

impl SingleHit {
    #[inline(always)]
    pub(crate) fn normal(&self) -> DVec3 {
        DVec3::new(self.normal[0], self.normal[1], self.normal[2])
    }

    /// Sets the normal from a vector along it, and the length of that.
    #[inline(always)]
    pub(crate) fn set_normal<S: Simd>(&mut self, simd: S, along: DVec3, length: f64) {
        let numbers = f64x4::from_slice(simd, &[along.x, along.y, along.z, length]);
        (numbers * f64x4::splat(simd, 1.0 / length)).store_slice(&mut self.normal);
    }
}

impl<'a> SingleRay<'a> {
    #[inline(always)]
    pub(crate) fn new(
        frame: &'a RayFrame,
        from: Option<&'a Root>,
        wanted: Wanted,
        scaled: &ScaledFrame,
    ) -> Self {
        let (boxes, shift) = boxes_in(scaled, frame, frame.z_range[1]);
        let start = Start { from, ahead: frame.z_range[0] >= 0.0 };
        Self { frame, start, wanted, boxes, shift, scale: scaled.scale }
    }

    /// Converts the ray, up to its nearest hit if there is one, to other scaled coordinates.
    #[cold]
    pub(super) fn change_to(&mut self, scaled: &ScaledFrame, hit: Option<&SingleHit>) {
        let end = hit.map_or(self.frame.z_range[1], |hit| hit.place.z);
        (self.boxes, self.shift) = boxes_in(scaled, self.frame, end);
        self.scale = scaled.scale;
    }

    /// The largest coordinate magnitude of the origin.
    pub(super) fn magnitude(&self) -> f64 {
        self.frame.magnitude
    }

    /// How far from the ray's start a root may be and yet be the start itself; `error` is the error
    /// bound of its place along the ray.
    #[inline(always)]
    pub(super) fn start_reach(&self, error: f64) -> f64 {
        SPARE * error + self.start.from.map_or(0.0, |root| root.error)
    }

    /// Whether more is wanted than that there is a hit.
    pub(super) fn asks_where(&self) -> bool {
        self.wanted != Wanted::Any
    }

    /// Whether all hits are wanted.
    pub(super) fn asks_for_all(&self) -> bool {
        self.wanted == Wanted::All
    }

    /// Ends the ray at a hit.
    pub(super) fn shorten(&mut self, z: f64) {
        self.boxes.far = self.wanted.far(z, self.shift, self.scale);
    }

    /// Whether nothing more is asked for.
    pub(super) fn is_done(&self) -> bool {
        self.boxes.far == f32::NEG_INFINITY
    }
}

/// A ray in scaled coordinates, up to `end`, and the distance by which its origin was moved.
#[inline(always)]
pub(crate) fn boxes_in(scaled: &ScaledFrame, frame: &RayFrame, end: f64) -> (BoxRay, f64) {
    let (scale, start) = (scaled.scale, scaled.scaled(frame.origin));
    let square = start.length_squared();
    let shift = shift_to_scene(square, start.dot(frame.axis));
    let origin = (start + shift * frame.axis).as_vec3();
    let axis = frame.axis.as_vec3();
    let near = (frame.z_range[0] * scale - shift - f64::from(END_SPARE)) as f32;
    let far = (end * scale - shift + f64::from(END_SPARE)) as f32;
    let inverse = frame.inverse_axis.as_vec3();
    let boxes = BoxRay::new(origin.to_array(), axis.to_array(), inverse.to_array(), [near, far]);
    (boxes, shift / scale)
}
