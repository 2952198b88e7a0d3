//! The vertices of a smooth piece of a surface, before trims choose among them.

use glam::{DVec2, DVec3};

use crate::geometry::trim::UvBox;

/// What a vertex may carry besides its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    /// The unit normal of the surface; NaN where it has none.
    pub(super) normal: DVec3,
    /// The parameters on the whole surface.
    pub(super) uv: DVec2,
}

/// The vertices of a piece: rows of constant u, each running along v.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    pub(super) us: Vec<f64>,
    pub(super) vs: Vec<f64>,
    pub(super) positions: Vec<DVec3>,
    /// Normals and parameters, or nothing.
    pub(super) details: Vec<Detail>,
}

impl Lattice {
    /// The cell from row `i` to the next and from column `j` to the next.
    pub(super) fn cell(&self, i: usize, j: usize) -> UvBox {
        UvBox::new([self.us[i], self.us[i + 1]], [self.vs[j], self.vs[j + 1]])
    }

    pub(super) fn position(&self, i: usize, j: usize) -> DVec3 {
        self.positions[i * self.vs.len() + j]
    }
}
