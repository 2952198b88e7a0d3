//! The source note's circles: arcs of the unit circle of degree 2, 3 and 4, in the plane
//! `z = 0`.
//!
//! D. Eberly, "Representing a Circle or a Sphere with NURBS", 2003–2015, section 2, its
//! misprinted control points put right.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use glam::DVec3;

use super::quadrics::unit_knots;
use crate::geometry::construct::arc::UnitArc;
use crate::geometry::{CurveError, KnotVector, NurbsCurve};

/// How the quarter circle of degree 2 is weighted; `2 w₁² = w₀ w₂` makes it a circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadraticArc {
    /// Weights 1, 1, 2: the parametrisation `(1 − t², 2t) / (1 + t²)`.
    Rational,
    /// Weights 1, √½, 1: symmetric about the middle of the arc.
    Symmetric,
}

/// Which of the note's two quarter circles of degree 4 with `w₁ = 1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuarticArc {
    /// `y₁ = √2/4`, `x₂ = 1 − √2/8`, `w₂ = 2√2/3`.
    First,
    /// `y₁ = √2 − 1`, `x₂ = (44√2 − 1)/79`, `w₂ = (16 − 7√2)/6`.
    Second,
}

fn plane_curve(knots: KnotVector, points: &[(f64, f64, f64)]) -> NurbsCurve {
    let control = points.iter().map(|&(x, y, w)| (w * DVec3::new(x, y, 0.0)).extend(w));
    NurbsCurve::assembled(knots, control.collect())
}

/// The quarter of the unit circle from `(1, 0)` to `(0, 1)`, of degree 2.
pub fn quarter_circle_quadratic(arc: QuadraticArc) -> NurbsCurve {
    let (w1, w2) = match arc {
        QuadraticArc::Rational => (1.0, 2.0),
        QuadraticArc::Symmetric => (FRAC_1_SQRT_2, 1.0),
    };
    plane_curve(unit_knots(2), &[(1.0, 0.0, 1.0), (1.0, 1.0, w1), (0.0, 1.0, w2)])
}

/// The quarter of the unit circle from `(1, 0)` to `(0, 1)`, of degree 4, symmetric.
pub fn quarter_circle_quartic(arc: QuarticArc) -> NurbsCurve {
    let (y1, x2, w2) = match arc {
        QuarticArc::First => (SQRT_2 / 4.0, 1.0 - SQRT_2 / 8.0, 2.0 * SQRT_2 / 3.0),
        QuarticArc::Second => {
            (SQRT_2 - 1.0, (44.0 * SQRT_2 - 1.0) / 79.0, (16.0 - 7.0 * SQRT_2) / 6.0)
        }
    };
    let points = [(1.0, 0.0, 1.0), (1.0, y1, 1.0), (x2, x2, w2), (y1, 1.0, 1.0), (0.0, 1.0, 1.0)];
    plane_curve(unit_knots(4), &points)
}

/// The half of the unit circle with `x ≥ 0`, from `(0, 1)` to `(0, −1)`, of degree 3:
/// `(2t(1 − t), 1 − 2t) / (2t² − 2t + 1)`.
pub fn half_circle_cubic() -> NurbsCurve {
    let third = 1.0 / 3.0;
    let points = [(0.0, 1.0, 1.0), (2.0, 1.0, third), (2.0, -1.0, third), (0.0, -1.0, 1.0)];
    plane_curve(unit_knots(3), &points)
}

/// The unit circle of degree 3, clockwise from `(0, 1)`: two half circles, joined at a knot
/// of multiplicity 3. As a curve in the plane it is smooth there and where it closes.
pub fn circle_cubic() -> NurbsCurve {
    let (third, half) = (1.0 / 3.0, 0.5);
    let points = [
        (0.0, 1.0, 1.0),
        (2.0, 1.0, third),
        (2.0, -1.0, third),
        (0.0, -1.0, 1.0),
        (-2.0, -1.0, third),
        (-2.0, 1.0, third),
        (0.0, 1.0, 1.0),
    ];
    let values = vec![0.0, 0.0, 0.0, 0.0, half, half, half, 1.0, 1.0, 1.0, 1.0];
    plane_curve(KnotVector::derived(3, values), &points)
}

/// The arc of the circle of this radius around the origin, from an angle by a turn (both in
/// degrees, counterclockwise from the x axis), of degree 2 on `[0, 1]`: one piece for each
/// quarter turn or less, of equal angles.
///
/// # Errors
/// When the radius is not positive and finite, or the turn is zero or more than 360°.
pub fn circle_arc(radius: f64, from: f64, degrees: f64) -> Result<NurbsCurve, CurveError> {
    let usable = radius > 0.0 && radius.is_finite(); // false for NaN
    if !usable {
        return Err(CurveError::Radius { radius });
    }
    let usable = from.is_finite() && degrees != 0.0 && degrees.abs() <= 360.0;
    if !usable {
        return Err(CurveError::Arc { from, degrees });
    }
    let arc = UnitArc::new(from, degrees);
    let scaled = arc.points.iter().map(|&(x, y, w)| (radius * x, radius * y, w));
    Ok(plane_curve(arc.knots, &scaled.collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, x: f64, y: f64) {
        let off = (a - DVec3::new(x, y, 0.0)).length();
        assert!(off <= 2e-15 * a.length().max(1.0), "{a} is not ({x}, {y})");
    }

    fn stays_on_the_circle(curve: &NurbsCurve) {
        let (start, end) = curve.domain();
        for k in 0..=200 {
            let t = start + (end - start) * f64::from(k) / 200.0;
            let point = curve.point_at(t);
            assert!((point.length() - 1.0).abs() < 1e-15, "t = {t}: {point}");
        }
    }

    #[test]
    fn every_arc_is_an_arc() {
        use {QuadraticArc::*, QuarticArc::*};
        for arc in [Rational, Symmetric] {
            stays_on_the_circle(&quarter_circle_quadratic(arc));
        }
        for arc in [First, Second] {
            stays_on_the_circle(&quarter_circle_quartic(arc));
        }
        stays_on_the_circle(&half_circle_cubic());
        stays_on_the_circle(&circle_cubic());
    }

    #[test]
    fn quarters_have_the_note_s_values() {
        let rational = quarter_circle_quadratic(QuadraticArc::Rational);
        close(rational.point_at(0.5), 0.6, 0.8);
        close(rational.point_at(1.0 / 3.0), 0.8, 0.6);
        let middle = FRAC_1_SQRT_2;
        close(quarter_circle_quadratic(QuadraticArc::Symmetric).point_at(0.5), middle, middle);
        for arc in [QuarticArc::First, QuarticArc::Second] {
            close(quarter_circle_quartic(arc).point_at(0.5), middle, middle);
        }
        let second = quarter_circle_quartic(QuarticArc::Second);
        let printed = [0.41421356237309503, 0.7750050220812175, 1.0167508438980557];
        assert!((second.point(1).y - printed[0]).abs() < 1e-15);
        assert!((second.point(2).x - printed[1]).abs() < 1e-15);
        assert!((second.weight(2) - printed[2]).abs() < 1e-15);
    }

    #[test]
    fn the_half_circle_has_its_closed_form() {
        let half = half_circle_cubic();
        close(half.point_at(0.25), 0.6, 0.8);
        for k in 0..=16 {
            let t = f64::from(k) / 16.0;
            let w = 2.0 * t * t - 2.0 * t + 1.0;
            close(half.point_at(t), 2.0 * t * (1.0 - t) / w, (1.0 - 2.0 * t) / w);
        }
    }

    #[test]
    fn the_circle_has_the_note_s_points_and_tangents() {
        let circle = circle_cubic();
        let (a, b) = (128.0 / 25.0, 96.0 / 25.0);
        let cases = [
            (0.0, (0.0, 1.0), (4.0, 0.0)),
            (0.125, (0.6, 0.8), (a, -b)),
            (0.25, (1.0, 0.0), (0.0, -8.0)),
            (0.375, (0.6, -0.8), (-a, -b)),
            (0.5, (0.0, -1.0), (-4.0, 0.0)),
            (0.625, (-0.6, -0.8), (-a, b)),
            (0.75, (-1.0, 0.0), (0.0, 8.0)),
            (0.875, (-0.6, 0.8), (a, b)),
            (1.0, (0.0, 1.0), (4.0, 0.0)),
        ];
        for (t, point, tangent) in cases {
            let c = circle.derivatives(t);
            close(c.point, point.0, point.1);
            close(c.first, tangent.0, tangent.1);
        }
    }
}
