//! How far away rays may begin for boxes in f32 not to lose what they meet.

use super::tree::nodes::Tree;
use super::wide::{BLUR, BOX_SPARE, NEAR};
use crate::math::rounding;
use crate::patch::{OrientedBox, PADDING, PatchSet};

/// How far away ray origins may be for the work in f32.
///
/// A point may be as far from a ray as the promised bound of its residual. That bound grows with
/// the origin's coordinates, but the growth of boxes in f32 does not. The rounding error of the
/// surfaces themselves is part of their boxes.
pub(super) struct ReachOfF32 {
    /// How far a point may be from a ray, per unit of the largest coordinate.
    pub(super) factor: f64,
    /// The largest coordinate of the surfaces.
    magnitude: f64,
}

impl ReachOfF32 {
    pub(super) fn of(set: &PatchSet) -> Self {
        let patches = set.pieces().iter().map(|piece| &piece.patch);
        let (factor, magnitude) = patches.fold((0f64, 0f64), |(factor, magnitude), patch| {
            (factor.max(patch.residual_factor()), magnitude.max(patch.magnitude()))
        });
        Self { factor, magnitude }
    }

    /// The largest factor by which coordinates may be scaled up. A larger one resolves smaller
    /// things, but rays must begin nearer: with this one they may begin up to `TIMES` times as far
    /// away as anything in the scene. On bicubic surfaces, things of about 5e-6 of the scene's
    /// largest coordinate still fill the coordinates.
    pub(super) fn most_scale(&self) -> f64 {
        const TIMES: f64 = 1024.0;
        rounding::power_of_two_below(BLUR_OF_F32 / (self.factor * TIMES * self.magnitude))
    }

    /// The largest coordinate an origin may have: at least that of the surfaces, whose boxes cover
    /// the error of points for a ray that starts among them.
    pub(super) fn of_tree(&self, tree: &Tree) -> f64 {
        let scale = tree.regions.iter().map(|region| region.frame.scale).fold(0.0, f64::max);
        (BLUR_OF_F32 / (self.factor * scale)).max(self.magnitude)
    }
}

/// How far a point may be from a ray, in scaled coordinates, while boxes in f32 still meet the ray:
/// a quarter of the blur of rays at the boxes of nodes, and a part of the growth of oriented boxes.
const BLUR_OF_F32: f64 = 0.25 * BLUR as f64;

/// With that, and with four roundings of coordinates and distances (see [`BLUR`]), a ray is off by
/// no more than its blur and the growth of boxes cover.
const _: () = {
    let rounded = 4.0 * (5.0 + 8.0) * 0.5 * f32::EPSILON as f64;
    assert!(rounded + BLUR_OF_F32 <= BLUR as f64 + PADDING);
};

/// Nor is it farther off than oriented boxes were grown by: a ray within [`BLUR_OF_F32`] of a point
/// `p` of a leaf is found inside the leaf's box.
///
/// - The point is inside the two planes of each row `r` of the box: `|r · p − d| ≤ 1` less `|r|`
///   times the growth. So the point of the ray nearest to it is found inside if the test in f32 is
///   wrong about `r · o − d` plus `z` times `r · a` by no more than `|r|` times what is left of the
///   growth. Here `o` is the ray's origin, `a` its direction.
/// - The scene lies within √3 of the middle. So does the plane halfway between the two, as some of
///   the leaf's control points lie on either side of it: `|d| ≤ √3 |r|`. Half of the planes'
///   distance is no more than √3 either.
/// - The origin lies within [`NEAR`] of the middle: if it was moved, within √7, as the ray passes
///   within √3.
///
/// The roundings, as multiples of `|r| u`, all of one sign and without fused operations:
const _: () = {
    let (origin, scene) = (NEAR, 1.75);
    let (distance, z) = (origin + scene, origin + scene);
    // Of r, of o, of d, of the three products, and of their sums.
    let at = origin + origin + scene + origin + 3.0 * distance;
    // Of r, of a, of the products, and of their two sums.
    let along = z * (1.0 + 1.0 + 1.0 + 2.0);
    // Of 1 / (r · a), for (r · o − d) / (r · a) and for the half width, and of the former product.
    let quotient = distance + scene + distance;
    let rounded = (at + along + quotient) * 0.5 * f32::EPSILON as f64;
    assert!(rounded + BLUR_OF_F32 <= OrientedBox::GROWTH);
    // Places where rays enter and leave are compared with some slack of their own.
    assert!(2.0 * z * 0.5 * f32::EPSILON as f64 <= BOX_SPARE as f64);
};
