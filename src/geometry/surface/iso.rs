//! Curves of constant parameter on a surface.

use glam::DVec4;

use super::{NurbsSurface, SurfaceError};
use crate::geometry::knots::BasisValues;
use crate::geometry::{Direction, MAX_DEGREE, NurbsCurve};

impl NurbsSurface {
    /// The curve on which one parameter is `t`, exactly: `v ↦ S(t, v)`, or `u ↦ S(u, t)`.
    ///
    /// # Errors
    /// When `t` is off the domain.
    pub fn curve_at(&self, fixed: Direction, t: f64) -> Result<NurbsCurve, SurfaceError> {
        let (across, along) = (self.knots(fixed), self.knots(fixed.other()));
        let [start, end] = across.domain();
        let within = start <= t && t <= end; // false for NaN
        if !within {
            return Err(SurfaceError::Parameter { direction: fixed, t, start, end });
        }
        let mut values: BasisValues = [0.0; MAX_DEGREE + 1];
        let p = across.degree();
        let first = across.basis(t, &mut values) - p;
        // Convex combinations, so that weights stay positive.
        let point = |k: usize| {
            let term = |(row, value): (usize, &f64)| {
                let [i, j] = fixed.pair(row, k);
                *value * self.homogeneous(i, j)
            };
            (first..).zip(&values[..=p]).map(term).sum::<DVec4>()
        };
        let control = (0..along.point_count()).map(point).collect();
        Ok(NurbsCurve::assembled(along.clone(), control))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use crate::geometry::{Direction, shapes};

    #[test]
    fn curves_lie_on_the_surface_at_their_parameter() {
        let sphere = shapes::sphere(2.0).unwrap();
        for k in 0..=16 {
            let t = f64::from(k) / 16.0;
            let [along_v, along_u] =
                Direction::BOTH.map(|fixed| sphere.curve_at(fixed, t).unwrap());
            for l in 0..=16 {
                let s = f64::from(l) / 16.0;
                assert!(along_v.point_at(s).distance(sphere.point_at(DVec2::new(t, s))) < 2e-15);
                assert!(along_u.point_at(s).distance(sphere.point_at(DVec2::new(s, t))) < 2e-15);
            }
        }
        assert_eq!(
            sphere.curve_at(Direction::U, 1.5).unwrap_err().to_string(),
            "direction u: the parameter 1.5 does not lie inside the domain from 0 to 1"
        );
        assert!(sphere.curve_at(Direction::V, f64::NAN).is_err());
    }
}
