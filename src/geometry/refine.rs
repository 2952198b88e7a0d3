//! Other control nets for the same surface: knot insertion and clamping.

use glam::DVec4;

use super::line::{merged, refine, restrict};
use super::{Direction, KnotError, KnotVector, NurbsSurface, SurfaceError};

impl NurbsSurface {
    /// The same surface with the knot `t` inserted `times` times in u.
    ///
    /// # Errors
    /// When `t` is off the domain or would occur more than `p + 1` times.
    pub fn insert_knot_u(&self, t: f64, times: usize) -> Result<Self, SurfaceError> {
        self.insert_knot(Direction::U, t, times)
    }

    /// The same surface with the knot `t` inserted `times` times in v.
    ///
    /// # Errors
    /// When `t` is off the domain or would occur more than `q + 1` times.
    pub fn insert_knot_v(&self, t: f64, times: usize) -> Result<Self, SurfaceError> {
        self.insert_knot(Direction::V, t, times)
    }

    fn insert_knot(
        &self,
        direction: Direction,
        t: f64,
        times: usize,
    ) -> Result<Self, SurfaceError> {
        let knots = self.knots(direction);
        let (degree, (start, end)) = (knots.degree(), knots.domain());
        let within = start <= t && t <= end; // false for NaN
        if !within {
            return Err(SurfaceError::Parameter { direction, t, start, end });
        }
        let total = knots.multiplicity(t).saturating_add(times);
        if total > degree + 1 {
            let error = KnotError::Multiplicity { knot: t, times: total, degree };
            return Err(SurfaceError::Knots { direction, error });
        }
        Ok(self.refined(direction, &vec![t; times]))
    }

    /// The same surface with valid new knots, in increasing order.
    fn refined(&self, direction: Direction, new: &[f64]) -> Self {
        let knots = self.knots(direction);
        let values = merged(knots.values(), new);
        let to = KnotVector::derived(knots.degree(), values);
        self.with_lines(direction, to, |line| refine(knots, line, new))
    }

    /// The same surface with knots of multiplicity `p + 1` at the ends of both domains and
    /// none outside. Unclamped and periodic surfaces change their nets, clamped ones nothing.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let [domain_u, domain_v] = self.domain();
        self.restricted(Direction::U, domain_u).restricted(Direction::V, domain_v)
    }

    /// The part of the surface between two parameters of its domain, clamped there.
    pub(super) fn restricted(&self, direction: Direction, range: (f64, f64)) -> Self {
        let knots = self.knots(direction);
        let (to, _) = restrict(knots, &vec![DVec4::W; knots.point_count()], range);
        self.with_lines(direction, to, |line| restrict(knots, line, range).1)
    }

    /// The surface whose net is made by `operation` from each line of control points that
    /// runs along a direction, and whose knots in that direction are `knots`.
    pub(super) fn with_lines(
        &self,
        direction: Direction,
        knots: KnotVector,
        operation: impl Fn(&[DVec4]) -> Vec<DVec4>,
    ) -> Self {
        let (nu, nv) = self.size();
        match direction {
            Direction::V => {
                let control = self.control().chunks(nv).flat_map(operation).collect();
                Self::assembled([self.knots_u().clone(), knots], control)
            }
            Direction::U => {
                let mut control = vec![DVec4::ZERO; knots.point_count() * nv];
                for j in 0..nv {
                    let column: Vec<_> = (0..nu).map(|i| self.homogeneous(i, j)).collect();
                    for (i, point) in operation(&column).into_iter().enumerate() {
                        control[i * nv + j] = point;
                    }
                }
                Self::assembled([knots, self.knots_v().clone()], control)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_uniform_surface_keeps_its_place_when_clamped_or_refined() {
        let knots = |p, n| KnotVector::uniform(p, n).unwrap();
        let points = (0..6 * 7).map(|k| {
            let (i, j) = ((k / 7) as f64, (k % 7) as f64);
            DVec3::new(i, j, (1.3 * i + j).sin())
        });
        let weights = (0..6 * 7).map(|k| 1.0 + 0.3 * f64::from(k).cos()).collect();
        let s =
            NurbsSurface::new(knots(3, 6), knots(2, 7), points.collect(), Some(weights)).unwrap();
        let refined = s.insert_knot_u(4.5, 4).unwrap().insert_knot_v(3.0, 1).unwrap();
        let clamped = s.clamped();
        assert!(clamped.knots_u().is_clamped() && clamped.knots_v().is_clamped());
        for k in 0..=30 {
            let (u, v) = (3.0 + 0.1 * f64::from(k), 2.0 + f64::from(k) / 6.0);
            let point = s.point_at(u, v);
            assert!((point - clamped.point_at(u, v)).length() < 1e-14);
            assert!((point - refined.point_at(u, v)).length() < 1e-14);
        }
    }
}
