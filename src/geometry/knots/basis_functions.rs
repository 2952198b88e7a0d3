//! B-spline basis functions one by one, over any knots.

use super::BasisValues;
use super::MAX_DEGREE;
use super::knot_vector::check_order;
use super::{KnotError, KnotVector};

/// The basis functions `N_{i,p}` of one degree over knots `t₀ ≤ t₁ ≤ …`, each on all of its
/// support `[tᵢ, tᵢ₊ₚ₊₁]`.
///
/// The knots need not make curves, as a [`KnotVector`] must: degree 0, knots repeated more than
/// `p + 1` times, and knots for a single function are allowed. So the functions of every degree up
/// to p over the knots of degree p are the textbooks', with the same indices, though some vanish.
///
/// # Invariants, checked once on construction
/// - `0 ≤ p ≤` [`MAX_DEGREE`], and there are `p + 2` knots or more, of which two differ;
/// - every knot is finite, none is smaller than the one before it, and `t_last − t₀` is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct BasisFunctions {
    degree: usize,
    knots: Vec<f64>,
}

impl From<&KnotVector> for BasisFunctions {
    fn from(knots: &KnotVector) -> Self {
        Self { degree: knots.degree(), knots: knots.values().to_vec() }
    }
}

impl BasisFunctions {
    /// The functions of this degree over these knots, where multiple knots are listed repeatedly.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, KnotError> {
        if degree > MAX_DEGREE {
            return Err(KnotError::BasisDegree { degree });
        }
        if knots.len() < degree + 2 {
            return Err(KnotError::NoFunction { knots: knots.len(), degree });
        }
        check_order(&knots)?;
        if knots[0] == knots[knots.len() - 1] {
            return Err(KnotError::AllEqual { knot: knots[0] });
        }
        Ok(Self { degree, knots })
    }

    /// The degree `p`.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, in order.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The number of functions.
    pub fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Whether the function `index` is 0 everywhere: all its knots are equal, or it does not exist.
    pub fn vanishes(&self, index: usize) -> bool {
        index >= self.count() || self.knots[index] == self.knots[index + self.degree + 1]
    }

    /// The function `index` at `t`; 0 off its support, and for an index beyond the last.
    ///
    /// At a knot the value is that of the piece that begins there. At the last knot it is that of
    /// the last piece, so that the functions over clamped knots add up to 1 there, too.
    pub fn value(&self, index: usize, t: f64) -> f64 {
        self.derivative(index, 0, t)
    }

    /// Derivative `order` of the function `index` at `t`; order 0 is the function itself.
    /// At a knot it belongs to the same piece as [`BasisFunctions::value`].
    pub fn derivative(&self, index: usize, order: usize, t: f64) -> f64 {
        if index >= self.count() {
            return 0.0;
        }
        let on = |span| on_span((self.degree, &self.knots), (index, order), (span, t));
        self.span(t).map_or(0.0, on)
    }

    /// Index `i` of the span `[tᵢ, tᵢ₊₁)` that holds `t`; `None` outside the knots and for NaN.
    fn span(&self, t: f64) -> Option<usize> {
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let within = first <= t && t <= last; // false for NaN
        within.then(|| self.knots.partition_point(|&knot| knot <= t && knot < last) - 1)
    }
}

/// Derivative `order` of the function `index` at `t`, which is in the span `[t_span, t_{span+1}]`.
///
/// The recurrence starts from `N_{j,0}`, which is 1 on the span j (Cox 1972, de Boor 1972):
///
/// `N_{i,q} = (t − tᵢ) N_{i,q−1} / (tᵢ₊q − tᵢ) + (tᵢ₊q₊₁ − t) N_{i+1,q−1} / (tᵢ₊q₊₁ − tᵢ₊₁)`,
///
/// and for the last `order` degrees `N′_{i,q} = q N_{i,q−1} / (tᵢ₊q − tᵢ) − q N_{i+1,q−1} /
/// (tᵢ₊q₊₁ − tᵢ₊₁)`. A function that vanishes adds 0, even where its denominator is 0.
pub(crate) fn on_span(
    (degree, knots): (usize, &[f64]),
    (index, order): (usize, usize),
    (span, t): (usize, f64),
) -> f64 {
    if order > degree || !(index..=index + degree).contains(&span) {
        return 0.0;
    }
    let mut values: BasisValues = [0.0; MAX_DEGREE + 1];
    values[span - index] = 1.0;
    let share = |part: f64, width: f64| if width > 0.0 { part / width } else { 0.0 };
    for q in 1..=degree {
        for j in 0..=degree - q {
            let (start, end) = (index + j, index + j + q);
            let widths = [knots[end] - knots[start], knots[end + 1] - knots[start + 1]];
            let [rising, falling] = if q + order <= degree {
                [share(t - knots[start], widths[0]), share(knots[end + 1] - t, widths[1])]
            } else {
                [share(q as f64, widths[0]), -share(q as f64, widths[1])]
            };
            values[j] = values[j] * rising + values[j + 1] * falling;
        }
    }
    values[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The deck's knots of degree 3; it defines functions of lower degrees over them, too.
    const KNOTS: [f64; 11] = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 4.0];

    fn over(degree: usize, knots: &[f64]) -> BasisFunctions {
        BasisFunctions::new(degree, knots.to_vec()).unwrap()
    }

    #[test]
    fn functions_of_lower_degrees_keep_their_indices() {
        // Degree 0: 1 on the span i, closed at the very end.
        let boxes = over(0, &KNOTS);
        assert_eq!(boxes.count(), 10);
        for k in 0..=40 {
            let t = f64::from(k) / 10.0;
            let own = 3 + (t.floor() as usize).min(3);
            for index in 0..10 {
                assert_eq!(
                    boxes.value(index, t),
                    f64::from(u8::from(index == own)),
                    "{index}, {t}"
                );
            }
        }
        // Degree 1: hats; the first and the last that do not vanish are half hats.
        let hats = over(1, &KNOTS);
        assert_eq!(hats.count(), 9);
        for k in 0..=40 {
            let t = f64::from(k) / 10.0;
            for index in 0..9 {
                let expected = match index {
                    2..=6 => (1.0 - (t - (index as f64 - 2.0)).abs()).max(0.0),
                    _ => 0.0,
                };
                assert!((hats.value(index, t) - expected).abs() < 1e-15, "{index}, {t}");
            }
        }
        assert_eq!((0..10).filter(|&index| boxes.vanishes(index)).count(), 6);
        assert_eq!((0..9).filter(|&index| hats.vanishes(index)).count(), 4);
        // Degree 2 from t = 0 on: (1 − t)², 2t − 3t²/2, t²/2.
        let quadratics = over(2, &KNOTS);
        for k in 0..10 {
            let t = f64::from(k) / 10.0;
            let expected =
                [0.0, (1.0 - t).powi(2), 2.0 * t - 1.5 * t * t, 0.5 * t * t, 0.0, 0.0, 0.0, 0.0];
            for (index, expected) in expected.into_iter().enumerate() {
                assert!((quadratics.value(index, t) - expected).abs() < 1e-15, "{index}, {t}");
            }
        }
    }

    /// A single uniform cubic: the four pieces of the cardinal spline, and 0 off its support.
    #[test]
    fn one_function_over_its_own_knots() {
        let one = over(3, &[0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(one.count(), 1);
        let truncated = |x: f64| x.max(0.0).powi(3);
        for k in -10..=50 {
            let t = f64::from(k) / 10.0;
            // The fourth difference of (t − k)³₊ / 3!.
            let expected = (truncated(t) - 4.0 * truncated(t - 1.0) + 6.0 * truncated(t - 2.0)
                - 4.0 * truncated(t - 3.0)
                + truncated(t - 4.0))
                / 6.0;
            assert!((one.value(0, t) - expected).abs() < 1e-14, "{t}: {expected}");
        }
        assert_eq!((one.value(1, 2.0), one.value(0, f64::NAN)), (0.0, 0.0));
    }

    /// On the domain of a knot vector the functions are its own; over Bézier knots, Bernstein's.
    #[test]
    fn over_a_knot_vector_they_are_its_own() {
        let mut values = [0.0; MAX_DEGREE + 1];
        for knots in [
            KnotVector::new(3, KNOTS.to_vec()).unwrap(),
            KnotVector::uniform(4, 9).unwrap(),
            KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.5, 2.0, 2.0, 2.0]).unwrap(),
        ] {
            let (functions, [start, end]) = (BasisFunctions::from(&knots), knots.domain());
            for k in 0..=64 {
                let t = start + f64::from(k) / 64.0 * (end - start);
                let span = knots.basis(t, &mut values);
                for index in 0..functions.count() {
                    let local = (index + knots.degree()).checked_sub(span);
                    let expected =
                        local.filter(|&k| k <= knots.degree()).map_or(0.0, |k| values[k]);
                    assert!((functions.value(index, t) - expected).abs() < 1e-15, "{index}, {t}");
                }
            }
        }
        let bernstein = over(3, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        let t: f64 = 0.3;
        assert!((bernstein.value(1, t) - 3.0 * t * (1.0 - t).powi(2)).abs() < 1e-15);
        assert_eq!(bernstein.value(3, 1.0), 1.0);
    }

    /// All derivatives of the cubics from t = 0 on, (1 − t)³ and 3t − 9t²/2 + 7t³/4; for a single
    /// uniform cubic, the differences of truncated powers.
    #[test]
    fn derivatives_are_those_of_the_pieces() {
        let cubics = over(3, &KNOTS);
        for k in 0..10 {
            let t = f64::from(k) / 10.0;
            let first = [(1.0 - t).powi(3), -3.0 * (1.0 - t).powi(2), 6.0 * (1.0 - t), -6.0];
            let second = [
                3.0 * t - 4.5 * t * t + 1.75 * t.powi(3),
                3.0 - 9.0 * t + 5.25 * t * t,
                -9.0 + 10.5 * t,
                10.5,
            ];
            for order in 0..4 {
                let found = [0, 1].map(|index| cubics.derivative(index, order, t));
                let expected = [first[order], second[order]];
                let off = |k: usize| (found[k] - expected[k]).abs();
                assert!(off(0).max(off(1)) < 2e-14, "{order}, {t}: {found:?} for {expected:?}");
                let sum: f64 = (0..7).map(|index| cubics.derivative(index, order, t)).sum();
                assert!((sum - f64::from(u8::from(order == 0))).abs() < 2e-14, "{order}, {t}");
            }
            assert_eq!(cubics.derivative(0, 4, t), 0.0);
        }
        let one = over(3, &[0.0, 1.0, 2.0, 3.0, 4.0]);
        for k in 0..40 {
            let t = (f64::from(k) + 0.5) / 10.0;
            let ramp = |x: f64| 0.5 * x.max(0.0).powi(2);
            let slope = ramp(t) - 4.0 * ramp(t - 1.0) + 6.0 * ramp(t - 2.0) - 4.0 * ramp(t - 3.0);
            assert!((one.derivative(0, 1, t) - slope).abs() < 1e-14, "{t}");
            let third = [1.0, -3.0, 3.0, -1.0][t as usize];
            assert!((one.derivative(0, 3, t) - third).abs() < 1e-14, "{t}");
        }
    }

    #[test]
    fn what_is_no_basis_is_refused() {
        let message = |degree, knots: &[f64]| {
            BasisFunctions::new(degree, knots.to_vec()).unwrap_err().to_string()
        };
        assert_eq!(message(33, &[]), "degree 33: degrees from 0 to 32 are supported");
        assert_eq!(
            message(2, &[0.0, 1.0, 2.0]),
            "3 knots of degree 2: at least 4 are needed for one function"
        );
        assert_eq!(message(0, &[1.0, 1.0]), "all knots are 1: two must differ");
        assert_eq!(message(0, &[1.0, 0.5]), "knot 1 is 0.5 after 1: knots must not decrease");
        assert_eq!(
            message(0, &[0.0, f64::INFINITY]),
            "knot 1 is inf: knots must be finite numbers"
        );
    }
}
