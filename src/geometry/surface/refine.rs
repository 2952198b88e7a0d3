//! Other control nets for the same surface, and for its parts: knot insertion, clamping,
//! splitting, degree elevation.

use std::borrow::Cow;

use glam::DVec4;
use rayon::prelude::*;

use super::nurbs_surface::check_domain;
use super::{BezierForm, NurbsSurface, SurfaceError};
use crate::geometry::polygon::elevate;
use crate::geometry::polygon::{Insertions, merged, restrict};
use crate::geometry::{Direction, KnotError, KnotVector, MAX_DEGREE};

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
        let (degree, [start, end]) = (knots.degree(), knots.domain());
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

    /// The same surface with the knots `new` inserted, which are valid and in increasing order.
    pub(crate) fn refined(&self, direction: Direction, new: &[f64]) -> Self {
        let knots = self.knots(direction);
        let values = merged(knots.values(), new);
        let to = KnotVector::derived(knots.degree(), values);
        let insertions = Insertions::new(knots, new);
        match direction {
            Direction::U => {
                let [_, length] = self.size();
                let control = insertions.apply_to_rows(self.control(), length);
                Self::assembled([to, self.knots_v().clone()], control)
            }
            Direction::V => self.with_lines(direction, to, |line| insertions.apply(line)),
        }
    }

    /// The same surface with knots of multiplicity `p + 1` at the ends of both domains and
    /// none outside. Nets of unclamped and periodic surfaces change, those of clamped ones do not.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let [domain_u, domain_v] = self.domain();
        self.restricted(Direction::U, domain_u).restricted(Direction::V, domain_v)
    }

    /// The surface itself if it is clamped, else [`Self::clamped`].
    pub(crate) fn in_clamped_form(&self) -> Cow<'_, Self> {
        let is_clamped = self.knots_u().is_clamped() && self.knots_v().is_clamped();
        if is_clamped { Cow::Borrowed(self) } else { Cow::Owned(self.clamped()) }
    }

    /// The same surface as a net of Bézier pieces: clamped, with every inner knot at least
    /// `p` times. Neighbouring pieces share the control points of their common edge, except
    /// where a knot of multiplicity `p + 1` lets the surface jump.
    #[must_use]
    pub fn bezier_form(&self) -> Self {
        let form = BezierForm::new(self);
        let knots = form.knots().map(KnotVector::clone);
        let rows = (0..knots[0].point_count()).into_par_iter();
        let control = rows.flat_map_iter(|i| form.row(i)).collect();
        Self::assembled(knots, control)
    }

    /// The number of control points of [`Self::bezier_form`] if the surface jumps nowhere.
    pub(crate) fn bezier_point_count(&self) -> usize {
        let [u, v] = [self.knots_u(), self.knots_v()]
            .map(|knots| knots.spans().count() * knots.degree() + 1);
        u.saturating_mul(v)
    }

    /// The two parts of the surface below and above `u = t`, each clamped in u.
    ///
    /// They share the control points of the edge between them bit for bit, unless a knot of
    /// multiplicity `p + 1` lets the surface jump there.
    ///
    /// # Errors
    /// When `t` is not inside the domain, or so near to its end as to leave no room for a part's
    /// own domain, or a part's control points are all on one line.
    pub fn split_u(&self, t: f64) -> Result<(Self, Self), SurfaceError> {
        self.split(Direction::U, t)
    }

    /// The two parts of the surface below and above `v = t`, each clamped in v; as
    /// [`NurbsSurface::split_u`].
    ///
    /// # Errors
    /// When `t` is not inside the domain, or so near to its end as to leave no room for a part's
    /// own domain, or a part's control points are all on one line.
    pub fn split_v(&self, t: f64) -> Result<(Self, Self), SurfaceError> {
        self.split(Direction::V, t)
    }

    /// The parts before and after a parameter: see [`split_u`](Self::split_u).
    pub(crate) fn split(&self, direction: Direction, t: f64) -> Result<(Self, Self), SurfaceError> {
        let [start, end] = self.knots(direction).domain();
        let inside = start < t && t < end; // false for NaN
        if !inside {
            return Err(SurfaceError::Parameter { direction, t, start, end });
        }
        // Both parts are cut from one net, so that they agree on their common edge.
        let clamped = self.restricted(direction, [start, end]);
        let knots = clamped.knots(direction);
        let missing = knots.degree().saturating_sub(knots.multiplicity(t));
        let whole = clamped.refined(direction, &vec![t; missing]);
        let below = whole.restricted(direction, [start, t]);
        let above = whole.restricted(direction, [t, end]);
        for part in [&below, &above] {
            check_domain(direction, part.knots(direction))?;
            part.check_extent()?;
        }
        Ok((below, above))
    }

    /// The same surface with its degree in u raised `times` times; clamped in u.
    ///
    /// Inner knots are repeated `times` times more, as the smoothness there demands.
    ///
    /// # Errors
    /// When the degree would exceed [`MAX_DEGREE`].
    pub fn elevated_u(&self, times: usize) -> Result<Self, SurfaceError> {
        self.elevated(Direction::U, times)
    }

    /// The same surface with its degree in v raised `times` times; as
    /// [`NurbsSurface::elevated_u`].
    ///
    /// # Errors
    /// When the degree would exceed [`MAX_DEGREE`].
    pub fn elevated_v(&self, times: usize) -> Result<Self, SurfaceError> {
        self.elevated(Direction::V, times)
    }

    fn elevated(&self, direction: Direction, times: usize) -> Result<Self, SurfaceError> {
        let knots = self.knots(direction);
        let degree = knots.degree().saturating_add(times);
        if degree > MAX_DEGREE {
            let error = KnotError::Degree { degree };
            return Err(SurfaceError::Knots { direction, error });
        }
        let mut surface = self.restricted(direction, knots.domain());
        for _ in 0..times {
            let knots = surface.knots(direction);
            let (to, _) = elevate(knots, &vec![DVec4::W; knots.point_count()]);
            surface = surface.with_lines(direction, to, |line| elevate(knots, line).1);
        }
        Ok(surface)
    }

    /// The part of the surface between two parameters of its domain, clamped there.
    pub(crate) fn restricted(&self, direction: Direction, range: [f64; 2]) -> Self {
        let knots = self.knots(direction);
        let (to, _) = restrict(knots, &vec![DVec4::W; knots.point_count()], range);
        self.with_lines(direction, to, |line| restrict(knots, line, range).1)
    }

    /// The surface made by applying `operation` to each line of control points that runs along
    /// `direction`; its knots in that direction are `knots`.
    pub(crate) fn with_lines(
        &self,
        direction: Direction,
        knots: KnotVector,
        operation: impl Fn(&[DVec4]) -> Vec<DVec4> + Sync,
    ) -> Self {
        let [nu, nv] = self.size();
        match direction {
            Direction::V => {
                let length = knots.point_count();
                let mut control = vec![DVec4::ZERO; nu * length];
                let rows = control.par_chunks_mut(length).zip(self.control().par_chunks(nv));
                rows.for_each(|(to, from)| to.copy_from_slice(&operation(from)));
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
