//! The same surface seen otherwise: turned around, exchanged, moved.

use glam::{DAffine3, DVec4, Vec4Swizzles};

use super::{NurbsSurface, SurfaceError};

impl NurbsSurface {
    /// The surface run backwards in u, which turns its normals; the domain stays (see
    /// [`KnotVector::reversed`](super::KnotVector::reversed)).
    #[must_use]
    pub fn reversed_u(&self) -> Self {
        let (_, nv) = self.size();
        let control = self.control().chunks(nv).rev().flatten().copied().collect();
        Self::assembled([self.knots_u().reversed(), self.knots_v().clone()], control)
    }

    /// The surface run backwards in v, which turns its normals; the domain stays (see
    /// [`KnotVector::reversed`](super::KnotVector::reversed)).
    #[must_use]
    pub fn reversed_v(&self) -> Self {
        let (_, nv) = self.size();
        let control = self.control().chunks(nv).flat_map(|row| row.iter().rev()).copied().collect();
        Self::assembled([self.knots_u().clone(), self.knots_v().reversed()], control)
    }

    /// The surface with its parameters exchanged, `S(v, u)`, which turns its normals.
    #[must_use]
    pub fn swapped(&self) -> Self {
        let (nu, nv) = self.size();
        let control = (0..nv).flat_map(|j| (0..nu).map(move |i| self.homogeneous(i, j))).collect();
        Self::assembled([self.knots_v().clone(), self.knots_u().clone()], control)
    }

    /// The surface moved by an affine map. The parameters keep their places, so that a map
    /// that mirrors turns the normals as seen from the surface's inside.
    ///
    /// # Errors
    /// When the map is not finite, flattens space, or takes a control point to infinity.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, SurfaceError> {
        check_invertible(map)?;
        let moved =
            |point: &DVec4| (map.matrix3 * point.xyz() + point.w * map.translation).extend(point.w);
        let control = self.control().iter().map(moved).collect();
        Self::from_homogeneous(self.knots_u().clone(), self.knots_v().clone(), control)
    }
}

/// Refuses a map that is not finite, or flattens space.
pub(crate) fn check_invertible(map: &DAffine3) -> Result<(), SurfaceError> {
    let determinant = map.matrix3.determinant();
    let invertible = map.is_finite() && determinant.is_normal();
    if invertible { Ok(()) } else { Err(SurfaceError::Transform { determinant }) }
}

/// By how much a map lengthens distances at most: the root of the sum of its squares is a
/// bound of the largest singular value, and no more than √3 times it.
pub(crate) fn stretch(map: &DAffine3) -> f64 {
    map.matrix3.to_cols_array().iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
