//! The distances of one ray from one leaf's approximation, in f32, and the start found from them.

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdFloat, SimdSplit, f32x4, f32x8};
use fearless_simd_macros::simd;

use super::convergence::STEPS_IN_F32;
use crate::intersect::wide::view::Fitted;
use crate::math::RayFrame;

/// How far the search may leave the leaf, in box coordinates: as far as the bounds of the
/// approximation's error hold.
const FIT_DOMAIN: f32 = crate::patch::FIT_DOMAIN as f32;

/// The distances `f₁`, `f₂` of a leaf's approximation from a ray's planes, times its weight (see
/// [`Leaf`](crate::patch::Leaf)): coefficients of `xⁱ yʲ`, `i` by vector, `j` by lane, first those
/// of `f₁`, then those of `f₂`.
#[derive(Clone, Copy)]
pub(crate) struct Distances<S: Simd> {
    pub rows: [f32x8<S>; 4],
}

impl<S: Simd> Distances<S> {
    /// The distances of the leaf's middle are computed in f64; what is added to them in f32 has the
    /// size of the leaf, so its rounding error is small compared with the leaf.
    #[simd]
    pub(crate) fn new(simd: S, fitted: Fitted<'_>, ray: &RayFrame) -> Self {
        let Fitted { leaf, weight } = fitted;
        let [n1, n2] = ray.normals;
        let offset = leaf.middle - ray.origin;
        let (e1, e2) = (n1.dot(offset) as f32, n2.dot(offset) as f32);
        let mut rows = [f32x8::splat(simd, 0.0); 4];
        for axis in 0..3 {
            let n1 = f32x4::splat(simd, n1[axis] as f32);
            let n2 = f32x4::splat(simd, n2[axis] as f32);
            let normals = n1.combine(n2);
            for i in 0..4 {
                let row = f32x4::from_slice(simd, &leaf.fit()[axis][4 * i..4 * i + 4]);
                rows[i] = normals.mul_add(row.combine(row), rows[i]);
            }
        }
        // Last, since these wait for the leaf.
        if let Some(weight) = weight {
            let middle = f32x4::splat(simd, e1).combine(f32x4::splat(simd, e2));
            for i in 0..4 {
                let row = f32x4::from_slice(simd, &weight[4 * i..4 * i + 4]);
                rows[i] = middle.mul_add(row.combine(row), rows[i]);
            }
        } else {
            rows[0] += f32x8::from_slice(simd, &[e1, 0.0, 0.0, 0.0, e2, 0.0, 0.0, 0.0]);
        }
        Self { rows }
    }

    /// The sum of the absolute values of all terms that the coefficients were added up from, for
    /// the larger of the two distances: the measure of their rounding error.
    #[simd]
    pub(crate) fn terms(self, simd: S, fitted: Fitted<'_>, ray: &RayFrame) -> f32 {
        let Fitted { leaf, weight } = fitted;
        let [n1, n2] = ray.normals;
        let mut total = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            let n1 = f32x4::splat(simd, n1[axis].abs() as f32);
            let n2 = f32x4::splat(simd, n2[axis].abs() as f32);
            let normals = n1.combine(n2);
            for i in 0..4 {
                let row = f32x4::from_slice(simd, &leaf.fit()[axis][4 * i..4 * i + 4]).abs();
                total = normals.mul_add(row.combine(row), total);
            }
        }
        let (e1, e2) = (self.rows[0][0].abs(), self.rows[0][4].abs());
        let sum =
            |first: usize| total[first] + total[first + 1] + total[first + 2] + total[first + 3];
        let weights = weight.map_or(1.0, |weight| weight.iter().map(|w| w.abs()).sum());
        (sum(0) + e1 * weights).max(sum(4) + e2 * weights)
    }

    /// Runs Newton's iteration in box coordinates, from a start there; places are the first two
    /// lanes.
    ///
    /// Sums of powers of `x` are computed on all lanes at once; they are then transposed into four
    /// powers of `y` of `f₁`, `f₂` and their derivatives by `x`. Each operation waits for the one
    /// before, so sums are made by halves (Estrin 1960): of a cubic two operations wait for each
    /// other, not three as in Horner's scheme.
    #[simd]
    pub(crate) fn newton(self, simd: S, start: f32x4<S>) -> f32x4<S> {
        let rows = &self.rows;
        let reach = f32x4::splat(simd, FIT_DOMAIN);
        let mut place = start;
        let twice = rows[2] + rows[2];
        let thrice = rows[3] * f32x8::splat(simd, 3.0);
        for _ in 0..STEPS_IN_F32 {
            let (xs, ys) = (f32x8::splat(simd, place[0]), f32x4::splat(simd, place[1]));
            let (xx, yy) = (xs * xs, ys * ys);
            let (two_y, three_yy) = (ys + ys, f32x4::splat(simd, 3.0) * yy);
            let value = rows[3].mul_add(xs, rows[2]).mul_add(xx, rows[1].mul_add(xs, rows[0]));
            let slope = thrice.mul_add(xx, twice.mul_add(xs, rows[1]));
            let [c0, c1, c2, c3] = transposed(value, slope);
            let across = c3.mul_add(ys, c2).mul_add(yy, c1.mul_add(ys, c0));
            let along_y = c3.mul_add(three_yy, c2.mul_add(two_y, c1));
            let (f1, f2, a1, a2) = (across[0], across[1], across[2], across[3]);
            let (b1, b2) = (along_y[0], along_y[1]);
            let inverse = 1.0 / (a1 * b2 - a2 * b1);
            let steps = [f1 * b2 - f2 * b1, a1 * f2 - a2 * f1, 0.0, 0.0];
            let new = place - f32x4::from_slice(simd, &steps) * f32x4::splat(simd, inverse);
            // NaN may become a bound or stay; what takes the place as its start makes it one.
            place = new.max(-reach).min(reach);
        }
        place
    }
}

/// Converts lanes by power of `y` to vectors by power of `y`, with lanes for the first and the
/// second half of both arguments.
#[inline(always)]
fn transposed<S: Simd>(value: f32x8<S>, slope: f32x8<S>) -> [f32x4<S>; 4] {
    let ((v1, v2), (s1, s2)) = (value.split(), slope.split());
    let (a, b) = (v1.zip_low(s1), v2.zip_low(s2));
    let (c, d) = (v1.zip_high(s1), v2.zip_high(s2));
    [a.zip_low(b), a.zip_high(b), c.zip_low(d), c.zip_high(d)]
}

/// Transposes both halves of four vectors; each half of all four is a matrix.
#[inline(always)]
pub(crate) fn transposed_rows<S: Simd>(rows: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let [(a, e), (b, f), (c, g), (d, h)] =
        [rows[0].split(), rows[1].split(), rows[2].split(), rows[3].split()];
    let [a, b, c, d] = transposed(a.combine(b), c.combine(d));
    let [e, f, g, h] = transposed(e.combine(f), g.combine(h));
    [a.combine(e), b.combine(f), c.combine(g), d.combine(h)]
}
