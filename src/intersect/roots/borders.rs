//! Borders of surfaces: which roots lie inside them, and which lie on them, to within rounding.

use glam::DVec2;

use crate::geometry::RectSide;
use crate::math::RayFrame;
use crate::patch::{BORDER_REACH, Jet, Piece};

/// Returns the place itself if it is on the piece, else the point of the piece's border that is
/// nearest to the ray there.
///
/// The slack of a border is a distance in space: where the ray grazes, a root that rounding
/// has moved far outside in one parameter is near the border for another value of the
/// other parameter. Where the ray runs inside the surface, the end of the stretch may be
/// well outside, and the ray may cross the border far from there.
pub(crate) fn on_piece(piece: &Piece, ray: &RayFrame, st: DVec2) -> DVec2 {
    let nearest = st.clamp(DVec2::ZERO, DVec2::ONE);
    let residual = |st: DVec2| ray.distance(piece.patch.point(st));
    match [nearest.x != st.x, nearest.y != st.y] {
        [false, false] => nearest,
        [true, false] => along_border(piece, ray, nearest, DVec2::Y),
        [false, true] => along_border(piece, ray, nearest, DVec2::X),
        [true, true] => {
            // Beyond a corner the ray may cross either of its sides.
            let [a, b] = [DVec2::X, DVec2::Y].map(|free| along_border(piece, ray, nearest, free));
            if residual(b) < residual(a) { b } else { a }
        }
    }
}

/// The point of a border nearest to the ray, by least squares along the free direction, from a
/// place on the border. The search stops where the point is so near that rounding would affect the
/// next step. (Where the ray runs along the border to within rounding, every point is that near.)
fn along_border(piece: &Piece, ray: &RayFrame, start: DVec2, free: DVec2) -> DVec2 {
    // Gauss–Newton steps double the correct digits, but only near the end of a long way.
    let most_steps = 8;
    let near = AT_RAY * piece.patch.error_bound(ray.magnitude);
    let mut nearest = start;
    for _ in 0..most_steps {
        let jet = piece.patch.jet(nearest);
        let at = ray.coordinates(jet.point).truncate();
        if at.length() <= near {
            break;
        }
        let along = ray.across(free.x * jet.ds + free.y * jet.dt);
        let step = along.dot(at) / along.length_squared();
        if !step.is_finite() {
            break;
        }
        let next = (nearest - step * free).clamp(DVec2::ZERO, DVec2::ONE);
        if next == nearest {
            break;
        }
        nearest = next;
    }
    nearest
}

/// Points count as on the ray if they are within this part of the error bound of it.
const AT_RAY: f64 = 0.25;

/// Whether a point lies within rounding of a side that is a border of the surface.
pub(crate) fn at_border(piece: &Piece, st: DVec2, jet: &Jet, error: f64) -> bool {
    let distances = piece.side_distances(st, jet);
    let mut sides = RectSide::ALL.into_iter();
    sides.any(|side| piece.is_border(side) && distances[side] <= BORDER_REACH * error)
}
