//! A place on a surface.

use glam::{DVec2, DVec3};

use crate::math::RayFrame;
use crate::patch::{Jet, Piece};

/// A place on a piece of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot<'a> {
    /// The piece's number, and the piece.
    pub index: u32,
    pub piece: &'a Piece,
    pub st: DVec2,
    pub jet: Jet,
}

impl<'a> Spot<'a> {
    /// The normal there, if there is one, and its cosine with the ray's direction, else 0.
    pub(crate) fn normal_along(&self, ray: &RayFrame) -> (Option<DVec3>, f64) {
        let normal = self.piece.normal(self.st, &self.jet);
        (normal, normal.map_or(0.0, |normal| normal.dot(ray.axis)))
    }
}
