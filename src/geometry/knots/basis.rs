//! B-spline basis functions and their derivatives (Cox–de Boor).

use super::KnotVector;
use crate::geometry::MAX_DEGREE;

/// Room for the `p + 1` basis functions of any supported degree.
pub type BasisValues = [f64; MAX_DEGREE + 1];

/// The basis functions that do not vanish on one span, with two derivatives.
#[derive(Clone, Copy, Debug)]
pub struct BasisDerivatives {
    /// The span `i`: function `k` belongs to control point `i − p + k`.
    pub span: usize,
    /// `orders[d][k]` is derivative `d` of function `k`, for `k ≤ p`; 0 beyond.
    pub orders: [BasisValues; 3],
}

impl KnotVector {
    /// The `p + 1` basis functions `N_{i−p}, …, N_i` that do not vanish on the span `i` of
    /// `t`, written to the front of `values`; returns `i`.
    ///
    /// They are not negative on the domain and add up to 1. Off the domain the polynomials
    /// of its end spans continue. NaN gives NaN.
    ///
    /// Cox 1972, de Boor 1972: raising the degree from `q − 1` to `q` shares each function
    /// between two neighbours in the ratio `(t − t_l) : (t_r − t)` of the knots `t_l < t_r`
    /// that bound its support. As `t_l ≤ tᵢ < tᵢ₊₁ ≤ t_r`, no denominator vanishes.
    pub fn basis(&self, t: f64, values: &mut BasisValues) -> usize {
        let span = self.span_index(t);
        self.basis_on_span(span, self.degree(), t, values);
        span
    }

    /// The basis functions of a lower `degree` on the same knots and span.
    fn basis_on_span(&self, span: usize, degree: usize, t: f64, values: &mut BasisValues) {
        let knots = self.values();
        values[0] = 1.0;
        for q in 1..=degree {
            let mut from_left = 0.0;
            for k in 0..q {
                let (left, right) = (knots[span + 1 + k - q], knots[span + 1 + k]);
                let width = right - left;
                let function = values[k];
                values[k] = from_left + function * ((right - t) / width);
                from_left = function * ((t - left) / width);
            }
            values[q] = from_left;
        }
    }

    /// The basis functions at `t` with their first and second derivatives.
    ///
    /// `N′_{i,p} = p (N_{i,p−1} / (tᵢ₊ₚ − tᵢ) − N_{i+1,p−1} / (tᵢ₊ₚ₊₁ − tᵢ₊₁))`, applied
    /// once and twice (de Boor 1978, ch. X). At a knot they belong to the piece that
    /// begins there, at the end of the domain to the last piece.
    pub fn basis_derivatives(&self, t: f64) -> BasisDerivatives {
        let span = self.span_index(t);
        let p = self.degree();
        let mut orders = [[0.0; MAX_DEGREE + 1]; 3];
        self.basis_on_span(span, p, t, &mut orders[0]);
        self.basis_on_span(span, p - 1, t, &mut orders[1]);
        self.raise_derivative(span, p, &mut orders[1]);
        if p >= 2 {
            self.basis_on_span(span, p - 2, t, &mut orders[2]);
            self.raise_derivative(span, p - 1, &mut orders[2]);
            self.raise_derivative(span, p, &mut orders[2]);
        }
        BasisDerivatives { span, orders }
    }

    /// One application of the derivative formula: `values` holds combinations of the `q`
    /// functions of degree `q − 1` on the span, and receives those of degree `q`.
    fn raise_derivative(&self, span: usize, q: usize, values: &mut BasisValues) {
        let knots = self.values();
        let mut from_left = 0.0;
        for k in 0..q {
            let width = knots[span + 1 + k] - knots[span + 1 + k - q];
            let slope = q as f64 * (values[k] / width);
            values[k] = from_left - slope;
            from_left = slope;
        }
        values[q] = from_left;
    }
}
