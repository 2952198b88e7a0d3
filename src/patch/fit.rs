//! Bicubic approximations of leaves.

use glam::{DVec2, DVec3};

use super::fit_error::FitError;
use super::part::Halving;
use super::tensor::euclidean;
use super::{DyadicRect, Piece};

/// Coefficients of `xⁱ yʲ`, at `4 i + j`, coordinate by coordinate.
pub type Fit = [[f32; 16]; 3];

/// A leaf's bicubic approximation, and what is known of it.
pub(super) struct Approximation {
    /// What it is relative to: the surface's point in the middle.
    pub(super) middle: DVec3,
    pub(super) fit: Fit,
    /// The vectors across the middle of the leaf, in `s` and in `t`.
    pub(super) chords: [DVec3; 2],
    pub(super) error: FitError,
}

impl Approximation {
    pub(super) fn new(halving: &Halving, piece: &Piece, rect: DyadicRect) -> Self {
        let [p, q] = piece.patch.degree();
        if p.max(q) <= 3 && !piece.patch.is_rational() {
            return Self::exact(halving, piece);
        }
        let place = |x: f64, y: f64| {
            let at = |[from, to]: [f64; 2], x: f64| 0.5 * ((from + to) + x * (to - from));
            let [s, t] = rect.ranges();
            piece.patch.point(DVec2::new(at(s, x), at(t, y)))
        };
        let middle = place(0.0, 0.0);
        let fit = interpolated(|x, y| place(x, y) - middle);
        let chords = [place(1.0, 0.0) - place(-1.0, 0.0), place(0.0, 1.0) - place(0.0, -1.0)];
        let error = FitError::new(halving, piece, middle, &fit);
        Self { middle, fit, chords, error }
    }

    /// Polynomials of degree up to three are their own approximation, but for rounding.
    fn exact(halving: &Halving, piece: &Piece) -> Self {
        let [p, q] = piece.patch.degree();
        let mut net = [[DVec3::ZERO; 4]; 4];
        for (row, control) in net.iter_mut().zip(halving.net().chunks_exact(q + 1)) {
            for (point, &control) in row.iter_mut().zip(control) {
                *point = euclidean(control);
            }
            *row = powers(q, *row);
        }
        let mut fit = [[0.0; 16]; 3];
        let mut coefficients = [DVec3::ZERO; 16];
        for j in 0..=q {
            let column = powers(p, [net[0][j], net[1][j], net[2][j], net[3][j]]);
            for i in 0..=p {
                coefficients[4 * i + j] = column[i];
            }
        }
        let middle = std::mem::take(&mut coefficients[0]);
        for (k, coefficient) in coefficients.iter().enumerate() {
            let [x, y, z] = coefficient.to_array();
            (fit[0][k], fit[1][k], fit[2][k]) = (x as f32, y as f32, z as f32);
        }
        let chord = |first: usize, third: usize| 2.0 * (coefficients[first] + coefficients[third]);
        let chords = [chord(4, 12), chord(1, 3)];
        let error = FitError::of_polynomial(&coefficients, piece);
        Self { middle, fit, chords, error }
    }
}

/// From Bernstein coefficients of degree up to three on `[−1, 1]` to those of powers.
fn powers(degree: usize, [a, b, c, d]: [DVec3; 4]) -> [DVec3; 4] {
    let zero = DVec3::ZERO;
    match degree {
        1 => [0.5 * (a + b), 0.5 * (b - a), zero, zero],
        2 => [0.25 * (a + c) + 0.5 * b, 0.5 * (c - a), 0.25 * (a + c) - 0.5 * b, zero],
        _ => {
            let (outer, inner) = (a + d, 3.0 * (b + c));
            let (across, between) = (d - a, c - b);
            [
                0.125 * (outer + inner),
                0.375 * (across + between),
                0.125 * (3.0 * outer - inner),
                0.125 * (across - 3.0 * between),
            ]
        }
    }
}

/// The Chebyshev points of degree four: `cos((2k + 1) π / 8)`.
const NODES: [f64; 4] = {
    let (outer, inner) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8);
    [outer, inner, -inner, -outer]
};

/// Takes values at the nodes to power coefficients.
const INTERPOLATION: [[f64; 4]; 4] = interpolation(NODES);

/// The bicubic polynomial through a map's values at 4 × 4 Chebyshev points of `[−1, 1]²`,
/// near the best approximation there is (Trefethen 2013, ch. 16).
fn interpolated(map: impl Fn(f64, f64) -> DVec3) -> Fit {
    let mut values = [[DVec3::ZERO; 4]; 4];
    for a in 0..4 {
        for b in 0..4 {
            values[a][b] = map(NODES[a], NODES[b]);
        }
    }
    let coefficients = in_both_directions(&INTERPOLATION, &values);
    let mut fit = [[0.0; 16]; 3];
    for (k, coefficient) in coefficients.as_flattened().iter().enumerate() {
        let [x, y, z] = coefficient.to_array();
        (fit[0][k], fit[1][k], fit[2][k]) = (x as f32, y as f32, z as f32);
    }
    fit
}

/// A linear map of four numbers applied to the columns of a net, then to its rows.
pub(super) fn in_both_directions(matrix: &[[f64; 4]; 4], net: &[[DVec3; 4]; 4]) -> [[DVec3; 4]; 4] {
    let mut columns = [[DVec3::ZERO; 4]; 4];
    let mut both = columns;
    for i in 0..4 {
        for a in 0..4 {
            for b in 0..4 {
                columns[i][b] += matrix[i][a] * net[a][b];
            }
        }
        for j in 0..4 {
            for b in 0..4 {
                both[i][j] += matrix[j][b] * columns[i][b];
            }
        }
    }
    both
}

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

    #[test]
    fn bernstein_coefficients_become_those_of_powers() {
        let points = [1.0, -2.0, 0.5, 3.0].map(|x| DVec3::new(x, x * x, 1.0 - x));
        for degree in 1..=3 {
            let coefficients = powers(degree, points);
            for x in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let basis: [f64; 4] = crate::math::bernstein::basis(degree, 0.5 * (x + 1.0));
                let wanted: DVec3 = (0..=degree).map(|i| basis[i] * points[i]).sum();
                let value: DVec3 = (0..4).map(|i| x.powi(i as i32) * coefficients[i]).sum();
                assert!(value.distance(wanted) < 1e-14, "degree {degree} at {x}");
            }
        }
    }

    #[test]
    fn bicubic_maps_are_fitted_exactly() {
        let map = |x: f64, y: f64| DVec3::new(x * x * x * y, 1.0 - y * y * y, x - 2.0 * x * x * y);
        let fit = interpolated(map);
        let expected = [(0, 13, 1.0), (1, 0, 1.0), (1, 3, -1.0), (2, 4, 1.0), (2, 9, -2.0)];
        for axis in 0..3 {
            for k in 0..16 {
                let wanted = expected.iter().find(|e| (e.0, e.1) == (axis, k)).map_or(0.0, |e| e.2);
                assert!((fit[axis][k] - wanted).abs() < 1e-6, "{axis} {k}");
            }
        }
    }
}
