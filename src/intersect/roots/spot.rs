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

    /// Whether the ray goes one way through all of the surface around the place: that with this
    /// sign of `N · d`. The surface is known there to within `error`.
    ///
    /// At a corner where both tangents have one line, as where a crease of a limit surface runs on
    /// smoothly past the only face on one side of it, normals have a limit on each way to the
    /// corner, but not the same on all ways.
    pub(crate) fn has_one_side(&self, ray: &RayFrame, cosine: f64, error: f64) -> bool {
        let Jet { ds, dt, .. } = self.jet;
        let corner = self.st.round();
        let inward = DVec2::ONE - 2.0 * corner;
        // False for a collapsed side.
        let lengths = [ds.length(), dt.length()];
        let one_line = ONE_LINE.max(ONE_LINE_MOVES * (error / lengths[0].max(lengths[1])).sqrt());
        let is_flat = ds.cross(dt).length() < one_line * lengths[0] * lengths[1];
        let is_corner = (self.st - corner).abs().max_element() <= BESIDE_CORNER;
        if !(is_flat && is_corner) {
            return true;
        }
        [DVec2::X, DVec2::Y, DVec2::ONE].into_iter().all(|way| {
            let st = corner + BESIDE_CORNER * way * inward;
            let normal = self.piece.normal(st, &self.piece.patch.jet(st));
            normal.is_some_and(|normal| normal.dot(ray.axis) * cosine > 0.0)
        })
    }
}

/// Tangents have one line if the sine of their angle is less than this, or than [`ONE_LINE_MOVES`]
/// times the part of the piece by which rounding moves a place at such a corner: the square root of
/// the error of points over the length of the piece.
const ONE_LINE: f64 = 1e-5;
const ONE_LINE_MOVES: f64 = 16.0;

/// How far from such a corner, in each parameter of the piece, normals are compared: farther than
/// rounding moves a place there, unless the piece is very far from the origin.
pub(super) const BESIDE_CORNER: f64 = 1.0 / 64.0;
