//! How far a leaf's bicubic approximation may be from the true surface.
//!
//! Over the leaf's widened rectangle `D`, in box coordinates `x, y` (half sides), let `S` be
//! the surface and `Q` the approximation, both relative to the leaf's middle.
//!
//! *Values.* With `S = X / W`, the polynomial `X − W Q` has a Bernstein form; the largest of
//! its coefficients over the least weight bounds `|S − Q|` by `E`.
//!
//! *Bend.* For `x` and `x + h` in `D` and `|h|` the larger component, put `Y = X − S(x) W`.
//! Then `Y(x) = 0`, `Y'(x) h = W(x) S'(x) h`, and
//! `S(x + h) − S(x) − S'(x) h = (½ Y''(ξ)[h, h] + S'(x) h (W(x) − W(x + h))) / W(x + h)`:
//! at most `M |h|²`, with second and first differences of the net for the derivatives. For the
//! polynomial `Q` the like holds with a bound `M_Q` from its coefficients.
//!
//! *Slopes.* Along either coordinate and for any step `r` that stays in `D`, the slopes of `S`
//! and `Q` differ from their difference quotients by at most `M r` and `M_Q r`, and those from
//! each other by `2 E / r`. The best `r` makes it `2 √(2 E (M + M_Q))`.

use glam::{DVec3, DVec4};
use smallvec::SmallVec;

use crate::math::bernstein;
use crate::patch::{Leaf, Piece};

/// How far the bounds hold, in box coordinates: Newton's steps may stray there.
pub(super) const REACH: f64 = 1.2;

/// Bounds of a bicubic approximation, in scene units.
#[derive(Clone, Copy, Debug)]
pub(super) struct FitError {
    /// `E`.
    pub(super) value: f64,
    /// Of either partial derivative.
    pub(super) slope: f64,
    /// `M`.
    pub(super) bend: f64,
}

impl FitError {
    /// The bounds for a leaf and the coefficients of `xⁱ yʲ` at `4 i + j`, coordinate by
    /// coordinate; infinite where nothing is known.
    pub(super) fn new(leaf: &Leaf, piece: &Piece, middle: DVec3, fit: &[[f32; 16]; 3]) -> Self {
        let unknown = Self { value: f64::INFINITY, slope: f64::INFINITY, bend: f64::INFINITY };
        let patch = &piece.patch;
        let degree = patch.degree();
        let mut net: SmallVec<[DVec4; 16]> = patch.control().collect();
        let [s, t] = leaf.rect.map(|[from, to]| {
            let more = 0.5 * (REACH - 1.0) * (to - from);
            [from - more, to + more]
        });
        bernstein::restrict_net(&mut net, degree, s, t);
        for c in &mut net {
            *c = (c.truncate() - c.w * middle).extend(c.w);
        }
        let least = net.iter().map(|c| c.w).fold(f64::INFINITY, f64::min);
        let positive = least > 0.0; // false for NaN
        if !positive {
            return unknown;
        }

        let noise = 4.0 * patch.residual_factor() * patch.magnitude();
        let value = farthest(degree, &net, &in_bernstein_form(fit)) / least + noise;
        let bend = bend(degree, &net, least) + noise;
        let both = bend + fit_bend(fit);
        let step = (2.0 * value / both).sqrt().min(REACH);
        let slope = 2.0 * value / step + both * step;
        if value.is_finite() && slope.is_finite() { Self { value, slope, bend } } else { unknown }
    }
}

/// The Bernstein coefficients of the approximation over the widened rectangle.
///
/// The coefficient `i` of `xᵏ` in the cubic form is the mean of all products of `k` out of
/// three values, of which `i` are the upper end of the range and the others the lower.
fn in_bernstein_form(fit: &[[f32; 16]; 3]) -> [[DVec3; 4]; 4] {
    let mut blossom = [[0.0; 4]; 4];
    for (i, row) in blossom.iter_mut().enumerate() {
        let end = |k: usize| if k < i { REACH } else { -REACH };
        let [a, b, c] = [end(0), end(1), end(2)];
        *row = [1.0, (a + b + c) / 3.0, (a * b + b * c + c * a) / 3.0, a * b * c];
    }
    let mut net = [[DVec3::ZERO; 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            for k in 0..4 {
                for l in 0..4 {
                    let at = |axis: usize| f64::from(fit[axis][4 * k + l]);
                    net[i][j] += blossom[i][k] * blossom[j][l] * DVec3::new(at(0), at(1), at(2));
                }
            }
        }
    }
    net
}

/// The longest Bernstein coefficient of `X − W Q`.
fn farthest([p, q]: [usize; 2], net: &[DVec4], fit: &[[DVec3; 4]; 4]) -> f64 {
    let (along_s, along_t) = (product_weights(p), product_weights(q));
    let mut difference = vec![DVec3::ZERO; (p + 4) * (q + 4)];
    for i in 0..=p {
        for j in 0..=q {
            let control = net[i * (q + 1) + j];
            let x = control.truncate();
            for k in 0..4 {
                for l in 0..4 {
                    let weight = along_s[i][k] * along_t[j][l];
                    difference[(i + k) * (q + 4) + j + l] += weight * (x - control.w * fit[k][l]);
                }
            }
        }
    }
    difference.iter().map(|d| d.length()).fold(0.0, f64::max)
}

/// The factors of products of coefficients in the product of a polynomial of degree `p` and a
/// cubic: `C(p, i) C(3, k) / C(p + 3, i + k)`.
fn product_weights(p: usize) -> Vec<[f64; 4]> {
    let row = |n: usize| {
        let mut row = vec![1.0];
        for k in 0..n {
            row.push(row[k] * (n - k) as f64 / (k + 1) as f64);
        }
        row
    };
    let (low, three, product) = (row(p), row(3), row(p + 3));
    let weights = |i: usize| [0, 1, 2, 3].map(|k| low[i] * three[k] / product[i + k]);
    (0..=p).map(weights).collect()
}

/// The bound `M` of a net of `(w (P − c), w)`.
fn bend([p, q]: [usize; 2], net: &[DVec4], least: f64) -> f64 {
    let at = |i: usize, j: usize| net[i * (q + 1) + j];
    let (mut first, mut second) = ((0f64, 0f64), (0f64, 0f64));
    let larger = |sum: &mut (f64, f64), c: DVec4, factor: f64| {
        let (x, w) = (factor * c.truncate().length(), factor * c.w.abs());
        *sum = (sum.0.max(x), sum.1.max(w));
    };
    let (pf, qf) = (p as f64, q as f64);
    let mut sums = [(0.0, 0.0); 5];
    for i in 0..=p {
        for j in 0..=q {
            let here = at(i, j);
            if i < p {
                larger(&mut sums[0], at(i + 1, j) - here, pf);
            }
            if j < q {
                larger(&mut sums[1], at(i, j + 1) - here, qf);
            }
            if i + 2 <= p {
                let bent = at(i + 2, j) - 2.0 * at(i + 1, j) + here;
                larger(&mut sums[2], bent, pf * (pf - 1.0));
            }
            if j + 2 <= q {
                let bent = at(i, j + 2) - 2.0 * at(i, j + 1) + here;
                larger(&mut sums[3], bent, qf * (qf - 1.0));
            }
            if i < p && j < q {
                let twist = at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + here;
                larger(&mut sums[4], twist, 2.0 * pf * qf);
            }
        }
    }
    for (x, w) in &sums[..2] {
        first = (first.0 + x, first.1 + w);
    }
    for (x, w) in &sums[2..] {
        second = (second.0 + x, second.1 + w);
    }
    let radius = net.iter().map(|c| c.truncate().length() / c.w).fold(0.0, f64::max);
    let slope = (first.0 + radius * first.1) / least;
    let bound = (0.5 * (second.0 + radius * second.1) + slope * first.1) / least;
    // From sides of the rectangle to half sides of the leaf.
    bound / (2.0 * REACH).powi(2)
}

/// The bound `M_Q`.
fn fit_bend(fit: &[[f32; 16]; 3]) -> f64 {
    let mut bound = 0.0;
    for k in 0..16 {
        let power = k / 4 + k % 4;
        if power >= 2 {
            let at = |axis: usize| f64::from(fit[axis][k]);
            let size = DVec3::new(at(0), at(1), at(2)).length();
            let second = (power * (power - 1)) as f64 * REACH.powi(power as i32 - 2);
            bound += 0.5 * size * second;
        }
    }
    bound
}
