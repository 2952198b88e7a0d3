//! A ray prepared for all that one ray is put through.

use fearless_simd::{Simd, SimdBase, f32x16};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3};

use super::departure::{Departure, Final, NEARBY};
use crate::intersect::Root;
use crate::math::{RayFrame, rounding};
use crate::patch::{LEAF_SLACK, Leaf, SceneFrame, TensorPatch, WIDENING};

/// Origins farther than this from the scene, in its half sizes, are moved nearer for the
/// work in f32: it would otherwise lose digits to the distance.
const NEAR: f64 = 3.0;

/// How far the ray in f32 may be from the true one where it meets the scene, in scaled
/// coordinates, and box entries along it: coordinates of up to 5 and distances of up to 8,
/// and four roundings of each.
const BLUR: f32 = 4e-6;

/// Distances along the ray in f32 are given this much to spare.
const SPARE: f64 = 1e-5;

/// Components of directions are taken for at least this much: the ray moves by far less than
/// [`BLUR`] for it, and quotients stay finite.
const LEAST: f32 = 1e-12;

/// What a ray asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::intersect) enum Wanted {
    First,
    Any,
}

/// A hit that is certain.
#[derive(Clone, Copy, Debug)]
pub(in crate::intersect) struct SingleHit {
    pub(in crate::intersect) leaf: u32,
    pub(in crate::intersect) z: f64,
    /// How far `z` may be off.
    pub(in crate::intersect) z_error: f64,
    pub(in crate::intersect) st: DVec2,
    pub(in crate::intersect) point: DVec3,
    /// Along `S_s × S_t`.
    pub(in crate::intersect) cross: DVec3,
}

/// One ray, in f64 and in scaled f32 coordinates.
#[derive(Clone, Debug)]
pub(in crate::intersect) struct SingleRay<'a> {
    pub(super) frame: &'a RayFrame,
    from: Option<&'a Root>,
    wanted: Wanted,
    /// The origin, moved along the ray by `shift`, and the unit direction.
    pub(super) origin: [f32; 3],
    pub(super) axis: [f32; 3],
    /// One over the direction; which plane of a box comes first, and the origin moved by
    /// [`BLUR`] for either.
    pub(super) inverse: [f32; 3],
    pub(super) near_side: [usize; 3],
    pub(super) origin_for_near: [f32; 3],
    pub(super) origin_for_far: [f32; 3],
    /// The part of the ray that is still searched.
    pub(super) near: f32,
    pub(super) far: f32,
    /// The distance by which the f32 origin was moved along the ray, in scene units.
    shift: f64,
    /// Scene units to scaled coordinates.
    scale: f64,
}

impl<'a> SingleRay<'a> {
    #[inline(always)]
    pub(in crate::intersect) fn new(
        frame: &'a RayFrame,
        from: Option<&'a Root>,
        wanted: Wanted,
        scene: &SceneFrame,
    ) -> Self {
        let scale = scene.scale;
        let scaled = scene.scaled(frame.origin);
        let square = scaled.length_squared();
        let shift = if square > NEAR * NEAR { square.sqrt() - NEAR + 1.0 } else { 0.0 };
        let origin = (scaled + shift * frame.axis).as_vec3();
        let axis = frame.axis.as_vec3();
        let mut ray = Self {
            frame,
            from,
            wanted,
            origin: origin.to_array(),
            axis: axis.to_array(),
            inverse: [0.0; 3],
            near_side: [0; 3],
            origin_for_near: [0.0; 3],
            origin_for_far: [0.0; 3],
            near: (frame.z_range[0] * scale - shift - SPARE) as f32,
            far: (frame.z_range[1] * scale - shift + SPARE) as f32,
            shift: shift / scale,
            scale,
        };
        for k in 0..3 {
            let along = if axis[k].abs() < LEAST { LEAST.copysign(axis[k]) } else { axis[k] };
            ray.inverse[k] = 1.0 / along;
            ray.near_side[k] = usize::from(along < 0.0);
            let blur = BLUR.copysign(along);
            ray.origin_for_near[k] = origin[k] + blur;
            ray.origin_for_far[k] = origin[k] - blur;
        }
        ray
    }

    /// The largest coordinate magnitude of the origin.
    pub(super) fn magnitude(&self) -> f64 {
        self.frame.magnitude
    }

    /// Where in a leaf's box coordinates the ray starts, if on the leaf's piece.
    #[inline(always)]
    pub(super) fn start_in(&self, leaf: &Leaf) -> Option<[f32; 2]> {
        let root = self.from.filter(|root| root.piece == leaf.piece)?;
        let [s, t] = leaf.rect();
        let place = |[from, to]: [f64; 2], at: f64| (2.0 * at - (from + to)) / (to - from);
        Some([place(s, root.st.x) as f32, place(t, root.st.y) as f32])
    }

    /// Whether the ray starts on the one root it has with a leaf that is certified for it.
    #[inline(always)]
    pub(super) fn starts_in(&self, leaf: &Leaf) -> bool {
        // A little less than the certificate speaks of: in f32.
        let reach = 1.0 + 1.99 * WIDENING as f32;
        self.start_in(leaf).is_some_and(|[x, y]| x.abs() <= reach && y.abs() <= reach)
    }

    /// Whether the ray starts on a leaf, or near it on its piece, that does not lie ahead of it
    /// again; `error` is how far a point may be from the ray.
    #[simd]
    pub(super) fn departs_from<S: Simd>(
        &self,
        simd: S,
        (leaf, patch): (&Leaf, &TensorPatch),
        error: f64,
    ) -> bool {
        let (Some(root), Some(place)) = (self.from, self.start_in(leaf)) else { return false };
        let nearby = place[0].abs().max(place[1].abs()) <= NEARBY;
        let ahead = self.frame.z_range[0] >= 0.0;
        if !(nearby && ahead) {
            return false;
        }
        let [x, y, z] = (self.frame.origin - leaf.middle).as_vec3().to_array();
        let [dx, dy, dz] = self.axis;
        let reach = root.error + error;
        let departure = Departure {
            place: [f32x16::splat(simd, place[0]), f32x16::splat(simd, place[1])],
            origin: [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)],
            axis: [f32x16::splat(simd, dx), f32x16::splat(simd, dy), f32x16::splat(simd, dz)],
            reach: f32x16::splat(simd, rounding::f32_above(reach)),
        };
        let Final { surely, if_near } = departure.is_final(simd, leaf);
        let near = || patch.point(root.st).distance(self.frame.origin) <= reach;
        surely & 1 != 0 || (if_near & 1 != 0 && near())
    }

    /// How far from the ray's start a root may be and yet be the start itself, for the
    /// error of its place along the ray.
    #[inline(always)]
    pub(super) fn start_reach(&self, error: f64) -> f64 {
        2.0 * error + self.from.map_or(0.0, |root| root.error)
    }

    /// Whether more is wanted of a hit than that there is one.
    pub(super) fn asks_where(&self) -> bool {
        self.wanted == Wanted::First
    }

    /// Ends the ray at a hit.
    pub(super) fn shorten(&mut self, z: f64) {
        self.far = match self.wanted {
            Wanted::First => ((z - self.shift) * self.scale + SPARE) as f32,
            Wanted::Any => f32::NEG_INFINITY,
        };
    }

    /// Whether nothing more is asked for.
    pub(super) fn is_done(&self) -> bool {
        self.far == f32::NEG_INFINITY
    }
}

/// How far outside a leaf's rectangle roots are its own, in half sides.
pub(super) const REACH: f64 = 1.0 + 2.0 * LEAF_SLACK;
