//! Rational basis functions, with weights that may be zero.

use glam::DVec3;

use super::{CurveError, quotient};
use crate::geometry::knots::BasisValues;
use crate::geometry::knots::on_span;
use crate::geometry::{KnotVector, MAX_DEGREE, is_usable_weight};

/// Rational B-spline basis functions `Rᵢ(t) = hᵢ Nᵢ(t) / S(t)`, `S = Σ hᵢ Nᵢ`.
///
/// Weights may be zero here, as in Rogers' example 4.1: such a control point has no
/// influence. A curve could not keep it, because each control point of a curve must have a place
/// of its own in homogeneous space.
///
/// # Invariants, checked once on construction
/// - there are as many weights as the knots ask for, each 0 or [usable](is_usable_weight);
/// - `S` is positive on all of the closed domain.
#[derive(Clone, Debug, PartialEq)]
pub struct RationalBasis {
    knots: KnotVector,
    weights: Vec<f64>,
}

impl RationalBasis {
    /// The basis over these knots with these weights.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn new(knots: KnotVector, weights: Vec<f64>) -> Result<Self, CurveError> {
        if weights.len() != knots.point_count() {
            let (weights, points) = (weights.len(), knots.point_count());
            return Err(CurveError::WeightCount { weights, points });
        }
        let usable = |weight: f64| weight == 0.0 || is_usable_weight(weight);
        if let Some(index) = weights.iter().position(|&weight| !usable(weight)) {
            return Err(CurveError::BasisWeight { index, weight: weights[index] });
        }
        // Inside a span all its functions are positive, so that one positive weight suffices;
        // at the ends of a span fewer functions are positive.
        let basis = Self { knots, weights };
        for span in basis.knots.spans() {
            for t in [span.start, 0.5 * (span.start + span.end), span.end] {
                let sum = basis.sum(t);
                if sum <= 0.0 {
                    return Err(CurveError::NoWeight { t });
                }
            }
        }
        Ok(basis)
    }

    /// The knots.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The weights.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    fn sum(&self, t: f64) -> f64 {
        let (span, values) = self.active(t);
        let first = span - self.knots.degree();
        self.weights[first..=span].iter().zip(values).map(|(weight, value)| weight * value).sum()
    }

    fn active(&self, t: f64) -> (usize, BasisValues) {
        let mut values: BasisValues = [0.0; MAX_DEGREE + 1];
        let span = self.knots.basis(t, &mut values);
        (span, values)
    }

    /// All functions `R₀(t) …` at a parameter of the domain; they add up to 1.
    pub fn values(&self, t: f64) -> Vec<f64> {
        let (span, values) = self.active(t);
        let first = span - self.knots.degree();
        let sum = self.sum(t);
        let mut all = vec![0.0; self.weights.len()];
        for (k, weight) in self.weights[first..=span].iter().enumerate() {
            all[first + k] = weight * values[k] / sum;
        }
        all
    }

    /// One of the functions at a parameter of the domain; 0 for an index beyond the last.
    pub fn value(&self, index: usize, t: f64) -> f64 {
        let (span, values) = self.active(t);
        let first = span - self.knots.degree();
        if !(first..=span).contains(&index) {
            return 0.0;
        }
        self.weights[index] * values[index - first] / self.sum(t)
    }

    /// Derivative `order` of the function `index` at `t`. Order 0 is the function itself; an index
    /// beyond the last gives 0.
    ///
    /// It is not finite where a derivative up to this order is beyond f64. The time grows with the
    /// order and the degree.
    pub fn derivative(&self, index: usize, order: usize, t: f64) -> f64 {
        let (p, span) = (self.knots.degree(), self.knots.span_index(t));
        if !(span - p..=span).contains(&index) {
            return 0.0;
        }
        let part = |index: usize, order: usize| {
            let value = on_span((p, self.knots.values()), (index, order), (span, t));
            self.weights[index] * value
        };
        let own: Vec<f64> = (0..=p).map(|j| part(index, j)).collect();
        let mut sums: Vec<f64> =
            (0..=p).map(|j| (span - p..=span).map(|i| part(i, j)).sum()).collect();
        let weights = &self.weights[span - p..=span];
        if weights.iter().all(|&weight| weight == weights[0]) {
            sums[1..].fill(0.0); // not what rounding leaves
        }
        quotient::derivative(order, &own, &sums)
    }

    /// The first derivatives of all functions, `R′ᵢ = (hᵢ N′ᵢ − S′ Rᵢ) / S`.
    pub fn derivatives(&self, t: f64) -> Vec<f64> {
        let basis = self.knots.basis_derivatives(t);
        let first = basis.span - self.knots.degree();
        let weights = &self.weights[first..=basis.span];
        let sums = basis.orders.map(|order| {
            weights.iter().zip(order).map(|(weight, value)| weight * value).sum::<f64>()
        });
        let mut all = vec![0.0; self.weights.len()];
        for (k, weight) in weights.iter().enumerate() {
            let value = weight * basis.orders[0][k] / sums[0];
            all[first + k] = (weight * basis.orders[1][k] - sums[1] * value) / sums[0];
        }
        all
    }

    /// The point `Σ Rᵢ(t) Pᵢ` of the curve with these control points; `None` if their number is
    /// not that of the weights.
    pub fn point(&self, points: &[DVec3], t: f64) -> Option<DVec3> {
        Self::combined(points, &self.values(t))
    }

    /// The derivative of [`RationalBasis::point`] by `t`.
    pub fn tangent(&self, points: &[DVec3], t: f64) -> Option<DVec3> {
        Self::combined(points, &self.derivatives(t))
    }

    fn combined(points: &[DVec3], functions: &[f64]) -> Option<DVec3> {
        let same = points.len() == functions.len();
        same.then(|| points.iter().zip(functions).map(|(&point, value)| *value * point).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::NurbsCurve;

    const POINTS: [DVec3; 5] = [
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(1.0, 2.0, 0.0),
        DVec3::new(2.5, 0.0, 0.0),
        DVec3::new(4.0, 2.0, 0.0),
        DVec3::new(5.0, 0.0, 0.0),
    ];

    fn rogers(h3: f64) -> RationalBasis {
        let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]).unwrap();
        RationalBasis::new(knots, vec![1.0, 1.0, h3, 1.0, 1.0]).unwrap()
    }

    fn is(a: DVec3, x: f64, y: f64) -> bool {
        a.distance(DVec3::new(x, y, 0.0)) < 4e-15
    }

    /// Rogers 2001, example 4.1, with zero among its weights.
    #[test]
    fn rogers_example_for_all_four_weights() {
        // h₃; R₂ and R₃ at 3/2; the points at 3/2 (its y), 1 and 5/4; the derivative at 3/2.
        let cases = [
            (0.0, (0.5, 0.0), 2.0, (1.0, 2.0), (1.3, 2.0), 6.0),
            (0.25, (2. / 7., 3. / 7.), 8. / 7., (1.3, 1.6), (107. / 62., 40. / 31.), 24. / 7.),
            (1.0, (0.125, 0.75), 0.5, (1.75, 1.0), (2.125, 0.625), 1.5),
            (5.0, (1. / 32., 15. / 16.), 0.125, (2.25, 1. / 3.), (2.4, 1. / 6.), 0.375),
        ];
        for (h3, (r2, r3), y, one, five_quarters, speed) in cases {
            let basis = rogers(h3);
            let expected = [0.0, r2, r3, r2, 0.0];
            let found = basis.values(1.5);
            let one_by_one: Vec<f64> = (0..6).map(|index| basis.value(index, 1.5)).collect();
            assert_eq!(one_by_one, [&found[..], &[0.0]].concat());
            assert!(
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15),
                "{h3}: {found:?}"
            );
            assert!(is(basis.point(&POINTS, 1.5).unwrap(), 2.5, y), "{h3}");
            assert!(is(basis.point(&POINTS, 1.0).unwrap(), one.0, one.1), "{h3}");
            let at = basis.point(&POINTS, 1.25).unwrap();
            assert!(is(at, five_quarters.0, five_quarters.1), "{h3}: {at}");
            assert!(is(basis.tangent(&POINTS, 1.5).unwrap(), speed, 0.0), "{h3}");
            for k in 0..=30 {
                let t = f64::from(k) / 10.0;
                assert!((basis.values(t).iter().sum::<f64>() - 1.0).abs() < 1e-15);
                assert!(basis.derivatives(t).iter().sum::<f64>().abs() < 1e-14);
            }
        }
    }

    /// On [0, 1] with weights 1, h: R₁ = h t / (1 + (h − 1) t), whose derivatives are known to
    /// every order; and the first ones of Rogers' example.
    #[test]
    fn derivatives_of_every_order() {
        for h in [0.25, 1.0, 5.0] {
            let basis = RationalBasis::new(KnotVector::bezier(1).unwrap(), vec![1.0, h]).unwrap();
            for k in 0..=10 {
                let t = f64::from(k) / 10.0;
                let (a, mut expected) = (h - 1.0, h * t / (1.0 + (h - 1.0) * t));
                for order in 0..5 {
                    if order > 0 {
                        // h (−a)ᵏ⁻¹ k! / (1 + a t)ᵏ⁺¹
                        let factorial: f64 = (1..=order).map(f64::from).product();
                        expected =
                            h * (-a).powi(order - 1) * factorial / (1.0 + a * t).powi(order + 1);
                    }
                    let found = basis.derivative(1, order as usize, t);
                    let off = (found - expected).abs();
                    assert!(off <= 1e-13 * expected.abs().max(1.0), "{h}, {t}, {order}: {off:e}");
                }
            }
            let (basis, t) = (rogers(h), 1.3);
            let first = basis.derivatives(t);
            for (index, expected) in first.into_iter().enumerate() {
                assert!((basis.derivative(index, 1, t) - expected).abs() < 1e-14, "{h}, {index}");
            }
            assert_eq!(basis.derivative(5, 1, t), 0.0);
        }
    }

    /// With positive weights the functions give the curve that has them.
    #[test]
    fn positive_weights_give_the_rational_curve() {
        for h3 in [0.25, 1.0, 5.0, 1e8, 1e-8] {
            let basis = rogers(h3);
            let curve = NurbsCurve::new(
                basis.knots().clone(),
                POINTS.to_vec(),
                Some(basis.weights().to_vec()),
            );
            let curve = curve.unwrap();
            for k in 0..=60 {
                let t = f64::from(k) / 20.0;
                let at = curve.derivatives(t);
                assert!(basis.point(&POINTS, t).unwrap().distance(at.point) < 1e-14);
                let off = basis.tangent(&POINTS, t).unwrap().distance(at.first);
                assert!(off <= 1e-13 * at.first.length().max(1.0), "{h3}, {t}: {off:e}");
            }
        }
    }

    #[test]
    fn weights_that_leave_nothing_are_refused() {
        let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]).unwrap();
        let message = |weights: &[f64]| {
            RationalBasis::new(knots.clone(), weights.to_vec()).unwrap_err().to_string()
        };
        assert_eq!(
            message(&[0.0, 1.0, 1.0, 1.0, 1.0]),
            "the weights of all control points that matter at t = 0 are 0: one must be positive"
        );
        assert_eq!(
            message(&[1.0, 0.0, 0.0, 0.0, 1.0]),
            "the weights of all control points that matter at t = 1 are 0: one must be positive"
        );
        assert_eq!(
            message(&[1.0, -1.0, 1.0, 1.0, 1.0]),
            "the weight of control point 1 is -1: it must be finite, and not negative \
             (0, or from 1e-70 to 1e70)"
        );
        assert!(RationalBasis::new(knots.clone(), vec![1.0; 4]).is_err());
    }
}
