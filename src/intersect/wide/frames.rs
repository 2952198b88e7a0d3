//! Rays in lanes: what [`RayFrame`](crate::math::RayFrame) holds of a ray, for eight or sixteen
//! rays at once, and the same in f32.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};

use super::vectors::dot_d;
use crate::intersect::Shot;
use crate::math::{PLAIN_SQUARES, Ray};
use crate::patch::ScaledFrame;

/// Origins farther than this from the middle of the scene, in its half sizes, are moved nearer for
/// the work in f32, which would otherwise lose digits to the distance.
pub(crate) const NEAR: f64 = 3.0;

/// Slack of the ends of rays in f32, in scaled coordinates: some units of f32 for distances of a
/// few scene sizes.
pub(super) const END_SPARE: f32 = 1e-5;

/// By how much an origin is moved along its ray for the work in f32, from the square of its
/// distance from the middle of the scene and the component of its position along the ray, all in
/// scaled coordinates: to beside the scene, and backwards where the scene lies behind, as some
/// ranges begin before the origin.
#[inline(always)]
pub(super) fn shift_to_scene(square: f64, along: f64) -> f64 {
    if square > NEAR * NEAR { (square.sqrt() - NEAR + 1.0).copysign(-along) } else { 0.0 }
}

/// Eight rays in f64.
#[derive(Clone, Copy)]
pub(super) struct EightRays<S: Simd> {
    pub(super) origin: [f64x8<S>; 3],
    /// The unit directions.
    pub(super) axis: [f64x8<S>; 3],
    /// One over the lengths of the directions as given.
    pub(super) t_from_z: f64x8<S>,
    /// The range of `z`.
    pub(super) ends: [f64x8<S>; 2],
    /// The largest coordinate magnitude of the origins.
    pub(super) magnitude: f64x8<S>,
}

impl<S: Simd> EightRays<S> {
    /// The frames of the eight rays from `base` on; the first of all stands in for missing ones.
    #[inline(always)]
    pub(super) fn of<Q: Shot>(simd: S, shots: &[Q], base: usize) -> Self {
        let mut rays = [shots[0].ray(); 8];
        for k in 0..8 {
            rays[k] = shots.get(base + k).unwrap_or(&shots[0]).ray();
        }
        Self::new(simd, rays)
    }

    /// The frames of eight rays.
    ///
    /// The operations and their order are those of the scalar frame, so both have the same bits.
    #[inline(always)]
    pub(super) fn new(simd: S, rays: [&Ray; 8]) -> Self {
        let mut rows = [f64x8::splat(simd, 0.0); 8];
        for k in 0..8 {
            rows[k] = f64x8::from_slice(simd, &rays[k].to_array());
        }
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] = transposed(rows);
        let (origin, d) = ([ox, oy, oz], [dx, dy, dz]);

        let one = f64x8::splat(simd, 1.0);
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let mut length = square.sqrt();
        let inverse = one / length;
        let mut t_from_z = inverse;
        let mut axis = [d[0] * inverse, d[1] * inverse, d[2] * inverse];
        let plain = square.simd_ge(f64x8::splat(simd, PLAIN_SQUARES.start))
            & square.simd_lt(f64x8::splat(simd, PLAIN_SQUARES.end));
        if !plain.all_true() {
            let largest = d[0].abs().max(d[1].abs()).max(d[2].abs());
            let v = [d[0] / largest, d[1] / largest, d[2] / largest];
            let rest = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            length = plain.select(length, largest * rest);
            t_from_z = one / length;
            for i in 0..3 {
                axis[i] = plain.select(axis[i], v[i] / rest);
            }
        }
        let ends = [t_min * length, t_max * length];
        let magnitude = ox.abs().max(oy.abs()).max(oz.abs());
        Self { origin, axis, t_from_z, ends, magnitude }
    }
}

/// The normals of two planes through each of eight rays, from their unit directions.
#[inline(always)]
pub(super) fn perpendicular<S: Simd>(simd: S, [x, y, z]: [f64x8<S>; 3]) -> [[f64x8<S>; 3]; 2] {
    let one = f64x8::splat(simd, 1.0);
    let sign = one.copysign(z);
    let a = -one / (sign + z);
    let b = x * y * a;
    [[one + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

/// Sixteen rays in scaled coordinates, in f32.
#[derive(Clone, Copy)]
pub(super) struct ScaledSixteen<S: Simd> {
    /// The origins, moved along the rays by `shift`.
    pub(super) origin: [f32x16<S>; 3],
    pub(super) axis: [f32x16<S>; 3],
    /// The range in which hits count, with some slack.
    pub(super) ends: [f32x16<S>; 2],
    pub(super) magnitude: f32x16<S>,
    /// The distances by which the origins were moved, in scene units.
    pub(super) shift: [f64x8<S>; 2],
}

impl<S: Simd> ScaledSixteen<S> {
    /// The f32 coordinates of sixteen rays.
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        low: &EightRays<S>,
        high: &EightRays<S>,
        &ScaledFrame { center, scale }: &ScaledFrame,
    ) -> Self {
        let unscale = f64x8::splat(simd, 1.0 / scale); // exact, as the scale is a power of two
        let scale = f64x8::splat(simd, scale);
        let zero = f64x8::splat(simd, 0.0);
        let mut origin = [[zero; 3]; 2];
        let mut ends = [[zero; 2]; 2];
        let mut shifts = [zero; 2];
        for half in 0..2 {
            let &EightRays { origin: o, axis, ends: z, .. } = if half == 0 { low } else { high };
            let scaled = [
                (o[0] - f64x8::splat(simd, center.x)) * scale,
                (o[1] - f64x8::splat(simd, center.y)) * scale,
                (o[2] - f64x8::splat(simd, center.z)) * scale,
            ];
            let square = dot_d(scaled, scaled);
            let near = f64x8::splat(simd, NEAR);
            let far_off = square.simd_gt(near * near);
            let mut shift = zero;
            if far_off.any_true() {
                // As in `shift_to_scene`, lane by lane.
                let beyond = square.sqrt() - near + f64x8::splat(simd, 1.0);
                shift = far_off.select(beyond.copysign(-dot_d(scaled, axis)), zero);
            }
            for i in 0..3 {
                origin[half][i] = scaled[i] + shift * axis[i];
            }
            let shift = shift * unscale;
            shifts[half] = shift;
            ends[half] = [(z[0] - shift) * scale, (z[1] - shift) * scale];
        }
        let spare = f32x16::splat(simd, END_SPARE);
        let above = f32x16::splat(simd, 1.0 + f32::EPSILON);
        Self {
            origin: [
                simd.narrow_f64x8(origin[0][0], origin[1][0]),
                simd.narrow_f64x8(origin[0][1], origin[1][1]),
                simd.narrow_f64x8(origin[0][2], origin[1][2]),
            ],
            axis: [
                simd.narrow_f64x8(low.axis[0], high.axis[0]),
                simd.narrow_f64x8(low.axis[1], high.axis[1]),
                simd.narrow_f64x8(low.axis[2], high.axis[2]),
            ],
            ends: [
                simd.narrow_f64x8(ends[0][0], ends[1][0]) - spare,
                simd.narrow_f64x8(ends[0][1], ends[1][1]) + spare,
            ],
            magnitude: simd.narrow_f64x8(low.magnitude, high.magnitude) * above,
            shift: shifts,
        }
    }
}

/// Transposes the square matrix whose rows are these vectors.
#[inline(always)]
pub(super) fn transposed<S: Simd, V: SimdBase<S>, const N: usize>(rows: [V; N]) -> [V; N] {
    // Each round brings together rows that are half as far apart as before: N / 2, …, 2, 1.
    let mut rows = rows;
    for _ in 0..N.ilog2() {
        let mut next = rows;
        for k in 0..N / 2 {
            next[2 * k] = rows[k].zip_low(rows[k + N / 2]);
            next[2 * k + 1] = rows[k].zip_high(rows[k + N / 2]);
        }
        rows = next;
    }
    rows
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::math::RayFrame;

    /// Rays with directions of any length, often near one from which on lengths are computed in
    /// another way.
    fn rays() -> impl Strategy<Value = Ray> {
        let component = || prop_oneof![6 => -1.0..1.0f64, 1 => Just(0.0), 1 => Just(-0.0)];
        let exponent = || prop_oneof![Just(0.0), -149.0..150.0f64, -50.2..-49.8f64, 49.8..50.2f64];
        let vector = (prop::array::uniform3(component()), exponent())
            .prop_map(|(v, exponent)| 10f64.powf(exponent) * DVec3::from_array(v));
        let from = prop_oneof![Just(0.0), -9.0..9.0f64, Just(f64::NEG_INFINITY)];
        let to = prop_oneof![9.0..99.0f64, Just(f64::INFINITY)];
        (vector.clone(), vector, from, to).prop_filter_map("no ray", |(origin, along, from, to)| {
            Ray::with_range(origin, along, from, to).ok()
        })
    }

    #[test]
    fn frames_have_the_bits_of_scalar_frames() {
        proptest!(ProptestConfig::with_cases(2_000), |(rays in prop::array::uniform8(rays()))| {
            let truth = rays.each_ref().map(|ray| {
                let frame = RayFrame::new(ray);
                let vectors = [frame.origin, frame.axis, frame.normals[0], frame.normals[1]];
                let vectors = vectors.map(|v| v.to_array().map(f64::to_bits));
                let numbers = [frame.t_from_z, frame.z_range[0], frame.z_range[1], frame.magnitude];
                (vectors, numbers.map(f64::to_bits))
            });
            for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                let found: [_; 8] = dispatch!(level, simd => {
                    let frames = EightRays::new(simd, rays.each_ref());
                    let [n1, n2] = perpendicular(simd, frames.axis);
                    let vectors = [frames.origin, frames.axis, n1, n2];
                    let EightRays { t_from_z, ends: [from, to], magnitude, .. } = frames;
                    let numbers = [t_from_z, from, to, magnitude];
                    from_fn(|lane| {
                        let bits = |lanes: f64x8<_>| lanes[lane].to_bits();
                        (vectors.map(|v| v.map(bits)), numbers.map(bits))
                    })
                });
                prop_assert_eq!(found, truth);
            }
        });
    }
}
