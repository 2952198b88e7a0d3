//! Extremes of a coordinate of a rational Bézier piece, and sign changes of a polynomial.

use crate::math::bernstein::{binomial, restrict};
use crate::math::rounding::UNIT_ROUNDOFF;

/// Extremes are isolated to parameter intervals of this length: the spacing of numbers below 1.
pub(crate) const FINEST_INTERVAL: f64 = UNIT_ROUNDOFF;

/// Adds to `found`, in no order, the parameters in (0, 1) where a coordinate of a rational Bézier
/// piece may have an extreme: all places where the sign of its derivative changes, to within
/// [`FINEST_INTERVAL`], and perhaps some where a change could not be excluded.
///
/// The coordinate is given as its homogeneous Bernstein coefficients (products with the
/// weights). It is measured from `center`: this changes no extreme, but for coordinates far from 0
/// it saves the digits in which the points differ.
pub(crate) fn add_extremes(coordinate: &[f64], weights: &[f64], center: f64, found: &mut Vec<f64>) {
    Polynomial::derivative(coordinate, weights, center).roots(found);
}

/// Adds to `found`, in no order, the parameters in (0, 1) where a polynomial changes its sign, to
/// within [`FINEST_INTERVAL`], and perhaps some where a change could not be excluded. The
/// polynomial is given as its Bernstein coefficients, each with a bound on its rounding error.
pub(crate) fn add_sign_changes(coefficients: Vec<f64>, noise: Vec<f64>, found: &mut Vec<f64>) {
    Polynomial { coefficients, noise }.roots(found);
}

/// A polynomial as Bernstein coefficients, each with a bound on its rounding error. For extremes it
/// is the numerator `x′ w − x w′` of a coordinate's derivative, up to a positive factor.
#[derive(Clone)]
struct Polynomial {
    coefficients: Vec<f64>,
    noise: Vec<f64>,
}

impl Polynomial {
    /// The numerator of the derivative of a coordinate measured from `center`.
    fn derivative(coordinate: &[f64], weights: &[f64], center: f64) -> Self {
        let p = weights.len() - 1;
        let pairs = || coordinate.iter().zip(weights);
        let centered: Vec<f64> = pairs().map(|(x, w)| x - center * w).collect();
        let size: Vec<f64> = pairs().map(|(x, w)| x.abs() + center.abs() * w).collect();
        let unit = 4.0 * (p + 2) as f64 * UNIT_ROUNDOFF;

        if weights.iter().all(|w| *w == weights[0]) {
            let coefficients = centered.windows(2).map(|x| x[1] - x[0]).collect();
            // Equal weights enter no product, and control points are as given.
            let noise = size.windows(2).map(|m| UNIT_ROUNDOFF * (m[0] + m[1])).collect();
            return Self { coefficients, noise };
        }
        let mut coefficients = vec![0.0; 2 * p];
        let mut noise = vec![0.0; 2 * p];
        for i in 0..p {
            let (dx, dw) = (centered[i + 1] - centered[i], weights[i + 1] - weights[i]);
            let (sx, sw) = (size[i + 1] + size[i], weights[i + 1] + weights[i]);
            for j in 0..=p {
                // B_i of degree p − 1 times B_j of degree p is `share` times B_{i+j}.
                let share = binomial(p - 1, i) * binomial(p, j) / binomial(2 * p - 1, i + j);
                coefficients[i + j] += share * (dx * weights[j] - centered[j] * dw);
                noise[i + j] += share * unit * (sx * weights[j] + size[j] * sw);
            }
        }
        Self { coefficients, noise }
    }

    /// Adds the places in (0, 1) where the sign changes, and perhaps some where a change could not
    /// be excluded.
    ///
    /// Halving brings the coefficients closer to the polynomial's values; a part whose coefficients
    /// have one sign is dropped. By Descartes' rule no more parts remain than there are
    /// coefficients, and they are halved at most 53 times.
    fn roots(self, found: &mut Vec<f64>) {
        let mut waiting = vec![(self, [0.0, 1.0])];
        while let Some((part, [from, to])) = waiting.pop() {
            if part.has_one_sign() {
                continue;
            }
            let middle = 0.5 * (from + to);
            if to - from <= FINEST_INTERVAL {
                found.push(middle);
                continue;
            }
            let [below, above] = part.halves();
            // Neither half would find a root exactly at the cut.
            if above.coefficients[0].abs() <= above.noise[0] {
                found.push(middle);
            }
            waiting.push((below, [from, middle]));
            waiting.push((above, [middle, to]));
        }
    }

    fn has_one_sign(&self) -> bool {
        let pairs = || self.coefficients.iter().zip(&self.noise);
        let some_below = pairs().any(|(c, noise)| *c < -noise);
        let some_above = pairs().any(|(c, noise)| *c > *noise);
        !(some_below && some_above)
    }

    fn halves(self) -> [Self; 2] {
        let mut below = self.clone();
        let mut above = self;
        for (half, from, to) in [(&mut below, 0.0, 0.5), (&mut above, 0.5, 1.0)] {
            restrict(&mut half.coefficients, from, to);
            restrict(&mut half.noise, from, to);
        }
        [below, above]
    }
}
