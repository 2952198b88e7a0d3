//! Proofs from a leaf's bicubic approximation about one ray.
//!
//! The certificate holds for all rays that are steep enough. More can be said of one ray, from the
//! coefficients of its own two distances `f₁`, `f₂`, times the weight: the true distances differ
//! from them by no more than the bounds of [`FitError`](crate::patch::FitError), and by rounding of
//! a few units of f32 of the sum of the coefficients' absolute values. The leaf is halved into
//! boxes until each is proved to hold no root, or at most one.
//!
//! *No root*: in a box with the derivatives `a`, `b` in its middle, let `g₁ = b × f` and
//! `g₂ = a × f`. If all Bernstein coefficients of one of them are farther from zero than the errors
//! reach, on the same side, so is that function everywhere in the box.
//!
//! *One root at most*: divided by `a × b` they become `g₁ = x + …`, `g₂ = y + …`. Between two roots
//! the mean of `g'` would be singular. With `|I − g'| ≤ R` everywhere, entry by entry, it is not
//! singular where `I − R` has an inverse `P` without negative entries; the entries of the mean's
//! inverse are then no larger than those of `P` (Ostrowski 1937). The slopes of the true distances
//! differ from the approximation's by their known error bounds.

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdFloat, SimdSplit, f32x4, f32x8};
use fearless_simd_macros::simd;

use super::bounds::{
    DISTANCE_ROUNDING, GROWN, LARGEST, LeafPart, MAY_STEP, MOST_INVERSE, MOST_NOISE, SMALLEST,
    START_GROWN, UNDERFLOW, shows,
};
use super::cubic::{bernstein, moved, slope_weights};
use crate::intersect::wide::search::one_ray::{Distances, transposed_rows};
use crate::intersect::wide::view::Fitted;
use crate::math::{RayFrame, rounding};

/// The largest number of boxes to examine before the scalar search is called, which takes as long
/// as about thirty.
const MOST_BOXES: usize = 24;

/// The largest number of boxes with a root each: a ray that needs more is rare.
const MOST_UNIQUE: usize = 4;

/// Parts that hold at most one root each.
#[derive(Debug, Default)]
pub(crate) struct UniqueParts {
    parts: [LeafPart; MOST_UNIQUE],
    count: usize,
}

impl UniqueParts {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &LeafPart> {
        self.parts[..self.count].iter()
    }
}

/// Isolates all roots of a leaf except the one the ray starts on, each in a part of its own; `None`
/// where that cannot be proved. `start` is the place of that root in box coordinates, if it lies in
/// the leaf; `error` is the error bound of a point's distance from the ray.
#[simd]
pub(crate) fn isolate<S: Simd>(
    simd: S,
    distances: Distances<S>,
    fitted: Fitted<'_>,
    ray: &RayFrame,
    start: Option<[f32; 2]>,
    error: f64,
) -> Option<UniqueParts> {
    let leaf = fitted.leaf;
    let weighted = error * f64::from(fitted.heaviest());
    let mut unique = UniqueParts::default();
    let lengths = leaf.half_side_lengths();
    // Coefficients come from sums in which most terms may cancel, and a small box has the errors of
    // the large one it was cut from. So rounding is measured by all terms of the whole leaf, and
    // nothing is proved of leaves thinner than f32 can resolve.
    let terms = distances.terms(simd, fitted, ray);
    let in_range = terms <= LARGEST; // false for NaN
    let noise = DISTANCE_ROUNDING * terms;
    if !(in_range && shows(noise, lengths)) {
        return None;
    }
    // A ray that passes within the error of a border meets it: what is closer than this is not
    // missed.
    let off_ray = leaf.fit_error() + noise + rounding::f32_above(weighted);
    // The whole leaf shows little more than its certificate says.
    let mut waiting = [LeafPart::default(); MOST_BOXES];
    waiting[..2].copy_from_slice(&LeafPart::whole().halved(lengths));
    let mut count = 2;
    for _ in 0..MOST_BOXES {
        if count == 0 {
            return Some(unique);
        }
        count -= 1;
        let part = waiting[count];
        let local = distances.over(simd, &part);
        if local.is_missed(simd, off_ray) {
            continue;
        }
        let slope_error = (leaf.slope_error() + 2.0 * noise) * part.half[0].max(part.half[1]);
        let unhalved = part.half[0] > SMALLEST && part.half[1] > SMALLEST;
        let elsewhere = unhalved && local.leads_away();
        if !elsewhere && local.is_unique(simd, slope_error, rounding::f32_above(weighted)) {
            if start.is_some_and(|start| part.holds(start, START_GROWN)) {
                continue;
            }
            if unique.count == MOST_UNIQUE {
                return None;
            }
            unique.parts[unique.count] = part;
            unique.count += 1;
            continue;
        }
        if count + 2 > MOST_BOXES {
            return None;
        }
        for half in part.halved(lengths) {
            waiting[count] = half;
            count += 1;
        }
    }
    (count == 0).then_some(unique)
}

/// The distances over a part, in coordinates from −1 to 1: coefficients of `xⁱ yʲ`, `j` by
/// vector, `i` by lane, first those of `f₁`, then those of `f₂`.
#[derive(Clone, Copy)]
pub(super) struct Local<S: Simd> {
    columns: [f32x8<S>; 4],
    /// The sum of the absolute values of all coefficients.
    size: f32,
    /// The derivatives in the middle.
    along_x: [f32; 2],
    along_y: [f32; 2],
}

impl<S: Simd> Distances<S> {
    #[simd]
    pub(super) fn over(self, simd: S, part: &LeafPart) -> Local<S> {
        let along =
            |k: usize| (f32x8::splat(simd, part.middle[k]), f32x8::splat(simd, part.half[k]));
        let rows = moved(simd, self.rows, along(0));
        let columns = moved(simd, transposed_rows(rows), along(1));
        let sizes = columns[0].abs() + columns[1].abs() + (columns[2].abs() + columns[3].abs());
        let [low, high] = halves(sizes);
        Local {
            columns,
            size: low + high,
            along_x: [columns[0][1], columns[0][5]],
            along_y: [columns[1][0], columns[1][4]],
        }
    }
}

impl<S: Simd> Local<S> {
    /// Whether there is no root in the part; `error` is the error bound of the distances.
    #[simd]
    pub(super) fn is_missed(self, simd: S, error: f32) -> bool {
        let ([a1, a2], [b1, b2]) = (self.along_x, self.along_y);
        let columns = self.combined(simd, [b2, a2], [b1, a1]);
        let rows = transposed_rows(bernstein(simd, columns));
        let [c0, c1, c2, c3] = bernstein(simd, rows);
        let least = c0.min(c1).min(c2.min(c3));
        let most = c0.max(c1).max(c2.max(c3));
        let off = [error * (b1.abs() + b2.abs()), error * (a1.abs() + a2.abs())];
        let off = [off[0] + UNDERFLOW, off[1] + UNDERFLOW];
        let mut missed = false;
        for k in 0..2 {
            let (mut low, mut high) = (least[4 * k], most[4 * k]);
            for lane in 4 * k + 1..4 * k + 4 {
                low = low.min(least[lane]);
                high = high.max(most[lane]);
            }
            missed |= low > off[k] || high < -off[k];
        }
        missed
    }

    /// Whether Newton's step from the middle leads out of the part, where the iteration for the
    /// part's one root could not follow; its halves can be proved to be missed.
    #[inline(always)]
    pub(super) fn leads_away(&self) -> bool {
        let ([a1, a2], [b1, b2]) = (self.along_x, self.along_y);
        let (f1, f2) = (self.columns[0][0], self.columns[0][4]);
        let farthest = MAY_STEP * (a1 * b2 - a2 * b1).abs();
        (f1 * b2 - f2 * b1).abs() > farthest || (a1 * f2 - a2 * f1).abs() > farthest
    }

    /// Whether there is at most one root in the widened part.
    #[simd]
    pub(super) fn is_unique(self, simd: S, slope_error: f32, error: f32) -> bool {
        let ([a1, a2], [b1, b2]) = (self.along_x, self.along_y);
        let inverse = 1.0 / (a1 * b2 - a2 * b1);
        let [a1, a2, b1, b2] = [a1 * inverse, a2 * inverse, b1 * inverse, b2 * inverse];
        let columns = self.combined(simd, [b2, -a2], [b1, -a1]);
        let mut slopes = [f32x8::splat(simd, 0.0); 2];
        for j in 0..4 {
            let size = columns[j].abs();
            for (slopes, weights) in slopes.iter_mut().zip(&SLOPE_WEIGHTS) {
                *slopes = size.mul_add(f32x8::from_slice(simd, &weights[j]), *slopes);
            }
        }
        let ([xx, yx], [xy, yy]) = (halves(slopes[0]), halves(slopes[1]));
        let slope_error = slope_error + 2.0 * DISTANCE_ROUNDING * self.size;
        let reach = [b1.abs() + b2.abs(), a1.abs() + a2.abs()];
        let off = [reach[0] * slope_error, reach[1] * slope_error];
        // The sums contain the 1 that is wanted on the diagonal of `g'`, hence the two. Rounding may
        // have made it less, by some 6 units of the noise's sizes, so that twice that is missing:
        // of what is allowed for noise, the 16 units of the Bernstein coefficients, which are not
        // used here, make up for it. All are false for NaN.
        let (left_x, left_y) = (2.0 - xx - off[0], 2.0 - yy - off[1]);
        let (xy, yx) = (xy + off[0], yx + off[1]);
        let sure = (left_x * left_y - xy * yx) * MOST_INVERSE;
        let regular = left_x > 0.0 && left_y > 0.0 && sure > left_y + xy && sure > left_x + yx;
        regular && reach.iter().all(|reach| reach * error <= MOST_NOISE)
    }

    /// `pₖ f₁ − qₖ f₂` in the place of `fₖ`.
    #[inline(always)]
    fn combined(self, simd: S, [p1, p2]: [f32; 2], [q1, q2]: [f32; 2]) -> [f32x8<S>; 4] {
        let p = f32x4::splat(simd, p1).combine(f32x4::splat(simd, p2));
        let q = f32x4::splat(simd, q1).combine(f32x4::splat(simd, q2));
        let mut columns = self.columns;
        for column in &mut columns {
            let (f1, f2) = column.split();
            *column = p * f1.combine(f1) - q * f2.combine(f2);
        }
        columns
    }
}

/// `i GROWNⁱ⁺ʲ⁻¹` by `x`, and `j GROWNⁱ⁺ʲ⁻¹` by `y`, for both distances: `j` by vector, `i` by
/// lane.
const SLOPE_WEIGHTS: [[[f32; 8]; 4]; 2] = {
    let mut weights = [[[0.0; 8]; 4]; 2];
    let mut k = 1;
    while k < 16 {
        let (i, j) = (k / 4, k % 4);
        let by = slope_weights(i, j, GROWN);
        let mut direction = 0;
        while direction < 2 {
            weights[direction][j][i] = by[direction];
            weights[direction][j][i + 4] = by[direction];
            direction += 1;
        }
        k += 1;
    }
    weights
};

/// The sums of the lower and the upper four lanes.
#[inline(always)]
fn halves<S: Simd>(v: f32x8<S>) -> [f32; 2] {
    [v[0] + v[1] + (v[2] + v[3]), v[4] + v[5] + (v[6] + v[7])]
}
