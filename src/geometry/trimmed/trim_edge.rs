//! A trim edge in space together with the trim curve that it is the image of.

use glam::{DVec2, DVec3, Vec3Swizzles};

use crate::geometry::NurbsCurve;

/// A part of a trim edge: a curve in space, and in (u, v) the curve `c` of which it is the image,
/// `S(c(t))`, with the same parameter.
#[derive(Clone, Debug)]
pub struct TrimEdge {
    curve: NurbsCurve,
    /// The homogeneous control points `(w u, w v, w)` of each piece of `c`; piece k has the
    /// parameters from k to k + 1.
    pieces: Vec<Vec<DVec3>>,
}

impl TrimEdge {
    /// A curve from 0 to the number of pieces, each piece for one of `c`.
    pub(super) fn new(curve: NurbsCurve, pieces: Vec<Vec<DVec3>>) -> Self {
        Self { curve, pieces }
    }

    /// The curve in space.
    pub fn curve(&self) -> &NurbsCurve {
        &self.curve
    }

    /// The curve in space alone.
    pub fn into_curve(self) -> NurbsCurve {
        self.curve
    }

    /// The point `c(t)` in (u, v) for a `t` in the curve's domain, and a vector along the tangent
    /// there, in the loop's direction: zero where neighbouring control points are equal.
    pub fn uv_at(&self, t: f64) -> [DVec2; 2] {
        let last = self.pieces.len() - 1;
        let piece = (t.floor().max(0.0) as usize).min(last);
        let share = t - piece as f64;
        let mut control = self.pieces[piece].clone();
        for count in (2..control.len()).rev() {
            for k in 0..count {
                control[k] = control[k].lerp(control[k + 1], share);
            }
        }
        let [from, to] = [control[0], control[1]];
        [euclidean(from.lerp(to, share)), euclidean(to) - euclidean(from)]
    }
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
        let edges = TrimmedSurface::new(sphere.clone(), trims).unwrap().edges().unwrap();
        assert_eq!(edges.len(), 1);
        let [start, end] = edges[0].curve().domain();
        for k in 0..=500 {
            let t = start + f64::from(k) / 500.0 * (end - start);
            let [uv, along] = edges[0].uv_at(t);
            let point = edges[0].curve().point_at(t);
            assert!(sphere.point_at(uv).distance(point) < 1e-13, "{t}: {point}");
            assert!((uv.distance(center) - 0.25).abs() < 1e-15, "{t}: {uv}");
            // Counterclockwise around the circle's center.
            let turn = (uv - center).perp_dot(along) / (0.25 * along.length());
            assert!((turn - 1.0).abs() < 1e-14, "{t}: {turn}");
        }
    }
}
