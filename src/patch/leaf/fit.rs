//! Bicubic approximations of leaves.

use glam::{DVec3, DVec4};

use super::bicubic::{Fit, NO_WEIGHT, WeightFit, in_both_directions, second_derivatives};
use super::fit_error::{BLOSSOM, FitError};
use crate::patch::Piece;
use crate::patch::parts::part::PartNet;
use crate::patch::pieces::grid::points_at;
use crate::patch::pieces::powers::powers;
use crate::patch::pieces::tensor::euclidean;

/// Weights are approximated where they are at most this many times the weight in the middle of the
/// leaf, and at least one over that, everywhere that the bounds of [`FitError`] hold.
pub(crate) const MOST_WEIGHT: f32 = 4.0;

/// A leaf's bicubic approximation.
pub(super) struct Approximation {
    /// The point that the approximation is relative to: its own value in the middle.
    pub(super) middle: DVec3,
    pub(super) fit: Fit,
    pub(super) weight: WeightFit,
    /// The vectors across the middle of the leaf, in `s` and in `t`.
    pub(super) chords: [DVec3; 2],
    /// For pieces of degree up to three, whose approximations are as exact as f32.
    exact: Option<Quotient>,
}

impl Approximation {
    /// Approximates a polynomial of degree up to three by that polynomial, a quotient of two by
    /// that quotient if its weights differ little enough ([`MOST_WEIGHT`]), and everything else by
    /// a polynomial near the surface.
    pub(super) fn new(part_net: &PartNet, piece: &Piece) -> Self {
        let [p, q] = piece.patch.degree();
        let quotient = if p.max(q) <= 3 { Quotient::new(part_net, piece) } else { None };
        quotient.map_or_else(|| Self::polynomial(part_net, piece), Self::exact)
    }

    /// A polynomial near the surface.
    pub(super) fn polynomial(part_net: &PartNet, piece: &Piece) -> Self {
        // The bicubic polynomial through 4 × 4 Chebyshev points is near the best approximation
        // (Trefethen 2013, ch. 16).
        let nodes = NODES.map(|node| 0.5 * (1.0 + node));
        let mut values = points_at(nodes, piece.patch.degree(), part_net.net());
        let some = values[1][1];
        for value in values.as_flattened_mut() {
            *value -= some;
        }
        let coefficients = in_both_directions(&INTERPOLATION, &values);
        let coefficients = coefficients.map(|row| row.map(|c| c.extend(0.0)));
        let middle = some + coefficients[0][0].truncate();
        let (fit, weight) = rounded(&coefficients);
        Self { middle, fit, weight, chords: chords(&coefficients), exact: None }
    }

    fn exact(quotient: Quotient) -> Self {
        let coefficients = &quotient.coefficients;
        let ((fit, weight), chords) = (rounded(coefficients), chords(coefficients));
        Self { middle: quotient.middle, fit, weight, chords, exact: Some(quotient) }
    }

    /// The error bounds for rays that pass the middle within `reach`.
    pub(super) fn error(&self, part_net: &PartNet, piece: &Piece, reach: f64) -> FitError {
        match &self.exact {
            Some(quotient) => quotient.error(reach),
            None => FitError::new(part_net, piece, self.middle, &self.fit),
        }
    }
}

/// A piece of degree up to three over a leaf: a bicubic polynomial, divided by another one where
/// weights differ.
///
/// A polynomial alone deviates from a leaf as much as its weights differ: by a few percent of the
/// leaf's sides, on a spline whose control points have weights from 0.8 to 1.25.
struct Quotient {
    /// The point in the middle, which the numerators are relative to.
    middle: DVec3,
    /// Numerators and weights; the weight in the middle is 1.
    coefficients: [[DVec4; 4]; 4],
    /// The least weight; `None` if all are alike.
    least: Option<f64>,
    /// The error bound of the coefficients.
    noise: f64,
}

impl Quotient {
    /// The quotient over a leaf; `None` where the weights differ too much: see [`MOST_WEIGHT`].
    fn new(part_net: &PartNet, piece: &Piece) -> Option<Self> {
        let [p, q] = piece.patch.degree();
        let mut net = [[DVec4::ZERO; 4]; 4];
        for (row, control) in net.iter_mut().zip(part_net.net().chunks_exact(q + 1)) {
            row[..=q].copy_from_slice(control);
            *row = powers(q, *row);
        }
        let mut coefficients = [[DVec4::ZERO; 4]; 4];
        // All others are as good as zero, where the degree was elevated.
        let [least_p, least_q] = piece.patch.sums_degree();
        for j in 0..=least_q {
            let column = powers(p, [net[0][j], net[1][j], net[2][j], net[3][j]]);
            for i in 0..=least_p {
                coefficients[i][j] = column[i];
            }
        }
        let middle = euclidean(coefficients[0][0]);
        let inverse = 1.0 / coefficients[0][0].w;
        let mut noise = 4.0 * piece.patch.noise();
        if !piece.patch.is_rational() {
            for c in coefficients.as_flattened_mut() {
                *c = (c.truncate() * inverse).extend(0.0);
            }
            coefficients[0][0] = DVec4::W;
            return Some(Self { middle, coefficients, least: None, noise });
        }
        for c in coefficients.as_flattened_mut() {
            *c = (c.truncate() - c.w * middle).extend(c.w) * inverse;
        }
        coefficients[0][0] = DVec4::W;
        let (mut least, mut heaviest) = (f64::INFINITY, 0f64);
        for c in in_both_directions(&BLOSSOM, &coefficients).as_flattened() {
            (least, heaviest) = (least.min(c.w), heaviest.max(c.w));
        }
        // A little less, for rounding; false for NaN.
        let most = 0.999 * f64::from(MOST_WEIGHT);
        let in_range = least * most >= 1.0 && heaviest <= most;
        noise *= heaviest / least;
        in_range.then_some(Self { middle, coefficients, least: Some(least), noise })
    }

    /// The sizes, as forms, of the surface and its first three derivatives in the middle, by
    /// Leibniz's rule for `X = S W`: there `X` and `S` are zero, and `W` is 1.
    fn in_middle(&self) -> [f64; 4] {
        let [[_, y, yy, yyy], [x, xy, xyy, _], [xx, xxy, ..], [xxx, ..]] = self.coefficients;
        let (s_x, s_y) = (x.truncate(), y.truncate());
        // Coefficients times factorials are derivatives.
        let [s_xx, s_xy, s_yy] = second_derivatives([x, y], [xx, xy, yy]);
        let s_xxx = 6.0 * xxx.truncate() - 3.0 * x.w * s_xx - 6.0 * xx.w * s_x;
        let s_yyy = 6.0 * yyy.truncate() - 3.0 * y.w * s_yy - 6.0 * yy.w * s_y;
        let s_xxy = 2.0 * (xxy.truncate() - x.w * s_xy - xx.w * s_y - xy.w * s_x) - y.w * s_xx;
        let s_xyy = 2.0 * (xyy.truncate() - y.w * s_xy - yy.w * s_x - xy.w * s_y) - x.w * s_yy;
        let first = s_x.length() + s_y.length();
        let second = s_xx.length() + 2.0 * s_xy.length() + s_yy.length();
        let third = s_xxx.length() + s_yyy.length() + 3.0 * (s_xxy.length() + s_xyy.length());
        [0.0, first, second, third]
    }

    fn error(&self, reach: f64) -> FitError {
        let mut sizes = [[[0.0; 4]; 4]; 2];
        for k in 1..16 {
            let (i, j) = (k / 4, k % 4);
            let c = self.coefficients[i][j];
            (sizes[0][i][j], sizes[1][i][j]) = (c.truncate().length(), c.w.abs());
        }
        match self.least {
            None => FitError::of_polynomial(&sizes[0], self.noise),
            Some(least) => {
                FitError::of_quotient(&sizes, (self.in_middle(), least), reach, self.noise)
            }
        }
    }
}

/// Rounds the coefficients of numerators and weights to f32, except the first.
fn rounded(coefficients: &[[DVec4; 4]; 4]) -> (Fit, WeightFit) {
    let (mut fit, mut weight) = (Fit::default(), NO_WEIGHT);
    for (k, coefficient) in coefficients.as_flattened().iter().enumerate().skip(1) {
        let [x, y, z, w] = coefficient.to_array();
        (fit[0][k], fit[1][k], fit[2][k]) = (x as f32, y as f32, z as f32);
        weight[k] = w as f32;
    }
    (fit, weight)
}

/// The vectors across the middle in `x` and in `y`, where the numerators are zero and the weight is
/// 1.
fn chords(coefficients: &[[DVec4; 4]; 4]) -> [DVec3; 2] {
    let along_x = [0, 1, 2, 3].map(|i| coefficients[i][0]);
    // `X / W` at 1 minus `X / W` at −1, from the even and the odd parts of both.
    [along_x, coefficients[0]].map(|[_, a, b, c]| {
        let (even, odd) = (b, a + c);
        let (weight, slope) = (1.0 + even.w, odd.w);
        let across = odd.truncate() * weight - even.truncate() * slope;
        across * (2.0 / (weight * weight - slope * slope))
    })
}

/// The Chebyshev points of degree four: `cos((2k + 1) π / 8)`.
const NODES: [f64; 4] = {
    let (outer, inner) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8);
    [outer, inner, -inner, -outer]
};

/// Takes values at the nodes to power coefficients.
const INTERPOLATION: [[f64; 4]; 4] = interpolation(NODES);

/// The matrix that takes values at four nodes to power coefficients: column `a` holds the
/// coefficients of the Lagrange polynomial that is 1 at node `a`.
const fn interpolation(nodes: [f64; 4]) -> [[f64; 4]; 4] {
    let mut matrix = [[0.0; 4]; 4];
    let mut a = 0;
    while a < 4 {
        let mut polynomial = [1.0, 0.0, 0.0, 0.0];
        let (mut b, mut degree) = (0, 0);
        while b < 4 {
            if b != a {
                degree += 1;
                let scale = 1.0 / (nodes[a] - nodes[b]);
                let mut k = degree;
                while k > 0 {
                    polynomial[k] = (polynomial[k - 1] - nodes[b] * polynomial[k]) * scale;
                    k -= 1;
                }
                polynomial[0] *= -nodes[b] * scale;
            }
            b += 1;
        }
        let mut k = 0;
        while k < 4 {
            matrix[k][a] = polynomial[k];
            k += 1;
        }
        a += 1;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::bernstein;

    #[test]
    fn bicubic_maps_are_fitted_exactly() {
        let map = |x: f64, y: f64| DVec3::new(x * x * x * y, 1.0 - y * y * y, x - 2.0 * x * x * y);
        let values = NODES.map(|x| NODES.map(|y| map(x, y)));
        let coefficients = in_both_directions(&INTERPOLATION, &values);
        assert!(coefficients[0][0].distance(DVec3::Y) < 1e-14);
        let coefficients = coefficients.map(|row| row.map(|c| c.extend(0.0)));
        let ((fit, weight), [across_x, across_y]) = (rounded(&coefficients), chords(&coefficients));
        assert_eq!(weight, NO_WEIGHT);
        assert!(across_x.distance(map(1.0, 0.0) - map(-1.0, 0.0)) < 1e-14);
        assert!(across_y.distance(map(0.0, 1.0) - map(0.0, -1.0)) < 1e-14);
        let expected = [(0, 13, 1.0), (1, 3, -1.0), (2, 4, 1.0), (2, 9, -2.0)];
        for axis in 0..3 {
            for k in 0..16 {
                let wanted = expected.iter().find(|e| (e.0, e.1) == (axis, k)).map_or(0.0, |e| e.2);
                assert!((fit[axis][k] - wanted).abs() < 1e-6, "{axis} {k}");
            }
        }
    }

    #[test]
    fn values_at_nodes_are_points_of_the_surface() {
        for degree in [[3, 3], [2, 5], [4, 1]] {
            let count = (degree[0] + 1) * (degree[1] + 1);
            let control = |k: usize| {
                let x = k as f64;
                let w = 1.0 + 0.4 * x.sin();
                w * DVec3::new((3.0 * x).cos(), x, 0.1 * x * x).extend(1.0)
            };
            let net: Vec<DVec4> = (0..count).map(control).collect();
            let values = points_at(NODES.map(|node| 0.5 * (1.0 + node)), degree, &net);
            for (a, b) in [(0, 0), (1, 3), (2, 1)] {
                let [s, t] = [a, b].map(|k| 0.5 * (1.0 + NODES[k]));
                let (in_s, in_t): ([f64; 8], [f64; 8]) =
                    (bernstein::basis(degree[0], s), bernstein::basis(degree[1], t));
                let sum: DVec4 = (0..count)
                    .map(|k| in_s[k / (degree[1] + 1)] * in_t[k % (degree[1] + 1)] * net[k])
                    .sum();
                assert!(values[a][b].distance(sum.truncate() / sum.w) < 1e-13);
            }
        }
    }
}
