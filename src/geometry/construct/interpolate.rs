//! Splines through given points.

use glam::{DVec3, DVec4};

use crate::geometry::knots::BasisValues;
use crate::geometry::{CurveError, KnotError, KnotVector, MAX_DEGREE, NurbsCurve};

/// The equations `Σ Nᵢ(t_k) Pᵢ = Q_k`, factored once for any number of right-hand sides.
///
/// The first and the last `t_k` are the ends of the domain, and each inner knot is the average of
/// `p` neighbouring `t_k`, so that the Schoenberg–Whitney conditions hold. The matrix is banded and
/// totally positive: elimination without pivoting is stable (de Boor & Pinkus 1977).
#[derive(Clone, Debug)]
pub(crate) struct Interpolation {
    knots: KnotVector,
    /// Row k: the basis functions `k − p … k + p` at `t_k`.
    matrix: Vec<Vec<f64>>,
    /// The matrix after elimination: factors below the diagonal, the upper triangle on and above
    /// it.
    factors: Vec<Vec<f64>>,
}

impl Interpolation {
    /// The equations for increasing parameters, at least `degree + 1` of them.
    ///
    /// # Errors
    /// When there are too few parameters, or some that belong to different knots coincide.
    pub(crate) fn new(degree: usize, parameters: &[f64]) -> Result<Self, KnotError> {
        let knots = averaged_knots(degree, parameters)?;
        let p = degree;
        let mut values: BasisValues = [0.0; MAX_DEGREE + 1];
        let mut matrix = Vec::with_capacity(parameters.len());
        for (k, &t) in parameters.iter().enumerate() {
            let first = knots.basis(t, &mut values) - p;
            let mut row = vec![0.0; 2 * p + 1];
            for (a, &value) in values[..=p].iter().enumerate() {
                // Column i of row k is stored at i + p − k; outside the band all are zero.
                if let Some(entry) = (first + a + p).checked_sub(k).and_then(|b| row.get_mut(b)) {
                    *entry = value;
                }
            }
            matrix.push(row);
        }
        let mut factors = matrix.clone();
        for k in 0..factors.len() {
            for below in k + 1..(k + p + 1).min(factors.len()) {
                let factor = factors[below][k + p - below] / factors[k][p];
                factors[below][k + p - below] = factor;
                for i in k + 1..=k + p {
                    factors[below][i + p - below] -= factor * factors[k][i + p - k];
                }
            }
        }
        Ok(Self { knots, matrix, factors })
    }

    /// The knots of the spline.
    pub(crate) fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The control points of the spline through these points.
    ///
    /// The solution is improved once by its own residual, which leaves errors of a few rounding
    /// errors of the points.
    pub(crate) fn control(&self, through: &[DVec4]) -> Vec<DVec4> {
        let mut control = self.solved(through.to_vec());
        let p = self.knots.degree();
        let residual = through.iter().enumerate().map(|(k, &point)| {
            let row = self.matrix[k].iter().enumerate();
            let sum: DVec4 = row
                .filter_map(|(b, &entry)| Some(entry * *control.get((k + b).checked_sub(p)?)?))
                .sum();
            point - sum
        });
        let correction = self.solved(residual.collect());
        for (point, by) in control.iter_mut().zip(correction) {
            *point += by;
        }
        // The end points are interpolated exactly.
        let last = control.len() - 1;
        (control[0], control[last]) = (through[0], through[last]);
        control
    }

    fn solved(&self, mut x: Vec<DVec4>) -> Vec<DVec4> {
        let (p, n) = (self.knots.degree(), x.len());
        for k in 0..n {
            for i in k.saturating_sub(p)..k {
                x[k] = x[k] - self.factors[k][i + p - k] * x[i];
            }
        }
        for k in (0..n).rev() {
            for i in k + 1..(k + p + 1).min(n) {
                x[k] = x[k] - self.factors[k][i + p - k] * x[i];
            }
            x[k] /= self.factors[k][p];
        }
        x
    }
}

/// Clamped knots whose inner ones are the averages of `p` neighbouring parameters
/// (Piegl & Tiller 1997, eq. 9.8).
fn averaged_knots(degree: usize, parameters: &[f64]) -> Result<KnotVector, KnotError> {
    let points = parameters.len();
    KnotVector::clamped_uniform(degree, points)?; // checks the counts
    let (first, last) = (parameters[0], parameters[points - 1]);
    let mut values = vec![first; degree + 1];
    let inner = parameters[1..points - 1].windows(degree).take(points - degree - 1);
    values.extend(inner.map(|window| window.iter().sum::<f64>() / degree as f64));
    values.extend(std::iter::repeat_n(last, degree + 1));
    KnotVector::new(degree, values)
}

impl NurbsCurve {
    /// The spline of this degree through these points in order, with chord lengths as parameters
    /// and averaged knots (Piegl & Tiller 1997, 9.2.1).
    ///
    /// Its domain begins at 0 and is as long as the polygon; point `k` is met at the parameter that
    /// it has on the polygon.
    ///
    /// # Errors
    /// When there are fewer than `degree + 1` points, one is not finite, or two in a row
    /// coincide.
    pub fn through(points: &[DVec3], degree: usize) -> Result<Self, CurveError> {
        KnotVector::clamped_uniform(degree, points.len())?; // checks the counts first
        let polygon = Self::polyline(points)?;
        let parameters = &polygon.knots().values()[1..=points.len()];
        let equations = Interpolation::new(degree, parameters)?;
        let through: Vec<DVec4> = points.iter().map(|point| point.extend(1.0)).collect();
        let control = equations.control(&through);
        let polynomial = control.into_iter().map(|point| point.truncate().extend(1.0));
        Self::from_homogeneous(equations.knots().clone(), polynomial.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wiggle(k: usize, size: f64) -> DVec3 {
        let t = k as f64;
        size * DVec3::new(t + (2.3 * t).sin() * 0.4, (1.7 * t).cos(), (0.6 * t).sin())
    }

    #[test]
    fn the_points_are_met_for_every_degree_and_size() {
        for size in [1e-8, 1.0, 1e8] {
            for degree in 1..=8 {
                let points: Vec<DVec3> = (0..40).map(|k| wiggle(k, size)).collect();
                let curve = NurbsCurve::through(&points, degree).unwrap();
                assert_eq!(curve.knots().point_count(), 40);
                let mut t = 0.0;
                for (k, &point) in points.iter().enumerate() {
                    t += if k > 0 { point.distance(points[k - 1]) } else { 0.0 };
                    let off = curve.point_at(t).distance(point) / curve.magnitude();
                    assert!(off < 4e-15, "degree {degree}, point {k}: off by {off:e}");
                }
            }
        }
    }

    #[test]
    fn what_is_a_polynomial_of_the_chord_length_comes_back() {
        // Points of a straight line at odd distances: the line, at unit speed.
        let points = [0.0, 0.3, 1.9, 2.0, 4.5, 5.0].map(|t| DVec3::new(0.6 * t, 0.8 * t, 1.0));
        let line = NurbsCurve::through(&points, 3).unwrap();
        for k in 0..=50 {
            let t = f64::from(k) / 10.0;
            let off = line.point_at(t).distance(DVec3::new(0.6 * t, 0.8 * t, 1.0));
            assert!(off < 4e-15, "{t}: {off:e}");
        }
    }

    #[test]
    fn a_parabola_through_three_points_has_its_textbook_form() {
        // Chords of equal length: parameters 0, √2, 2√2 and the middle control point 2Q₁ − …
        let points = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]].map(DVec3::from);
        let curve = NurbsCurve::through(&points, 2).unwrap();
        assert!(curve.vertex(1).distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-15);
    }

    #[test]
    fn too_few_points_and_doubled_ones() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::X];
        assert_eq!(
            NurbsCurve::through(&points[..2], 3).unwrap_err().to_string(),
            "2 points of degree 3: at least 4 are needed"
        );
        assert_eq!(
            NurbsCurve::through(&points[..1], 5).unwrap_err().to_string(),
            "1 point of degree 5: at least 6 are needed"
        );
        assert_eq!(
            NurbsCurve::through(&points, 1).unwrap_err().to_string(),
            "points 1 and 2 coincide: neighbours must differ"
        );
    }
}
