//! What the proof of [`departure`](super) takes from a leaf's approximation, for rays that start on
//! the leaf: the tangent planes at the starts, and second derivatives.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use super::{Departure, FARTHEST};
use crate::intersect::wide::search::distances::sizes;
use crate::intersect::wide::vectors::{cross, dot, scaled};
use crate::intersect::wide::view::Fitted;

/// The approximation's tangent plane at the starts.
pub(super) struct Plane<S: Simd> {
    pub(super) point: [f32x16<S>; 3],
    /// How far the ray's origin is from the point: the largest of the three coordinates.
    pub(super) off: f32x16<S>,
    pub(super) weight: f32x16<S>,
    /// The tangents: derivatives by box coordinates times the lengths of the half sides.
    pub(super) along: [[f32x16<S>; 3]; 2],
    /// The unit normal, on the side to which the ray goes.
    pub(super) normal: [f32x16<S>; 3],
    /// One over the length of the tangents' cross product.
    pub(super) per_length: f32x16<S>,
    /// The unit vector in the plane that is perpendicular to the ray.
    pub(super) across: [f32x16<S>; 3],
    /// The cosine and the sine of the angle between ray and normal.
    pub(super) cosine: f32x16<S>,
    pub(super) sine: f32x16<S>,
}

impl<S: Simd> Plane<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, fitted: Fitted<'_>, departure: &Departure<S>) -> Self {
        let Departure { place, origin, axis, .. } = departure;
        let [per_x, per_y] = fitted.leaf.half_side_lengths().map(|length| 1.0 / length);
        let Tangents { point, weight, along_x, along_y } = Tangents::new(simd, fitted, place);
        let mut off = f32x16::splat(simd, 0.0);
        for k in 0..3 {
            off = off.max((point[k] - origin[k]).abs());
        }
        let (along_x, along_y) = (
            scaled(along_x, f32x16::splat(simd, per_x)),
            scaled(along_y, f32x16::splat(simd, per_y)),
        );
        let normal = cross(along_x, along_y);
        let per_length = f32x16::splat(simd, 1.0) / dot(normal, normal).sqrt();
        let normal = scaled(normal, per_length);
        let along = dot(normal, *axis);
        let across = cross(normal, *axis);
        let sine = dot(across, across).sqrt();
        let across = [across[0] / sine, across[1] / sine, across[2] / sine];
        let sign = f32x16::splat(simd, 1.0).copysign(along);
        let normal = scaled(normal, sign);
        let cosine = along.abs();
        Self {
            point,
            off,
            weight,
            along: [along_x, along_y],
            normal,
            per_length,
            across,
            cosine,
            sine,
        }
    }
}

/// The approximation at the starts.
struct Tangents<S: Simd> {
    point: [f32x16<S>; 3],
    weight: f32x16<S>,
    /// The derivatives by box coordinates.
    along_x: [f32x16<S>; 3],
    along_y: [f32x16<S>; 3],
}

impl<S: Simd> Tangents<S> {
    #[simd]
    fn new(simd: S, Fitted { leaf, weight }: Fitted<'_>, place: &[f32x16<S>; 2]) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let mut tangents = Self {
            point: [zero; 3],
            weight: f32x16::splat(simd, 1.0),
            along_x: [zero; 3],
            along_y: [zero; 3],
        };
        let Self { point, along_x, along_y, .. } = &mut tangents;
        for axis in 0..3 {
            [point[axis], along_x[axis], along_y[axis]] = sums(simd, place, &leaf.fit()[axis]);
        }
        if let Some(weight) = weight {
            let [weight, by_x, by_y] = sums(simd, place, weight);
            let inverse = f32x16::splat(simd, 1.0) / weight;
            for axis in 0..3 {
                point[axis] *= inverse;
                along_x[axis] = (along_x[axis] - point[axis] * by_x) * inverse;
                along_y[axis] = (along_y[axis] - point[axis] * by_y) * inverse;
            }
            tangents.weight = weight;
        }
        tangents
    }
}

/// A bicubic polynomial at some places, and its derivatives by `x` and by `y` (Horner's scheme).
#[inline(always)]
fn sums<S: Simd>(simd: S, &[x, y]: &[f32x16<S>; 2], coefficients: &[f32; 16]) -> [f32x16<S>; 3] {
    let three = f32x16::splat(simd, 3.0);
    let (x2, x3) = (x + x, x * x * three);
    let (y2, y3) = (y + y, y * y * three);
    let (mut row, mut slope) = ([x; 4], [x; 4]);
    for j in 0..4 {
        let c0 = f32x16::splat(simd, coefficients[j]);
        let c1 = f32x16::splat(simd, coefficients[4 + j]);
        let c2 = f32x16::splat(simd, coefficients[8 + j]);
        let c3 = f32x16::splat(simd, coefficients[12 + j]);
        row[j] = c3.mul_add(x, c2).mul_add(x, c1).mul_add(x, c0);
        slope[j] = c3.mul_add(x3, c2.mul_add(x2, c1));
    }
    [
        row[3].mul_add(y, row[2]).mul_add(y, row[1]).mul_add(y, row[0]),
        slope[3].mul_add(y, slope[2]).mul_add(y, slope[1]).mul_add(y, slope[0]),
        row[3].mul_add(y3, row[2].mul_add(y2, row[1])),
    ]
}

/// Bounds of a weight within [`FARTHEST`] of the middle.
pub(super) struct Weights {
    pub(super) least: f32,
    /// Bound of its slope in any direction, by box coordinates times the lengths of the half sides.
    pub(super) slope: f32,
    /// How many times as large rounding errors are as without a weight.
    pub(super) terms: f32,
}

impl Weights {
    #[inline(always)]
    pub(super) fn new<S: Simd>(
        simd: S,
        fitted: Fitted<'_>,
        [length_x, length_y]: [f32; 2],
    ) -> Self {
        let Some(weight) = fitted.weight else {
            return Self { least: 1.0, slope: 0.0, terms: 1.0 };
        };
        let (mut others, mut by_x, mut by_y) = (0.0, 0.0, 0.0);
        for m in 1..16 {
            let (i, j) = (m / 4, m % 4);
            let size = weight[m].abs() * reach_to(i + j - 1);
            others += size * FARTHEST;
            by_x += size * i as f32;
            by_y += size * j as f32;
        }
        let least = (1.0 - others).max(1.0 / fitted.heaviest());
        // Numerators may be larger than the surface, and take as many roundings each; the weight
        // takes as many again, and is multiplied with points; everything is divided by it.
        let [x, y, z, _] = sizes(simd, fitted);
        let numerators = (x + y + z) * reach_to(6) / (length_x + length_y);
        let terms = (numerators + 2.0 * (1.0 + others)) / (least * least);
        Self { least, slope: (by_x / length_x).hypot(by_y / length_y), terms }
    }
}

/// Second derivatives of an approximation, by box coordinates times the lengths of the half sides:
/// twice by the first, by both, twice by the second.
pub(super) struct Bends<S: Simd> {
    /// Those of the height, in the middle of the leaf.
    height: [f32x16<S>; 3],
    /// Bounds of how much those differ elsewhere.
    more: [f32x16<S>; 3],
    /// Bounds, anywhere, of the absolute values of those of the distance across the ray.
    aside: [f32x16<S>; 3],
}

impl<S: Simd> Bends<S> {
    /// From the approximation's terms along the normal and across the ray: those of the numerators
    /// minus the point at the start times the weight.
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        Fitted { leaf, weight }: Fitted<'_>,
        &Plane { point, normal, across, .. }: &Plane<S>,
    ) -> Self {
        let [per_x, per_y] = leaf.half_side_lengths().map(|length| 1.0 / length);
        let per = [per_x * per_x, per_x * per_y, per_y * per_y];
        let zero = f32x16::splat(simd, 0.0);
        let mut bends = Self { height: [zero; 3], more: [zero; 3], aside: [zero; 3] };
        let fit = leaf.fit();
        for i in 0..4 {
            for j in 0..4 {
                if i + j < 2 {
                    continue;
                }
                let m = 4 * i + j;
                let mut term = [
                    f32x16::splat(simd, fit[0][m]),
                    f32x16::splat(simd, fit[1][m]),
                    f32x16::splat(simd, fit[2][m]),
                ];
                if let Some(weight) = weight {
                    let w = f32x16::splat(simd, -weight[m]);
                    for axis in 0..3 {
                        term[axis] = w.mul_add(point[axis], term[axis]);
                    }
                }
                let (up, off) = (dot(normal, term), dot(across, term).abs());
                // The factors that differentiation takes from the exponents.
                let factors = [i * i.saturating_sub(1), i * j, j * j.saturating_sub(1)];
                for k in 0..3 {
                    if factors[k] == 0 {
                        continue;
                    }
                    let weight =
                        f32x16::splat(simd, factors[k] as f32 * reach_to(i + j - 2) * per[k]);
                    bends.aside[k] = off.mul_add(weight, bends.aside[k]);
                    if i + j == 2 {
                        bends.height[k] = up * weight;
                    } else {
                        bends.more[k] = up.abs().mul_add(weight, bends.more[k]);
                    }
                }
            }
        }
        bends
    }

    /// An upper bound of the norm of the height's second derivatives.
    #[inline(always)]
    pub(super) fn norm(&self) -> f32x16<S> {
        let ([xx, xy, yy], more) = (self.height, self.more);
        (xx.abs() + more[0]).max(yy.abs() + more[2]) + xy.abs() + more[1]
    }

    /// The same for the distance across the ray.
    #[inline(always)]
    pub(super) fn norm_aside(&self) -> f32x16<S> {
        self.aside[0].max(self.aside[2]) + self.aside[1]
    }

    /// An upper bound of the largest eigenvalue of the height's second derivatives.
    #[inline(always)]
    pub(super) fn largest(&self, simd: S) -> f32x16<S> {
        let ([xx, xy, yy], more) = (self.height, self.more);
        let (xx, xy, yy) = (xx + more[0], xy.abs() + more[1], yy + more[2]);
        let (apart, twice) = (xx - yy, xy + xy);
        f32x16::splat(simd, 0.5) * (xx + yy + apart.mul_add(apart, twice * twice).sqrt())
    }

    /// How fast the distance across the ray grows, times the weight; and an upper bound of the
    /// height's second derivative in the one direction in which that distance does not grow.
    #[inline(always)]
    pub(super) fn ahead(&self, simd: S, plane: &Plane<S>) -> (f32x16<S>, f32x16<S>) {
        let ([xx, xy, yy], more) = (self.height, self.more);
        let (p, q) = (dot(plane.across, plane.along[0]), dot(plane.across, plane.along[1]));
        let speed = p.mul_add(p, q * q).sqrt();
        let (x, y) = (q / speed, p / speed);
        let at = (x * y).mul_add(f32x16::splat(simd, -2.0) * xy, x * x * xx + y * y * yy);
        let off = (x * y).abs().mul_add(more[1] + more[1], x * x * more[0] + y * y * more[2]);
        (speed * plane.weight, at + off)
    }

    /// A bound of what second derivatives add to the distance across the ray, over the distance of
    /// two places, which are at most this far apart.
    #[inline(always)]
    pub(super) fn bent_aside(&self, simd: S, [far_x, far_y]: [f32x16<S>; 2]) -> f32x16<S> {
        let bent = f32x16::splat(simd, 0.5) * self.aside[0].mul_add(far_x, self.aside[2] * far_y);
        self.aside[1].mul_add(far_x.min(far_y), bent)
    }
}

/// A power of [`FARTHEST`].
const fn reach_to(power: usize) -> f32 {
    let mut product = 1.0;
    let mut k = 0;
    while k < power {
        product *= FARTHEST;
        k += 1;
    }
    product
}
