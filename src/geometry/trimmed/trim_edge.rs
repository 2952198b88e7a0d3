//! A trim edge: in (u, v) a trim curve, in space its image.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4, Vec3Swizzles, Vec4Swizzles};

use crate::geometry::NurbsSurface;
use crate::math::bernstein::{Basis, basis, derivative_from_lower};

/// A part of a trim edge: the curve `S(c(t))` in space, for a part of a trim loop `c` in (u, v).
///
/// Piece k of it, within one Bézier piece of the surface, has the parameters from k to k + 1.
#[derive(Clone, Debug)]
pub struct TrimEdge {
    /// The surface as Bézier pieces, shared by all of its edges.
    form: Arc<NurbsSurface>,
    /// At least one.
    pieces: Vec<Piece>,
}

/// A piece of a trim curve within a Bézier piece of a surface.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Its homogeneous control points `(w u, w v, w)`.
    pub(super) control: Vec<DVec3>,
    /// The same in the unit coordinates `[0, 1]²` of the Bézier piece.
    pub(super) local: Vec<DVec3>,
    /// The indices, in u and v, of the Bézier piece's first control point.
    pub(super) first: [usize; 2],
}

impl TrimEdge {
    /// An edge of at least one piece.
    pub(super) fn new(form: Arc<NurbsSurface>, pieces: Vec<Piece>) -> Self {
        Self { form, pieces }
    }

    /// The range of the parameter: from 0 to the number of pieces.
    pub fn domain(&self) -> [f64; 2] {
        [0.0, self.pieces.len() as f64]
    }

    /// The ranges of the parameter that belong to one piece each, in order.
    pub fn spans(&self) -> impl Iterator<Item = [f64; 2]> {
        (0..self.pieces.len()).map(|k| [k as f64, (k + 1) as f64])
    }

    /// The point `S(c(t))` for a `t` in the domain.
    pub fn point_at(&self, t: f64) -> DVec3 {
        let [point, _] = self.tangent_at(t);
        point
    }

    /// The point `S(c(t))` for a `t` in the domain, and the derivative there: where two pieces
    /// meet, that of the one which begins.
    pub fn tangent_at(&self, t: f64) -> [DVec3; 2] {
        let (piece, share) = self.piece_at(t);
        piece.at(&self.form, share)
    }

    /// The point `c(t)` in (u, v) for a `t` in the domain, and a vector along the tangent there, in
    /// the loop's direction: zero where neighbouring control points are equal.
    pub fn uv_at(&self, t: f64) -> [DVec2; 2] {
        let (piece, share) = self.piece_at(t);
        let [from, to] = last_leg(&piece.control, share);
        [euclidean(from.lerp(to, share)), euclidean(to) - euclidean(from)]
    }

    pub(super) fn form(&self) -> &NurbsSurface {
        &self.form
    }

    pub(super) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The piece that `t` belongs to, and how far along that is, from 0 to 1.
    fn piece_at(&self, t: f64) -> (&Piece, f64) {
        let last = self.pieces.len() - 1;
        let k = (t.floor().max(0.0) as usize).min(last);
        (&self.pieces[k], t - k as f64)
    }
}

impl Piece {
    /// Its degree in space.
    pub(super) fn degree(&self, form: &NurbsSurface) -> usize {
        let [p, q] = form.degree();
        (p + q) * (self.local.len() - 1)
    }

    /// The point in space at a parameter from 0 to 1, and the derivative there.
    pub(super) fn at(&self, form: &NurbsSurface, share: f64) -> [DVec3; 2] {
        let [from, to] = last_leg(&self.local, share);
        let (c, speed) = (from.lerp(to, share), (self.local.len() - 1) as f64 * (to - from));
        let place = euclidean(c);
        let along = (speed.xy() - speed.z * place) / c.z;

        let [p, q] = form.degree();
        let [nu, nv]: [Basis; 2] = [basis(p, place.x), basis(q, place.y)];
        let du: Basis = derivative_from_lower(p, &basis(p - 1, place.x));
        let dv: Basis = derivative_from_lower(q, &basis(q - 1, place.y));
        let [i, j] = self.first;
        let [mut sum, mut change] = [DVec4::ZERO; 2];
        for a in 0..=p {
            let [mut row, mut across] = [DVec4::ZERO; 2];
            for b in 0..=q {
                let point = form.homogeneous(i + a, j + b);
                row += nv[b] * point;
                across += dv[b] * point;
            }
            sum += nu[a] * row;
            change += along.x * du[a] * row + along.y * nu[a] * across;
        }
        let point = sum.xyz() / sum.w;
        [point, (change.xyz() - change.w * point) / sum.w]
    }
}

/// The two control points left of a Bézier curve after all but the last step of de Casteljau's
/// algorithm: the point lies between them, and they on the tangent.
fn last_leg(control: &[DVec3], share: f64) -> [DVec3; 2] {
    let mut control = control.to_vec();
    for count in (2..control.len()).rev() {
        for k in 0..count {
            control[k] = control[k].lerp(control[k + 1], share);
        }
    }
    [control[0], control[1]]
}

fn euclidean(control: DVec3) -> DVec2 {
    control.xy() / control.z
}

#[cfg(test)]
mod tests {
    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
    use crate::geometry::{TrimmedSurface, shapes};

    use super::*;

    #[test]
    fn an_edge_is_the_image_of_its_curve() {
        let sphere = shapes::sphere(2.0).unwrap();
        let [[u0, u1], [v0, v1]] = sphere.domain();
        let center = DVec2::new(0.5 * (u0 + u1), 0.3 * v0 + 0.7 * v1);
        let circle = TrimLoop::circle(center, 0.25).unwrap();
        let domain = TrimDomain::with_seams_of(&sphere).unwrap();
        let trims = Trims::new(domain, Kept::Even, &[circle]).unwrap();
        let edges = TrimmedSurface::new(sphere.clone(), trims).unwrap().edges();
        assert_eq!(edges.len(), 1);
        let [start, end] = edges[0].domain();
        let curve = edges[0].curve().unwrap();
        for k in 0..=500 {
            let t = start + f64::from(k) / 500.0 * (end - start);
            let [uv, along] = edges[0].uv_at(t);
            let [point, tangent] = edges[0].tangent_at(t);
            assert!(sphere.point_at(uv).distance(point) < 4e-15, "{t}: {point}");
            let in_space = curve.derivatives(t);
            assert!(in_space.point.distance(point) < 1e-13, "{t}: {point}");
            assert!(in_space.first.distance(tangent) < 1e-12, "{t}: {tangent}");
            assert!((uv.distance(center) - 0.25).abs() < 1e-15, "{t}: {uv}");
            // Counterclockwise around the circle's center.
            let turn = (uv - center).perp_dot(along) / (0.25 * along.length());
            assert!((turn - 1.0).abs() < 1e-14, "{t}: {turn}");
        }
    }
}
