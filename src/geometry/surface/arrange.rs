//! The same surface with a direction reversed, its parameters exchanged, or moved by a map.

use glam::DAffine3;

use super::{NurbsSurface, SurfaceError};
use crate::geometry::Direction;
use crate::geometry::affine::{moved, unfit_determinant};

impl NurbsSurface {
    /// The surface run backwards in u, which reverses its normals; the domain stays (see
    /// [`KnotVector::reversed`](crate::geometry::KnotVector::reversed)).
    #[must_use]
    pub fn reversed_u(&self) -> Self {
        let [_, nv] = self.size();
        let control = self.control().chunks(nv).rev().flatten().copied().collect();
        Self::assembled([self.knots_u().reversed(), self.knots_v().clone()], control)
    }

    /// The surface run backwards in v, which reverses its normals; the domain stays (see
    /// [`KnotVector::reversed`](crate::geometry::KnotVector::reversed)).
    #[must_use]
    pub fn reversed_v(&self) -> Self {
        let [_, nv] = self.size();
        let control = self.control().chunks(nv).flat_map(|row| row.iter().rev()).copied().collect();
        Self::assembled([self.knots_u().clone(), self.knots_v().reversed()], control)
    }

    /// The surface with its parameters exchanged, `S(v, u)`, which reverses its normals.
    #[must_use]
    pub fn swapped(&self) -> Self {
        let [nu, nv] = self.size();
        let control = (0..nv).flat_map(|j| (0..nu).map(move |i| self.homogeneous(i, j))).collect();
        Self::assembled([self.knots_v().clone(), self.knots_u().clone()], control)
    }

    /// The same surface with its parameters mapped linearly to another domain, `[start, end]` in u,
    /// then in v, as [`domain`](Self::domain) gives it.
    ///
    /// # Errors
    /// When a domain is empty or not finite, too short or too long for a surface, or too short for
    /// the knots to stay apart.
    pub fn on_domain(&self, domain: [[f64; 2]; 2]) -> Result<Self, SurfaceError> {
        let knots = |direction, [start, end]: [f64; 2]| {
            let moved = self.knots(direction).on_domain(start, end);
            moved.map_err(|error| SurfaceError::Knots { direction, error })
        };
        let (u, v) = (knots(Direction::U, domain[0])?, knots(Direction::V, domain[1])?);
        Self::from_homogeneous(u, v, self.control().to_vec())
    }

    /// The surface moved by an affine map. The parameters stay as they are, so that if the map
    /// mirrors, normals that pointed out of a body point into it.
    ///
    /// # Errors
    /// When the map is not finite, flattens space, or takes a control point to infinity.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, SurfaceError> {
        check_invertible(map)?;
        let control = self.control().iter().map(|point| moved(map, point)).collect();
        Self::from_homogeneous(self.knots_u().clone(), self.knots_v().clone(), control)
    }
}

/// Refuses a map that is not finite, or flattens space.
pub(crate) fn check_invertible(map: &DAffine3) -> Result<(), SurfaceError> {
    if !map.is_finite() {
        return Err(SurfaceError::TransformNotFinite);
    }
    unfit_determinant(map)
        .map_or(Ok(()), |determinant| Err(SurfaceError::Transform { determinant }))
}
