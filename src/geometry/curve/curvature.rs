//! How much a curve bends.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::{CurveDerivatives, NurbsCurve};
use crate::math::rounding::power_of_two_below;

/// The rounding error of derivatives (from the control points, the basis and the sums), relative to
/// the sizes of the terms.
const ROUNDING_OF_TERMS: f64 = 16.0 * f64::EPSILON;

impl NurbsCurve {
    /// The error bound of [`CurveDerivatives::curvature_vector`] at `t`, in one over length, for
    /// rounding of the control points and of the sums over them; NaN or infinite where the curve
    /// stands still.
    pub fn curvature_error(&self, t: f64) -> f64 {
        let basis = self.knots().basis_derivatives(t);
        let active = &self.control()[basis.span - self.knots().degree()..=basis.span];
        let CurveDerivatives { point, first, second } = self.derivatives(t);
        let sizes = basis.orders.map(|values| {
            let sizes = active.iter().zip(values).map(|(&point, value)| value.abs() * point.abs());
            sizes.sum::<DVec4>()
        });
        let weight = sizes[0].w;
        let weight_slope: f64 =
            active.iter().zip(basis.orders[1]).map(|(point, value)| value * point.w).sum();
        let of_terms = |sizes: DVec4, at: DVec3| length(sizes.xyz()) + sizes.w * length(at);
        let first_error = of_terms(sizes[1], point) / weight;
        let by_weights = 2.0 * (sizes[1].w * length(first) + weight_slope.abs() * first_error);
        let second_error = (of_terms(sizes[2], point) + by_weights) / weight;
        let speed = length(first);
        ROUNDING_OF_TERMS * (second_error + length(second) / speed * first_error) / speed / speed
    }
}

impl CurveDerivatives {
    /// The curvature `κ = |C′ × C″| / |C′|³`, in one over length; 0 where the curve is straight.
    ///
    /// `None` where the curve stands still, `C′ = 0`. Curves of any size over domains of any length
    /// are measured alike.
    pub fn curvature(&self) -> Option<f64> {
        self.curvature_vector().map(DVec3::length)
    }

    /// The curvature vector: the part of `C″ / |C′|²` perpendicular to the curve. It points to the
    /// centre of curvature, and its length is the curvature.
    ///
    /// `None` where the curve stands still.
    pub fn curvature_vector(&self) -> Option<DVec3> {
        // Over a parameter in which the speed is about 1: no square overflows.
        let scale = power_of_two_below(self.first.abs().max_element());
        let (first, second) = (self.first / scale, self.second / scale / scale);
        let speed = first.length();
        let along = first / speed;
        let turning = second / speed;
        let vector = (turning - turning.dot(along) * along) / speed;
        vector.is_finite().then_some(vector)
    }

    /// The centre of curvature; `None` where the curve is straight or stands still.
    pub fn center_of_curvature(&self) -> Option<DVec3> {
        let vector = self.curvature_vector()?;
        let center = self.point + vector / vector.length() / vector.length();
        center.is_finite().then_some(center)
    }
}

/// The length of a vector, also where its square is beyond f64.
fn length(vector: DVec3) -> f64 {
    let scale = power_of_two_below(vector.abs().max_element());
    scale * (vector / scale).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes::{QuarticArc, circle_arc, circle_cubic, quarter_circle_quartic};
    use crate::geometry::{KnotVector, NurbsCurve};

    #[test]
    fn circles_bend_by_one_over_their_radius_whatever_their_degree() {
        for radius in [1e-8, 1.0, 3.0, 1e8] {
            let arc = circle_arc(radius, 10.0, 350.0).unwrap();
            for k in 0..=40 {
                let at = arc.derivatives(f64::from(k) / 40.0);
                assert!((at.curvature().unwrap() * radius - 1.0).abs() < 1e-13, "{k}");
                assert!(at.center_of_curvature().unwrap().length() < 1e-13 * radius);
            }
        }
        for curve in [circle_cubic(), quarter_circle_quartic(QuarticArc::Second)] {
            for k in 0..=40 {
                let curvature = curve.derivatives(f64::from(k) / 40.0).curvature().unwrap();
                assert!((curvature - 1.0).abs() < 1e-13, "{k}: {curvature}");
            }
        }
    }

    #[test]
    fn circles_of_any_size_over_domains_of_any_length() {
        for (radius, length) in [(1e60, 1e-95), (1e60, 1e-100), (1e-60, 1e100), (1e-3, 1e150)] {
            let arc = circle_arc(radius, 10.0, 350.0).unwrap().on_domain(0.0, length).unwrap();
            for k in 0..=10 {
                let t = length * (f64::from(k) / 10.0);
                let curvature = arc.derivatives(t).curvature().unwrap();
                assert!((curvature * radius - 1.0).abs() < 1e-13, "{radius:e} {length:e}");
                let error = arc.curvature_error(t) * radius;
                assert!((1e-16..1e-12).contains(&error), "{radius:e} {length:e}: {error:e}");
            }
        }
    }

    #[test]
    fn straight_curves_bend_by_no_more_than_rounding() {
        // Coordinates that f64 cannot hold exactly, near the origin and far from it.
        for (far, at) in [(0.0, 1e-12), (1e6, 1e-6)] {
            let points =
                [0.0, 1.0, 3.0, 4.0, 4.5, 6.0].map(|x| DVec3::new(far + x, 0.3 * x, -0.7 * x));
            let knots = KnotVector::uniform(3, points.len()).unwrap();
            for weights in [
                None,
                Some(vec![1.0, 0.4, 0.7, 1.3, 0.9, 1.0]),
                Some(vec![1.0, 1e3, 1e-3, 1e2, 1e-2, 1.0]),
            ] {
                let uneven = weights.as_ref().is_some_and(|weights| weights.contains(&1e3));
                let curve = NurbsCurve::new(knots.clone(), points.to_vec(), weights).unwrap();
                let [start, end] = curve.domain();
                for k in 0..=40 {
                    let t = start + (end - start) * f64::from(k) / 40.0;
                    let (bend, error) =
                        (curve.derivatives(t).curvature().unwrap(), curve.curvature_error(t));
                    assert!(bend <= error && (uneven || error < at), "{k}: {bend:e} {error:e}");
                }
            }
        }
        let arc = circle_arc(2.0, 10.0, 350.0).unwrap();
        let off = |t: f64| (arc.derivatives(t).curvature().unwrap() - 0.5).abs();
        assert!(
            (0..=40).all(|k| off(f64::from(k) / 40.0) <= arc.curvature_error(f64::from(k) / 40.0))
        );
        assert!(arc.curvature_error(0.3) < 1e-12);
    }

    #[test]
    fn parabolas_lines_and_cusps() {
        // y = x²: κ = 2 / (1 + 4x²)^{3/2}.
        let parabola = [[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let parabola = NurbsCurve::bezier(&parabola).unwrap();
        for k in 0..=20 {
            let x = f64::from(k) / 20.0;
            let expected = 2.0 / (1.0 + 4.0 * x * x).powf(1.5);
            let found = parabola.derivatives(x).curvature().unwrap();
            assert!((found - expected).abs() < 1e-14, "{x}: {found}");
        }
        let line = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::ONE]).unwrap();
        assert_eq!(line.derivatives(0.5).curvature(), Some(0.0));
        assert_eq!(line.derivatives(0.5).center_of_curvature(), None);
        let points = vec![DVec3::ZERO, DVec3::ZERO, DVec3::X];
        let cusp = NurbsCurve::new(KnotVector::bezier(2).unwrap(), points, None).unwrap();
        assert_eq!(cusp.derivatives(0.0).curvature(), None);
    }
}
