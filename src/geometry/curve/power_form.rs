//! Polynomials given by the coefficients of powers of their parameter, as Bézier curves.

use glam::{DVec3, DVec4};

use super::{CurveError, NurbsCurve};
use crate::geometry::KnotVector;
use crate::math::Twofold;
use crate::math::bernstein::binomial;

/// The coordinates of a homogeneous point.
type Coordinates = [Twofold; 4];

/// The shares that the coefficients of the powers of `t` have in each control point of a Bézier
/// curve of degree `n` on a domain `[a, b]`.
///
/// Control point `j` is the polar form at `n − j` times `a` and `j` times `b`. Of `tⁱ` this is the
/// `i`-th elementary symmetric polynomial of these `n` arguments over that of as many ones:
/// `eᵢ(a, …, b, …) / C(n, i)`. On `[0, 1]` it is `C(j, i) / C(n, i)`. (Ramshaw 1987.)
///
/// Where coefficients cancel, as those of `(1 − t)ⁿ` do, rounded sums of them would keep nothing:
/// all is computed in twice the precision, and rounded once, at the end.
pub(crate) struct PowerShares(Vec<Vec<Twofold>>);

impl PowerShares {
    pub(crate) fn new(degree: usize, [a, b]: [f64; 2]) -> Self {
        let of_point = |j: usize| {
            let mut symmetric = vec![Twofold::default(); degree + 1];
            symmetric[0] = 1.0.into();
            for k in 0..degree {
                let argument = Twofold::from(if k < j { b } else { a });
                for i in (0..=k).rev() {
                    symmetric[i + 1] = symmetric[i + 1].plus(argument.times(symmetric[i]));
                }
            }
            let over = |(i, e): (usize, Twofold)| e.over(binomial(degree, i));
            symmetric.into_iter().enumerate().map(over).collect()
        };
        Self((0..=degree).map(of_point).collect())
    }

    /// The control points of a polynomial with these coefficients, from that of `t⁰` on; those that
    /// are not given are zero.
    pub(crate) fn apply(&self, coefficients: &[Coordinates]) -> Vec<Coordinates> {
        let point = |shares: &Vec<Twofold>| {
            let mut sum = Coordinates::default();
            for (&share, coefficient) in shares.iter().zip(coefficients) {
                for (sum, &coordinate) in sum.iter_mut().zip(coefficient) {
                    // Of zero there is no share, not even an infinite one.
                    if coordinate != Twofold::default() {
                        *sum = sum.plus(share.times(coordinate));
                    }
                }
            }
            sum
        };
        self.0.iter().map(point).collect()
    }
}

/// A coefficient of a numerator, and that of the same power of the denominator.
pub(crate) fn power_coefficient(numerator: DVec3, denominator: f64) -> Coordinates {
    numerator.extend(denominator).to_array().map(Twofold::from)
}

/// Control points rounded, with the signs that make the first weight positive; or which of them
/// has a weight that is not.
pub(crate) fn rounded_powers(control: &[Coordinates]) -> Result<Vec<DVec4>, (usize, f64)> {
    let control: Vec<DVec4> =
        control.iter().map(|point| DVec4::from(point.map(Twofold::rounded))).collect();
    let sign = if control.first().is_some_and(|first| first.w < 0.0) { -1.0 } else { 1.0 };
    match control.iter().position(|point| sign * point.w <= 0.0) {
        Some(index) => Err((index, control[index].w)),
        None => Ok(control.into_iter().map(|point| sign * point).collect()),
    }
}

impl NurbsCurve {
    /// The curve `C(t) = (a₀ + a₁ t + a₂ t² + …) / (d₀ + d₁ t + d₂ t² + …)` on a domain, from the
    /// coefficients of the powers of `t` in its numerator and its denominator, `&[1.0]` for a
    /// polynomial. The longer of the two lists has one coefficient more than the curve's degree.
    ///
    /// It is one Bézier curve, whose homogeneous control points are rounded once.
    ///
    /// ```
    /// use glam::DVec3;
    /// use nurbray::geometry::NurbsCurve;
    ///
    /// // A quarter of the unit circle: (1 − t², 2t) / (1 + t²).
    /// let numerator = [DVec3::X, 2.0 * DVec3::Y, -DVec3::X];
    /// let quarter = NurbsCurve::from_powers(&numerator, &[1.0, 0.0, 1.0], [0.0, 1.0])?;
    /// assert_eq!(quarter.weights().collect::<Vec<_>>(), [1.0, 1.0, 2.0]);
    /// assert_eq!(quarter.point_at(0.5), DVec3::new(0.6, 0.8, 0.0));
    /// # Ok::<(), nurbray::geometry::CurveError>(())
    /// ```
    ///
    /// # Errors
    /// When the degree is not from 1 to [`MAX_DEGREE`](crate::geometry::MAX_DEGREE), the domain is
    /// empty or not finite, a coefficient is not finite or too large, or a Bézier coefficient of
    /// the denominator is zero or has another sign than the first: on a shorter domain that may be
    /// different.
    pub fn from_powers(
        numerator: &[DVec3],
        denominator: &[f64],
        domain: [f64; 2],
    ) -> Result<Self, CurveError> {
        let count = numerator.len().max(denominator.len());
        let degree = count.saturating_sub(1);
        let knots = KnotVector::bezier(degree)?.on_domain(domain[0], domain[1])?;
        let coefficient = |i: usize| {
            let numerator = numerator.get(i).copied().unwrap_or_default();
            power_coefficient(numerator, denominator.get(i).copied().unwrap_or_default())
        };
        let coefficients: Vec<Coordinates> = (0..count).map(coefficient).collect();
        let control = PowerShares::new(degree, domain).apply(&coefficients);
        let control = rounded_powers(&control)
            .map_err(|(index, coefficient)| CurveError::Denominator { index, coefficient })?;
        Self::from_homogeneous(knots, control)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sum of a[i] tⁱ` by Horner's scheme in twice the precision.
    fn value(coefficients: &[f64], t: f64) -> f64 {
        let step = |sum: Twofold, &a: &f64| sum.times(t.into()).plus(a.into());
        coefficients.iter().rev().fold(Twofold::default(), step).rounded()
    }

    fn of_x(coefficients: &[f64], domain: [f64; 2]) -> NurbsCurve {
        let coefficients: Vec<DVec3> = coefficients.iter().map(|&x| x * DVec3::X).collect();
        NurbsCurve::from_powers(&coefficients, &[1.0], domain).unwrap()
    }

    /// `X(t) = Σ xᵢ Bᵢ(t) = Σ aᵢ tⁱ`: both forms, of every degree.
    #[test]
    fn powers_are_what_their_coefficients_say() {
        for degree in [1, 2, 3, 5, 8, 16, 32] {
            for domain in [[0.0, 1.0], [-1.0, 1.0], [-2.0, -0.5], [3.0, 3.5]] {
                let coefficients: Vec<f64> =
                    (0..=degree).map(|i| f64::from((i * 7 + 3) % 11) - 5.0).collect();
                let curve = of_x(&coefficients, domain);
                assert_eq!((curve.degree(), curve.domain()), (degree as usize, domain));
                let size = curve.points().fold(0.0, |most, point| f64::max(most, point.x.abs()));
                for k in 0..=20 {
                    let t = domain[0] + (domain[1] - domain[0]) * f64::from(k) / 20.0;
                    let off = (curve.point_at(t).x - value(&coefficients, t)).abs();
                    assert!(off <= 4e-14 * size, "{degree} on {domain:?} at {t}: {off:e}");
                }
            }
        }
    }

    /// `(1 − t)³²` has one control point that is not zero, although its coefficients go up to 6e8.
    #[test]
    fn coefficients_that_cancel_leave_nothing() {
        let coefficients: Vec<f64> =
            (0..=32).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 } * binomial(32, i)).collect();
        let points: Vec<f64> = of_x(&coefficients, [0.0, 1.0]).points().map(|p| p.x).collect();
        assert_eq!(points[0], 1.0);
        assert!(points[1..].iter().all(|x| x.abs() < 1e-20), "{points:?}");
        // (1 − t)³² on [0, 2] is the power of what runs from 1 to −1: its control points are ±1.
        let points = of_x(&coefficients, [0.0, 2.0]);
        let expected = (0..=32).map(|j| if j % 2 == 0 { 1.0 } else { -1.0 });
        assert!(points.points().zip(expected).all(|(p, x)| (p.x - x).abs() < 1e-15));
    }

    /// The explicit curve of a document, `y = x² + 5x + 3`, and Bernstein polynomials.
    #[test]
    fn known_control_points() {
        let graph = [DVec3::new(0.0, 3.0, 0.0), DVec3::new(1.0, 5.0, 0.0), DVec3::Y];
        let graph = NurbsCurve::from_powers(&graph, &[1.0], [-6.0, 1.0]).unwrap();
        let points: Vec<[f64; 2]> = graph.points().map(|p| [p.x, p.y]).collect();
        assert_eq!(points, [[-6.0, 9.0], [-2.5, -15.5], [1.0, 9.0]]);
        assert!(graph.point_at(-2.0).distance(DVec3::new(-2.0, -3.0, 0.0)) < 2e-15);
        // 3t(1 − t)² = 3t − 6t² + 3t³.
        let points: Vec<f64> =
            of_x(&[0.0, 3.0, -6.0, 3.0], [0.0, 1.0]).points().map(|p| p.x).collect();
        assert_eq!(points, [0.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_quarter_circle_by_its_formula() {
        let numerator = [DVec3::X, 2.0 * DVec3::Y, -DVec3::X];
        for sign in [1.0, -1.0] {
            let denominator = [sign, 0.0, sign];
            let numerator = numerator.map(|a| sign * a);
            let arc = NurbsCurve::from_powers(&numerator, &denominator, [0.0, 1.0]).unwrap();
            let control: Vec<DVec4> = arc.control().to_vec();
            assert_eq!(control[1], DVec4::new(1.0, 1.0, 0.0, 1.0));
            // Any stretch of the line covers its own part of the circle.
            let part = NurbsCurve::from_powers(&numerator, &denominator, [-0.5, 0.25]).unwrap();
            for k in 0..=12 {
                let t = -0.5 + 0.75 * f64::from(k) / 12.0;
                let expected = DVec3::new(1.0 - t * t, 2.0 * t, 0.0) / (1.0 + t * t);
                assert!(part.point_at(t).distance(expected) < 4e-16, "{t}");
            }
        }
    }

    #[test]
    fn what_is_no_curve_is_told() {
        let failed = |numerator: &[DVec3], denominator: &[f64], domain| {
            NurbsCurve::from_powers(numerator, denominator, domain).unwrap_err().to_string()
        };
        let line = [DVec3::ZERO, DVec3::X];
        assert_eq!(
            failed(&line, &[1.0, -3.0, 3.0], [0.0, 1.0]),
            "the denominator's Bézier coefficient 1 is -0.5: all must be positive, or all negative; \
             they may be so on a shorter domain"
        );
        assert!(NurbsCurve::from_powers(&line, &[1.0, -3.0, 3.0], [0.0, 0.5]).is_ok());
        assert!(failed(&line, &[0.0], [0.0, 1.0]).starts_with("the denominator's Bézier"));
        assert!(failed(&line[..1], &[1.0], [0.0, 1.0]).contains("degree 0"));
        assert!(failed(&[DVec3::X; 34], &[1.0], [0.0, 1.0]).contains("degree 33"));
        for domain in [[1.0, 1.0], [1.0, 0.0], [0.0, f64::NAN], [0.0, f64::INFINITY]] {
            failed(&line, &[1.0], domain);
        }
        assert!(failed(&[DVec3::X, f64::NAN * DVec3::X], &[1.0], [0.0, 1.0]).contains("NaN"));
        // Powers of the domain that leave the range spoil only what is multiplied by them.
        let mut padded = [DVec3::ZERO; 7];
        padded[1] = 1e-60 * DVec3::X;
        let long = NurbsCurve::from_powers(&padded, &[1.0], [0.0, 1e60]).unwrap();
        assert!(long.point_at(5e59).distance(DVec3::new(0.5, 0.0, 0.0)) < 1e-15);
        assert!(failed(&[DVec3::X, 1e80 * DVec3::X], &[1.0], [0.0, 1.0]).contains("1e80"));
    }
}
