//! Tensor-product NURBS surfaces.

use glam::DVec4;

use super::KnotVector;

/// A tensor-product NURBS surface.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    knots: [KnotVector; 2],
    control: Vec<DVec4>,
}

impl NurbsSurface {
    /// The knot vector in u.
    pub fn knots_u(&self) -> &KnotVector {
        &self.knots[0]
    }

    /// The homogeneous control net `(w x, w y, w z, w)`, v fastest.
    pub fn control(&self) -> &[DVec4] {
        &self.control
    }
}
