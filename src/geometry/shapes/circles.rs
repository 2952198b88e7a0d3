//! Arcs of the unit circle of degree 2, 3 and 4, in the plane `z = 0`.
//!
//! D. Eberly, "Representing a Circle or a Sphere with NURBS", 2003–2015, section 2, with
//! [errata](crate::geometry::errata).

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use glam::DVec3;

use super::arc::UnitArc;
use crate::geometry::knots::unit_knots;
use crate::geometry::{
    CurveError, KnotVector, MAX_MAGNITUDE, MIN_MAGNITUDE, NurbsCurve, is_usable_weight,
};

/// How the quarter circle of degree 2 is weighted; `2 w₁² = w₀ w₂` makes it a circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadraticArc {
    /// Weights 1, 1, 2: the parametrisation `(1 − t², 2t) / (1 + t²)`.
    Rational,
    /// Weights 1, √½, 1: symmetric about the middle of the arc.
    Symmetric,
}

/// Which of the two families of symmetric quarter circles of degree 4 in the first quadrant.
///
/// Written as a complex number, a circle's numerator is a square `f²` times a real factor `g`, its
/// denominator `|f|² g`. Degree 4 leaves `f` linear and `g` quadratic, or `f` quadratic: both leave
/// one constant free, which `w₁` determines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuarticArc {
    /// The quadratic arc times a factor: `y₁ = √2/(4 w₁)`, `x₂ = 1 − √2/(8 w₁)`,
    /// `w₂ = 2√2 w₁/3`. For `w₁ = 1` it is Eberly's first solution.
    First,
    /// The square of a quadratic: `y₁ = √2 − 1`, `w₂ = (√2/2 + (8 − 4√2) w₁²)/3`,
    /// `x₂ = √2 (1 + (8 − 4√2) w₁²)/(6 w₂)`. For `w₁ = 1` it is Eberly's second solution.
    Second,
}

/// The constants of a symmetric quarter circle of degree 4: control points `(1, 0)`,
/// `(1, y₁)`, `(x₂, x₂)`, `(y₁, 1)`, `(0, 1)` with the weights `1, w₁, w₂, w₁, 1`.
///
/// # Invariant, checked once on construction
/// Eberly's three equations (11) hold to rounding, `w₁` and `w₂` are positive, and the
/// curve stays in the first quadrant: `x₂` and `y₁` are positive too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuarticConstants {
    w1: f64,
    w2: f64,
    y1: f64,
    x2: f64,
}

/// At this `w₁` or less, the control point `(x₂, x₂)` of the first family leaves the quadrant.
const FIRST_ABOVE: f64 = SQRT_2 / 8.0;

impl QuarticConstants {
    /// The solution of the constraint for a given `w₁`.
    ///
    /// # Errors
    /// When `w₁` is not positive, or so large that it or `w₂` is above [`MAX_MAGNITUDE`], or so
    /// small that one is below [`MIN_MAGNITUDE`] or (√2/8 or less) the first family leaves the
    /// quadrant.
    pub fn solved(arc: QuarticArc, w1: f64) -> Result<Self, CurveError> {
        let (solution, least) = match arc {
            QuarticArc::First => (1, FIRST_ABOVE),
            QuarticArc::Second => (2, 0.0),
        };
        let usable = w1 > least && w1 <= MAX_MAGNITUDE; // false for NaN
        if !usable {
            return Err(CurveError::QuarticWeight { solution, w1, above: least });
        }
        let (y1, x2, w2) = match arc {
            QuarticArc::First => {
                (SQRT_2 / (4.0 * w1), 1.0 - SQRT_2 / (8.0 * w1), 2.0 * SQRT_2 * w1 / 3.0)
            }
            QuarticArc::Second => {
                let r2 = (4.0 - 2.0 * SQRT_2) * w1 * w1;
                let w2 = (FRAC_1_SQRT_2 + 2.0 * r2) / 3.0;
                (SQRT_2 - 1.0, FRAC_1_SQRT_2 * (1.0 + 2.0 * r2) / (3.0 * w2), w2)
            }
        };
        Self::new([w1, w2], y1, x2)
    }

    /// The constants `[w₁, w₂]`, `y₁`, `x₂`, if they satisfy the constraint.
    ///
    /// # Errors
    /// When one is not positive, or cannot be a weight or a coordinate of a curve, or an equation
    /// is violated; the error says which and by how much.
    pub fn new([w1, w2]: [f64; 2], y1: f64, x2: f64) -> Result<Self, CurveError> {
        for (index, weight) in [(1, w1), (2, w2)] {
            if !is_usable_weight(weight) {
                return Err(CurveError::Weight { index, weight });
            }
        }
        for (index, coordinate, [x, y]) in [(1, y1, [1.0, y1]), (2, x2, [x2, x2])] {
            let (positive, point) = (coordinate > 0.0, DVec3::new(x, y, 0.0)); // false for NaN
            if !positive {
                return Err(CurveError::OffQuadrant { index, point });
            }
            if coordinate > MAX_MAGNITUDE {
                return Err(CurveError::Point { index, point });
            }
        }

        // Each equation with the sizes of its terms, which bound its rounding.
        let a = [4.0 * w1 * w1 * y1 * y1, 3.0 * w2 * (x2 - 1.0)];
        let b = [1.0 - y1, 6.0 * w2 * (1.0 - x2), -6.0 * w2 * x2 * y1];
        let (w1_2, w2_2) = (w1 * w1, w2 * w2);
        let c = [32.0 * w1_2 * y1, 36.0 * w2_2 * x2 * x2, -16.0 * w1_2, -18.0 * w2_2, -1.0];
        let equations: [(&str, &[f64], f64); 3] = [
            ("4 w1² y1² + 3 w2 (x2 - 1)", &a, 3.0 * w2),
            ("1 - y1 + 6 w2 (1 - x2 - x2 y1)", &b, 1.0 + 6.0 * w2),
            ("32 w1² y1 + 36 w2² x2² - 16 w1² - 18 w2² - 1", &c, 0.0),
        ];
        for (what, terms, size) in equations {
            let found: f64 = terms.iter().sum();
            let size = size + terms.iter().map(|term| term.abs()).sum::<f64>();
            let tolerance = ROUNDING * size;
            if found.abs() > tolerance {
                return Err(CurveError::NotRound { what, found, needed: 0.0, tolerance });
            }
        }
        Ok(Self { w1, w2, y1, x2 })
    }

    /// The quarter of the unit circle from `(1, 0)` to `(0, 1)`.
    pub fn curve(&self) -> NurbsCurve {
        let Self { w1, w2, y1, x2 } = *self;
        let points = [(1.0, 0.0, 1.0), (1.0, y1, w1), (x2, x2, w2), (y1, 1.0, w1), (0.0, 1.0, 1.0)];
        plane_curve(unit_knots(4), &points)
    }
}

/// A constraint holds if its residual is no more than this share of its terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

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

/// The quarter of the unit circle from `(1, 0)` to `(0, 1)`, of degree 2, with any weights
/// `w₀, w₁, w₂` that satisfy the constraint `2 w₁² = w₀ w₂`.
///
/// # Errors
/// When a weight is not a positive, normal number, or the constraint is violated.
pub fn quarter_circle_weighted([w0, w1, w2]: [f64; 3]) -> Result<NurbsCurve, CurveError> {
    for (index, weight) in [w0, w1, w2].into_iter().enumerate() {
        let usable = weight.is_normal() && weight > 0.0 && weight.is_finite();
        if !usable {
            return Err(CurveError::Weight { index, weight });
        }
    }
    let ratio = 2.0 * (w1 / w0) * (w1 / w2);
    let round = (ratio - 1.0).abs() <= ROUNDING;
    if !round {
        let what = "2 w1² / (w0 w2)";
        let (needed, tolerance) = (1.0, ROUNDING);
        return Err(CurveError::NotRound { what, found: ratio, needed, tolerance });
    }
    let knots = unit_knots(2);
    NurbsCurve::new(
        knots,
        vec![DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y],
        Some(vec![w0, w1, w2]),
    )
}

/// The quarter of the unit circle from `(1, 0)` to `(0, 1)`, of degree 4, symmetric, with
/// `w₁ = 1`: Eberly's two solutions.
pub fn quarter_circle_quartic(arc: QuarticArc) -> NurbsCurve {
    let (y1, x2, w2) = match arc {
        QuarticArc::First => (SQRT_2 / 4.0, 1.0 - SQRT_2 / 8.0, 2.0 * SQRT_2 / 3.0),
        QuarticArc::Second => {
            (SQRT_2 - 1.0, (44.0 * SQRT_2 - 1.0) / 79.0, (16.0 - 7.0 * SQRT_2) / 6.0)
        }
    };
    QuarticConstants { w1: 1.0, w2, y1, x2 }.curve()
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

/// The arc of degree 2, on `[0, 1]`, of the circle of this radius around the origin. It starts at
/// the angle `from` and turns by `degrees` (both in degrees, counterclockwise from the x axis).
/// Each quarter turn or less takes one piece; all pieces have the same angle.
///
/// [`TrimCurve::arc`](crate::geometry::trim::TrimCurve::arc) is different: it takes radians, and
/// the angle at which the arc ends instead of the turn.
///
/// # Errors
/// When the radius is not positive or not from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`], or the turn
/// is zero or more than 360°, or the start is not finite.
pub fn circle_arc(radius: f64, from: f64, degrees: f64) -> Result<NurbsCurve, CurveError> {
    let usable = radius > 0.0 && radius.is_finite(); // false for NaN
    if !usable {
        return Err(CurveError::Radius { radius });
    }
    if !(MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&radius) {
        return Err(CurveError::RadiusRange { radius });
    }
    if !from.is_finite() {
        return Err(CurveError::ArcStart { from });
    }
    let usable = degrees != 0.0 && degrees.abs() <= 360.0; // false for NaN
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
        let [start, end] = curve.domain();
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
        assert!((second.vertex(1).y - printed[0]).abs() < 1e-15);
        assert!((second.vertex(2).x - printed[1]).abs() < 1e-15);
        assert!((second.control()[2].w - printed[2]).abs() < 1e-15);
    }

    #[test]
    fn the_constraint_is_solved_for_any_w1() {
        use QuarticArc::{First, Second};
        for w1 in [0.2, 0.3, 0.5, 0.836_516_303_737_807_9, 1.0, 1.5, 3.0, 100.0, 1e6] {
            for arc in [First, Second] {
                stays_on_the_circle(&QuarticConstants::solved(arc, w1).unwrap().curve());
            }
        }
        for arc in [First, Second] {
            let solved = QuarticConstants::solved(arc, 1.0).unwrap().curve();
            for (a, b) in solved.control().iter().zip(quarter_circle_quartic(arc).control()) {
                assert!(a.distance(*b) < 4e-16, "{arc:?}: {a} {b}");
            }
        }
        // The border of Farin's quartic octant.
        let octant = QuarticConstants::new(
            [0.836_516_303_737_807_9, 0.788_675_134_594_812_9],
            0.422_649_730_810_374_2,
            0.788_675_134_594_812_9,
        );
        stays_on_the_circle(&octant.unwrap().curve());
    }

    #[test]
    fn constants_that_make_no_circle_are_refused_by_how_much() {
        assert_eq!(
            QuarticConstants::new([1.0, 1.0], 0.5, 0.75).unwrap_err().to_string(),
            "4 w1² y1² + 3 w2 (x2 - 1) is 0.25: a circle needs 0 to within 1.7e-14"
        );
        assert_eq!(
            QuarticConstants::solved(QuarticArc::First, 0.125).unwrap_err().to_string(),
            "w1 is 0.125: solution 1 needs a weight above 0.1767766952966369 (√2/8, below which the arc \
             leaves its quadrant), up to 1e70"
        );
        assert!(QuarticConstants::solved(QuarticArc::First, FIRST_ABOVE).is_err());
        stays_on_the_circle(&QuarticConstants::solved(QuarticArc::First, 0.1768).unwrap().curve());
        assert_eq!(
            QuarticConstants::solved(QuarticArc::Second, -1.0).unwrap_err().to_string(),
            "w1 is -1: solution 2 needs a weight above 0, up to 1e70"
        );
        assert!(QuarticConstants::solved(QuarticArc::Second, f64::INFINITY).is_err());
        let off = QuarticConstants::new([1.0, 1.0], 0.5, -0.75).unwrap_err().to_string();
        assert!(off.starts_with("control point 2 is (-0.75, -0.75): both"), "{off}");
        assert!(QuarticConstants::solved(QuarticArc::Second, f64::NAN).is_err());
        // The second weight would be 8e119.
        let heavy = QuarticConstants::solved(QuarticArc::Second, 1e60).unwrap_err();
        assert!(matches!(heavy, CurveError::Weight { index: 2, .. }), "{heavy}");
        let heavy = QuarticConstants::solved(QuarticArc::First, 1e70).unwrap().curve();
        assert!(heavy.weights().all(is_usable_weight));
        let far = QuarticConstants::new([1.0, 1.0], 1e80, 0.75).unwrap_err();
        assert!(matches!(far, CurveError::Point { index: 1, .. }), "{far}");
        assert_eq!(
            quarter_circle_weighted([1.0, 1.0, 1.0]).unwrap_err().to_string(),
            "2 w1² / (w0 w2) is 2: a circle needs 1 to within 3.6e-15"
        );
        assert_eq!(
            quarter_circle_weighted([1.0, 0.0, 1.0]).unwrap_err().to_string(),
            "the weight of control point 1 is 0: \
             it must be positive and finite (from 1e-70 to 1e70)"
        );
        for w0 in [1e-8, 0.3, 1.0, 1e8] {
            stays_on_the_circle(&quarter_circle_weighted([w0, 1.0, 2.0 / w0]).unwrap());
        }
        let symmetric = quarter_circle_weighted([SQRT_2, 1.0, SQRT_2]).unwrap();
        close(symmetric.point_at(0.5), FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    }

    #[test]
    fn arcs_of_any_angle_have_their_radius() {
        for degrees in [0.5, 90.0, 137.5, 180.0, 275.0, 360.0, -45.0] {
            stays_on_the_circle(&circle_arc(1.0, 33.0, degrees).unwrap());
        }
        assert_eq!(
            circle_arc(1.0, 0.0, 361.0).unwrap_err().to_string(),
            "an arc from 0° by 361°: it must turn by -360° to 360°, and not by 0°"
        );
        assert!(circle_arc(0.0, 0.0, 90.0).is_err() && circle_arc(1.0, f64::NAN, 90.0).is_err());
        // The first would have a point at infinity, the last a point in the origin.
        for radius in [1.7e308, 1e71, 1e-71, 5e-324] {
            let refused = Err(CurveError::RadiusRange { radius });
            assert_eq!(circle_arc(radius, -40.0, 80.0), refused, "{radius:e}");
        }
        assert_eq!(
            circle_arc(5e-324, 0.0, 90.0).unwrap_err().to_string(),
            "radius 5e-324: radii from 1e-70 to 1e70 are supported"
        );
        for radius in [1e70, 1e-70] {
            let arc = circle_arc(radius, -40.0, 80.0).unwrap();
            let off = arc.point_at(0.3).length() / radius - 1.0;
            assert!(off.abs() < 1e-15, "{radius:e}: off by {off:e}");
        }
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
