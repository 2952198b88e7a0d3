//! A Bézier piece in its place on a surface.

use glam::{DVec2, DVec3};

use super::TensorPatch;
use super::tangents::CollapsedSide;
use super::tensor::euclidean;

/// A Bézier piece with its place in the surface it was cut from.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The piece on its unit square.
    pub patch: TensorPatch,
    /// Which surface, counted in the order given.
    pub surface: u32,
    /// The knot rectangle it covers: from and to in `u`, then in `v`.
    pub domain: [[f64; 2]; 2],
    /// Which sides are borders of the surface: `s = 0`, `s = 1`, `t = 0`, `t = 1`.
    pub border: [bool; 4],
    /// The point each side is collapsed to, in the same order.
    pub collapsed: [Option<DVec3>; 4],
}

impl Piece {
    /// The surface parameters of a point of the unit square; exact at its corners.
    pub fn uv(&self, st: DVec2) -> DVec2 {
        let at = |[from, to]: [f64; 2], x: f64| {
            if x == 1.0 { to } else { from + x * (to - from) }
        };
        DVec2::new(at(self.domain[0], st.x), at(self.domain[1], st.y))
    }

    /// The sides that are collapsed to a point.
    pub fn collapsed_sides(&self) -> impl Iterator<Item = (CollapsedSide, DVec3)> {
        let sides =
            [CollapsedSide::S(0), CollapsedSide::S(1), CollapsedSide::T(0), CollapsedSide::T(1)];
        sides.into_iter().zip(self.collapsed).filter_map(|(side, at)| Some((side, at?)))
    }
}

/// The point each side of a piece is collapsed to: all its control points agree to a few
/// roundings of their size.
pub(super) fn collapsed(patch: &TensorPatch) -> [Option<DVec3>; 4] {
    let [p, q] = patch.degree();
    let control = patch.control();
    let tolerance = 4.0 * patch.residual_factor() * patch.magnitude();
    let point_of = |indices: &mut dyn Iterator<Item = usize>| {
        let mut points = indices.map(|k| euclidean(control[k]));
        let first = points.next()?;
        points.all(|point| (point - first).abs().max_element() <= tolerance).then_some(first)
    };
    let mut sides = [
        point_of(&mut (0..=q)),
        point_of(&mut (0..=q).map(|j| p * (q + 1) + j)),
        point_of(&mut (0..=p).map(|i| i * (q + 1))),
        point_of(&mut (0..=p).map(|i| i * (q + 1) + q)),
    ];
    // A piece that is a point all over has no sides to speak of.
    if sides.iter().all(Option::is_some) {
        sides = [None; 4];
    }
    sides
}
