//! Curves of constant parameter on a surface.

use glam::DVec4;

use super::{Direction, NurbsSurface, SurfaceError};
use crate::geometry::knots::BasisValues;
use crate::geometry::{KnotVector, MAX_DEGREE, NurbsCurve};

impl NurbsSurface {
    /// The curve `v ↦ S(u, v)`, exactly.
    ///
    /// # Errors
    /// When `u` is off the domain.
    pub fn curve_at_u(&self, u: f64) -> Result<NurbsCurve, SurfaceError> {
        let (nu, nv) = self.size();
        let line = |j: usize| (0..nu).map(move |i| self.homogeneous(i, j));
        let control = combined(self.knots_u(), u, Direction::U, (0..nv).map(line))?;
        Ok(NurbsCurve::assembled(self.knots_v().clone(), control))
    }

    /// The curve `u ↦ S(u, v)`, exactly.
    ///
    /// # Errors
    /// When `v` is off the domain.
    pub fn curve_at_v(&self, v: f64) -> Result<NurbsCurve, SurfaceError> {
        let (nu, nv) = self.size();
        let line = |i: usize| (0..nv).map(move |j| self.homogeneous(i, j));
        let control = combined(self.knots_v(), v, Direction::V, (0..nu).map(line))?;
        Ok(NurbsCurve::assembled(self.knots_u().clone(), control))
    }
}

/// The points at `t` of splines over the same knots: convex combinations, so that weights
/// stay positive.
fn combined<L: Iterator<Item = DVec4>>(
    knots: &KnotVector,
    t: f64,
    direction: Direction,
    lines: impl Iterator<Item = L>,
) -> Result<Vec<DVec4>, SurfaceError> {
    let (start, end) = knots.domain();
    let within = start <= t && t <= end; // false for NaN
    if !within {
        return Err(SurfaceError::Parameter { direction, t, start, end });
    }
    let mut values: BasisValues = [0.0; MAX_DEGREE + 1];
    let p = knots.degree();
    let first = knots.basis(t, &mut values) - p;
    let point = |line: L| {
        line.skip(first).zip(&values[..=p]).map(|(point, value)| *value * point).sum::<DVec4>()
    };
    Ok(lines.map(point).collect())
}

#[cfg(test)]
mod tests {
    use crate::geometry::shapes;

    #[test]
    fn curves_lie_on_the_surface_at_their_parameter() {
        let sphere = shapes::sphere(2.0).unwrap();
        for k in 0..=16 {
            let t = f64::from(k) / 16.0;
            let (along_v, along_u) = (sphere.curve_at_u(t).unwrap(), sphere.curve_at_v(t).unwrap());
            for l in 0..=16 {
                let s = f64::from(l) / 16.0;
                assert!(along_v.point_at(s).distance(sphere.point_at(t, s)) < 2e-15);
                assert!(along_u.point_at(s).distance(sphere.point_at(s, t)) < 2e-15);
            }
        }
        assert_eq!(
            sphere.curve_at_u(1.5).unwrap_err().to_string(),
            "direction u: the parameter 1.5 does not lie inside the domain from 0 to 1"
        );
        assert!(sphere.curve_at_v(f64::NAN).is_err());
    }
}
