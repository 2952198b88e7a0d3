//! How far a leaf's bicubic approximation may be from the true surface.
//!
//! Over the leaf's widened rectangle `D`, in box coordinates `x, y` (half sides), let `S` be
//! the surface and `Q` the approximation, both relative to the leaf's middle.
//!
//! *Quotients.* For pieces of degree up to three whose weights differ, the numerators `X` and the
//! weights `W` are approximated, both exactly except for rounding. The bounds are for
//! `F = n · X + m W` with a unit vector `n`, and `m` no larger than the distance at which rays pass
//! the middle, or than the length of `S` in `D`. So `E`, the slopes' bound and `M` are those of a
//! polynomial whose coefficients are as large as those of `X` and `m W` together. `M` also bounds
//! `S`, and `T` bounds `S` alone. All other approximations are polynomials `Q`; in what follows,
//! `X` and `W` are the surface's own:
//!
//! *Values.* With `S = X / W`, the polynomial `X − W Q` has a Bernstein form; the largest of
//! its coefficients over the least weight bounds `|S − Q|` by `E`.
//!
//! *Derivatives.* A derivative of order `k` is a form `D[h₁, …, hₖ]` in directions `hᵢ`, whose
//! larger components are at most 1 here. So it is at most the sum of its `2ᵏ` entries, and the
//! differences of the net bound that sum: by `Xₖ` for `X`, and by `Wₖ` for `W`. Leibniz's rule for
//! `X = S W` then gives bounds `Sₖ` for `S` on `D`, where `S₀` is the largest distance of a control
//! point from the middle and `w` the least weight:
//!
//! `w Sₖ = Xₖ + S₀ Wₖ + Σ C(k, i) Sᵢ Wₖ₋ᵢ`, over `i = 1 … k − 1`.
//!
//! By Taylor's theorem along the segment from `x` to `x + h` in `D`, with `M = S₂ / 2`,
//! `T = S₃ / 6`:
//!
//! `|S(x + h) − S(x) − S'(x) h| ≤ M |h|²`, `|S(x + h) − S(x) − S'(x) h − ½ S''(x)[h, h]| ≤ T |h|³`,
//! and, summed over the directions `e` of both sides, because each entry of a form counts once in
//! such a sum, `Σ |S'(x + h) e − S'(x) e − S''(x)[h, e]| ≤ 3 T |h|²`, `Σ |S''(x)[h, e]| ≤ 2 M |h|`.
//!
//! *Slopes.* With `R = X − W Q` the slopes of `S` and `Q` differ by `(R' − (R / W) W') / W`. The
//! degree times the longest difference of neighbouring Bernstein coefficients bounds `R'`, and
//! `W'` likewise; `R / W` is at most `E`.

use glam::{DVec3, DVec4};
use smallvec::SmallVec;

use super::bicubic::{Fit, in_both_directions};
use crate::math::bernstein::binomials;
use crate::patch::Piece;
use crate::patch::parts::part::PartNet;

/// The bounds hold up to this far from the middle, in box coordinates: Newton's steps may stray
/// there.
pub(crate) const FIT_DOMAIN: f64 = 1.2;

/// The side of the rectangle on which the bounds hold, in box coordinates.
const SIDE: f64 = 2.0 * FIT_DOMAIN;

/// Bounds of a bicubic approximation, in scene units; for quotients those of `F`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitError {
    /// `E`.
    pub value: f64,
    /// Of either partial derivative.
    pub slope: f64,
    /// `M`, of `F` and of the surface.
    pub bend: f64,
    /// `T`, of the surface.
    pub third: f64,
}

impl FitError {
    /// Nothing is known.
    const UNKNOWN: Self = Self {
        value: f64::INFINITY,
        slope: f64::INFINITY,
        bend: f64::INFINITY,
        third: f64::INFINITY,
    };

    /// The bounds for a part of a piece and its approximation; infinite where nothing is known.
    pub(super) fn new(part_net: &PartNet, piece: &Piece, middle: DVec3, fit: &Fit) -> Self {
        let patch = &piece.patch;
        let degree = patch.degree();
        let more = 0.5 * (FIT_DOMAIN - 1.0);
        let mut net = part_net.grown(piece, [-more, 1.0 + more], [-more, 1.0 + more]);
        for c in &mut net {
            *c = (c.truncate() - c.w * middle).extend(c.w);
        }
        let least = net.iter().map(|c| c.w).fold(f64::INFINITY, f64::min);
        let heaviest = net.iter().map(|c| c.w).fold(0.0, f64::max);
        let positive = least > 0.0; // false for NaN
        if !positive {
            return Self::UNKNOWN;
        }

        // Restricting a net to part of its square moves coefficients by about 4 (p + q) u, times
        // the heaviest weight; enlarging it multiplies their errors by up to `FIT_DOMAINᵖ⁺q`.
        let grown = 0.25 * FIT_DOMAIN.powi((degree[0] + degree[1]) as i32);
        let noise = 4.0 * patch.noise() * grown.max(1.0) * (heaviest / least);
        let [farthest, along] = difference(degree, &net, &in_bernstein_form(fit));
        let value = farthest / least + noise;
        // Differences of order k are off by 2ᵏ times `noise`, and the factors of all of them add up
        // to (p + q)ᵏ at most: 2² / (2 · SIDE²) is less than 0.35, 2³ / (6 · SIDE³) less than 0.1.
        let sum = (degree[0] + degree[1]) as f64;
        let [slope_of_weight, bend, third] = derivatives(degree, &net, least);
        let bend = bend + noise * (0.35 * sum * sum).max(1.0);
        let third = third + noise * (0.1 * sum * sum * sum).max(1.0);
        // Differences of coefficients that rounding has moved by `noise` each.
        let rounding = 2.0 * (degree[0].max(degree[1]) + 3) as f64 * noise;
        let slope = (along + value * slope_of_weight) / least + rounding;
        if value.is_finite() && slope.is_finite() {
            Self { value, slope, bend, third }
        } else {
            Self::UNKNOWN
        }
    }
}

impl FitError {
    /// The bounds for a polynomial that differs from its approximation only by the rounding of each
    /// coefficient to f32, by 2⁻²⁴ of the coefficient or the least number of f32: from the `sizes`
    /// of the coefficients of `xⁱ yʲ` and their error bound `noise`.
    pub(super) fn of_polynomial(sizes: &[[f64; 4]; 4], noise: f64) -> Self {
        let [value, slope, second, third, _] = derivative_sums(sizes);
        // Larger coefficients are infinite in f32.
        let in_range = value <= f64::from(f32::MAX); // false for NaN
        if !in_range {
            return Self::UNKNOWN;
        }
        // The sum of `FIT_DOMAINⁱ⁺ʲ` is 29, that of `(i + j) FIT_DOMAINⁱ⁺ʲ⁻¹` is 83; the sums for
        // lengths of vectors are √3 times as large.
        let least = f64::from(f32::MIN_POSITIVE);
        let rounding = |sum: f64| 0.5 * f64::from(f32::EPSILON) * sum + 160.0 * least;
        let (value, slope) = (rounding(value) + noise, rounding(slope) + 96.0 * noise);
        // In Bernstein form coefficients are off by a quarter of the noise. Up to a tenth of a side
        // beyond both of its ends, that error grows by `FIT_DOMAIN` to the power of the degree; and
        // derivatives are off by `p / 2` and `p (p − 1) / 4` times its first and second
        // differences. Second derivatives, entry by entry as forms, are then off by 16 times the
        // noise at most, third ones by 52 times.
        let (bend, third) = (0.5 * second + 8.0 * noise, third / 6.0 + 30.0 * noise);
        Self { value, slope, bend, third }
    }

    /// The same for a quotient: the bounds are for `F` of rays that pass the middle within `reach`,
    /// except that `bend` also bounds the second derivatives of the surface, and `third` bounds its
    /// third. The sizes are those of the coefficients of the numerators and of the weights, which
    /// are at least `least`; `in_middle` holds the sizes, as forms, of the surface and of its first
    /// three derivatives in the middle.
    pub(super) fn of_quotient(
        [points, weights]: &[[[f64; 4]; 4]; 2],
        (in_middle, least): ([f64; 4], f64),
        reach: f64,
        noise: f64,
    ) -> Self {
        let (of_points, of_weights) = (derivative_sums(points), derivative_sums(weights));
        let mut known = [of_points[0] / least, 0.0, 0.0, 0.0, 0.0];
        for order in 1..=4 {
            known[order] = by_leibniz(order, &known, (&of_points, &of_weights), least);
        }
        // Where terms that are bounded one by one cancel in the middle, they do so nearby, too.
        for _ in 0..2 {
            for order in (0..=3).rev() {
                known[order] = known[order].min(in_middle[order] + FIT_DOMAIN * known[order + 1]);
            }
            for order in 1..=4 {
                let all = by_leibniz(order, &known, (&of_points, &of_weights), least);
                known[order] = known[order].min(all);
            }
        }

        // Not `max`, which would replace NaN, the reach of a box without a size, by the bound.
        let reach = if known[0] > reach { known[0] } else { reach };
        let mut both = *points;
        for (sum, weight) in both.as_flattened_mut().iter_mut().zip(weights.as_flattened()) {
            *sum += reach * weight;
        }
        let of_f = Self::of_polynomial(&both, noise);
        if of_f.value == f64::INFINITY {
            return Self::UNKNOWN;
        }
        // The errors of coefficients enter each of these as often as they enter `F`, times a few.
        let bend = of_f.bend.max(0.5 * known[2] + 32.0 * noise);
        Self { bend, third: known[3] / 6.0 + 120.0 * noise, ..of_f }
    }
}

/// Bounds of a polynomial and its first to fourth derivatives, as forms, from the sizes of its
/// coefficients of `xⁱ yʲ`.
fn derivative_sums(sizes: &[[f64; 4]; 4]) -> [f64; 5] {
    let mut sums = [0.0; 5];
    for (i, row) in sizes.iter().enumerate() {
        for (j, size) in row.iter().enumerate() {
            let mut factor = *size;
            for (order, sum) in sums.iter_mut().enumerate().take(i + j + 1) {
                *sum += factor * REACHES[i + j - order];
                factor *= (i + j - order) as f64;
            }
        }
    }
    sums
}

/// [`FIT_DOMAIN`]`ᵏ`.
pub(super) const REACHES: [f64; 7] = {
    let mut powers = [1.0; 7];
    let mut k = 1;
    while k < powers.len() {
        powers[k] = powers[k - 1] * FIT_DOMAIN;
        k += 1;
    }
    powers
};

/// The bound `Sₖ` from those of lower order, and from those of `X` and `W`, with the least weight.
fn by_leibniz<const N: usize>(
    order: usize,
    lower: &[f64; N],
    (of_points, of_weights): (&[f64; N], &[f64; N]),
    least: f64,
) -> f64 {
    let binomials = binomials(order);
    let terms = (0..order).map(|k| binomials[k] * lower[k] * of_weights[order - k]);
    (of_points[order] + terms.sum::<f64>()) / least
}

/// The Bernstein coefficients of the approximation over the widened rectangle.
fn in_bernstein_form(fit: &Fit) -> [[DVec3; 4]; 4] {
    let mut powers = [[DVec3::ZERO; 4]; 4];
    for k in 0..16 {
        powers[k / 4][k % 4] = DVec3::from_array([0, 1, 2].map(|axis| f64::from(fit[axis][k])));
    }
    in_both_directions(&BLOSSOM, &powers)
}

/// The Bernstein coefficient `i` of `xᵏ` in the cubic form on `[−FIT_DOMAIN, FIT_DOMAIN]`: the mean
/// of all products of `k` out of three values, of which `i` are the upper end and the others the
/// lower.
pub(super) const BLOSSOM: [[f64; 4]; 4] = {
    let mut blossom = [[0.0; 4]; 4];
    let mut i = 0;
    while i < 4 {
        let a = if i > 0 { FIT_DOMAIN } else { -FIT_DOMAIN };
        let b = if i > 1 { FIT_DOMAIN } else { -FIT_DOMAIN };
        let c = if i > 2 { FIT_DOMAIN } else { -FIT_DOMAIN };
        blossom[i] = [1.0, (a + b + c) / 3.0, (a * b + b * c + c * a) / 3.0, a * b * c];
        i += 1;
    }
    blossom
};

/// Bounds of `X − W Q` and of its derivatives by box coordinates.
fn difference(degree: [usize; 2], net: &[DVec4], fit: &[[DVec3; 4]; 4]) -> [f64; 2] {
    let (difference, columns) = difference_net(degree, net, fit);
    let [mut value, mut down, mut across] = [0f64; 3];
    for here in &difference {
        value = value.max(here.length_squared());
    }
    for (here, &below) in difference.iter().zip(&difference[columns..]) {
        down = down.max((below - here).length_squared());
    }
    for row in difference.chunks_exact(columns) {
        for (here, &next) in row.iter().zip(&row[1..]) {
            across = across.max((next - here).length_squared());
        }
    }
    let [p, q] = degree.map(|degree| (degree + 3) as f64);
    let slope = (p * down.sqrt()).max(q * across.sqrt());
    [value.sqrt(), slope / SIDE]
}

/// The Bernstein coefficients of `X − W Q`, and how many there are in a row.
///
/// Scaled by binomials, Bernstein coefficients multiply like power coefficients (Farouki and Rajan
/// 1988, "Algorithms for polynomials in Bernstein form"): those of a product with a cubic are
/// `C(p + 3, m) rₘ = Σ C(p, i) xᵢ C(3, m − i) q₍ₘ₋ᵢ₎`.
fn difference_net(
    [p, q]: [usize; 2],
    net: &[DVec4],
    fit: &[[DVec3; 4]; 4],
) -> (SmallVec<[DVec3; 64]>, usize) {
    const CUBIC: [f64; 4] = [1.0, 3.0, 3.0, 1.0];
    let (in_s, in_t) = (binomials(p), binomials(q));
    let (of_s, of_t) = (binomials(p + 3), binomials(q + 3));
    let mut scaled_fit = *fit;
    for (k, row) in scaled_fit.iter_mut().enumerate() {
        for (l, point) in row.iter_mut().enumerate() {
            *point *= CUBIC[k] * CUBIC[l];
        }
    }
    let columns = q + 4;
    let mut difference = SmallVec::from_elem(DVec3::ZERO, (p + 4) * columns);
    for (i, row) in net.chunks_exact(q + 1).enumerate() {
        for (j, &control) in row.iter().enumerate() {
            let control = in_s[i] * in_t[j] * control;
            for (k, fit) in scaled_fit.iter().enumerate() {
                let x = CUBIC[k] * control.truncate();
                let from = (i + k) * columns + j;
                for (l, sum) in difference[from..from + 4].iter_mut().enumerate() {
                    *sum += CUBIC[l] * x - control.w * fit[l];
                }
            }
        }
    }
    for (m, row) in difference.chunks_exact_mut(columns).enumerate() {
        for (n, coefficient) in row.iter_mut().enumerate() {
            *coefficient *= 1.0 / (of_s[m] * of_t[n]);
        }
    }
    (difference, columns)
}

/// Three bounds for a net of `(w (P − c), w)`, by box coordinates: of either first derivative of
/// the weight, `M` and `T`.
fn derivatives([p, q]: [usize; 2], net: &[DVec4], least: f64) -> [f64; 3] {
    // Of points and of weights, by order; and the larger of the weight's two slopes.
    let (mut of_points, mut of_weights, mut slope) = ([0.0; 4], [0.0; 4], 0f64);
    let mut rows: SmallVec<[DVec4; 36]> = SmallVec::from_slice(net);
    // By s `i` times, …
    for i in 0..=p.min(3) {
        if i > 0 {
            differences(&mut rows, (q + 1, (p + 1 - i) as f64));
        }
        let mut room = rows.clone();
        // … and by t `j` times.
        for j in 0..=q.min(3 - i) {
            if j > 0 {
                // Rows keep their length; differences that run from one row into the next are left
                // out below.
                differences(&mut room, (1, (q + 1 - j) as f64));
            }
            if i + j == 0 {
                continue;
            }
            let (mut points, mut weights) = (0f64, 0f64);
            for (k, c) in room.iter().enumerate() {
                if k % (q + 1) <= q - j {
                    points = points.max(c.truncate().length_squared());
                    weights = weights.max(c.w.abs());
                }
            }
            // The number of entries of the form that equal this one.
            let order = i + j;
            let alike = if i > 0 && j > 0 { order as f64 } else { 1.0 };
            of_points[order] += alike * points.sqrt();
            of_weights[order] += alike * weights;
            if order == 1 {
                slope = slope.max(weights);
            }
        }
    }
    let radius = net.iter().map(|c| c.project().length_squared()).fold(0.0, f64::max);
    let radius = radius.sqrt();
    let mut known = [radius, 0.0, 0.0, 0.0];
    for order in 1..=3 {
        known[order] = by_leibniz(order, &known, (&of_points, &of_weights), least);
    }
    // From sides of the rectangle to half sides of the leaf.
    let [.., s2, s3] = known;
    [slope / SIDE, s2 / (2.0 * SIDE * SIDE), s3 / (6.0 * SIDE * SIDE * SIDE)]
}

/// Differences of the points that are `step` apart, times a factor, in place; there are `step`
/// fewer of them.
fn differences(points: &mut SmallVec<[DVec4; 36]>, (step, factor): (usize, f64)) {
    let left = points.len() - step;
    for k in 0..left {
        points[k] = factor * (points[k + step] - points[k]);
    }
    points.truncate(left);
}

#[cfg(test)]
mod tests;
