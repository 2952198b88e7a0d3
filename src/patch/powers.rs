//! Pieces by powers about their middle: `Σ Bᵢ(s) Bⱼ(t) Pᵢⱼ = Σ cᵢⱼ xⁱ yʲ`, `x = 2 s − 1`, `y = 2 t − 1`.
//!
//! Horner's scheme takes half the operations of sums of Bernstein functions. What that costs in digits is
//! little for low degrees, as powers are taken about the middle of a piece and no farther from it than one, and
//! differences of neighbouring control points are exact or nearly so: rounding is some units of
//! `Σ |cᵢⱼ| |x|ⁱ |y|ʲ`, over the weight there (Farouki and Rajan 1987, "On the numerical condition of polynomials
//! in Bernstein form"). Where that is many times the coordinates of the piece, as on nets of degree three that
//! zigzag, which reach 25 times, or where weights differ much, sums stay in Bernstein functions, whose terms are
//! never larger than their sum may be.

use std::ops::{Add, Mul, Sub};

use glam::DVec4;

use crate::geometry::Extraction;

/// The highest degree that is written by powers.
const MOST_DEGREE: usize = 3;

/// How many times the coordinates of a piece the terms of its sums may be. All are bounded at once; only where that
/// does not do they are looked at at 25 places: a measure of how many digits are lost, not a proof.
const MOST_CONDITION: f64 = 8.0;

/// The largest weight, over the smallest, of splines whose pieces are not looked at, as that takes a tenth of the
/// time to build them. They are dense, and most of their knots simple: their nets zigzag less than their control
/// points.
const MOST_WEIGHT: f64 = 2.0;

/// Whether pieces of these degrees can be written by powers.
pub(super) fn suit([p, q]: [usize; 2]) -> bool {
    p.max(q) <= MOST_DEGREE
}

/// Whether all pieces of a spline are taken to be well conditioned, by its control points.
pub(super) fn suit_all(control: &[DVec4]) -> bool {
    let weights = control.iter().map(|point| point.w);
    let (least, most) = weights.fold((f64::INFINITY, 0f64), |(a, b), w| (a.min(w), b.max(w)));
    most <= MOST_WEIGHT * least
}

/// The net of a piece by powers, from its Bézier points, if it is well conditioned.
pub(super) fn net_of(degree: [usize; 2], bezier: &[[DVec4; 4]; 4]) -> Option<[[DVec4; 4]; 4]> {
    let [p, q] = degree;
    let net = in_both_directions(degree, *bezier);
    let control = bezier[..=p].iter().flat_map(|row| &row[..=q]);
    let magnitude =
        control.clone().map(|c| c.truncate().abs().max_element() / c.w).fold(0.0, f64::max);
    // With the sizes of all terms, or as they are.
    let sum = |x: f64, y: f64, term: fn(DVec4) -> DVec4| {
        let row =
            |row: &[DVec4; 4]| row[..=q].iter().rev().fold(DVec4::ZERO, |s, &c| s * y + term(c));
        net[..=p].iter().rev().fold(DVec4::ZERO, |sum, terms| sum * x + row(terms))
    };
    // With `x` and `y` no larger than these, where the weight is no less than that.
    let suits = |x: f64, y: f64, weight: f64| {
        let sizes = sum(x.abs(), y.abs(), DVec4::abs);
        sizes.truncate().max_element() + sizes.w * magnitude <= MOST_CONDITION * magnitude * weight
    };
    let places = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let suits_all = suits(1.0, 1.0, control.map(|c| c.w).fold(f64::INFINITY, f64::min))
        || places.iter().all(|&x| places.iter().all(|&y| suits(x, y, sum(x, y, |c| c).w)));
    suits_all.then_some(net)
}

/// From Bernstein coefficients of degree up to three on `[−1, 1]` to those of powers; what is beyond the
/// degree stays as it is.
#[inline]
pub(super) fn powers<V>(degree: usize, [a, b, c, d]: [V; 4]) -> [V; 4]
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    match degree {
        1 => [(a + b) * 0.5, (b - a) * 0.5, c, d],
        2 => [(a + c) * 0.25 + b * 0.5, (c - a) * 0.5, ((a - b) + (c - b)) * 0.25, d],
        _ => {
            let (outer, inner) = (a + d, (b + c) * 3.0);
            let (across, between) = (d - a, c - b);
            [
                (outer + inner) * 0.125,
                (across + between) * 0.375,
                ((a - b) + (d - c)) * 0.375,
                (across - between * 3.0) * 0.125,
            ]
        }
    }
}

/// How the coefficients of powers of a span come from the control points that govern it: from their
/// differences from the first, which are exact or nearly so, and zero where points are equal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToPowers {
    /// For each coefficient the shares of the second to the fourth point.
    shares: [[f64; 3]; 4],
}

impl ToPowers {
    pub(super) fn of(extraction: &Extraction, degree: usize) -> Self {
        let shares = powers(degree, extraction.shares(degree)).map(|of| {
            let [_, b, c, d] = of.to_array();
            [b, c, d]
        });
        Self { shares }
    }

    /// The shares of the second to the fourth point in each coefficient.
    #[inline(always)]
    pub(crate) fn shares(&self) -> &[[f64; 3]; 4] {
        &self.shares
    }
}

/// A net by powers in both directions, of so many rows and columns that matter.
#[inline(always)]
fn in_both_directions([p, q]: [usize; 2], mut net: [[DVec4; 4]; 4]) -> [[DVec4; 4]; 4] {
    for j in 0..=q {
        let column = powers(p, [net[0][j], net[1][j], net[2][j], net[3][j]]);
        for i in 0..=p {
            net[i][j] = column[i];
        }
    }
    for row in &mut net[..=p] {
        *row = powers(q, *row);
    }
    net
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::bernstein;

    #[test]
    fn bernstein_coefficients_become_those_of_powers() {
        let points = [1.0, -2.0, 0.5, 3.0].map(|x| DVec3::new(x, x * x, 1.0 - x));
        for degree in 1..=3 {
            let coefficients = powers(degree, points);
            for x in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let basis: [f64; 4] = bernstein::basis(degree, 0.5 * (x + 1.0));
                let wanted: DVec3 = (0..=degree).map(|i| basis[i] * points[i]).sum();
                let value: DVec3 = (0..=degree).map(|i| x.powi(i as i32) * coefficients[i]).sum();
                assert!(value.distance(wanted) < 1e-14, "degree {degree} at {x}");
            }
        }
    }
}
