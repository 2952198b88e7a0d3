//! Control polygons and control nets as visible surfaces.

use glam::{DAffine3, DVec3};

use super::tube::{Caps, TubeStyle};
use super::{Component, ConstructError, Drawing};
use crate::geometry::{NurbsCurve, NurbsSurface, TrianglePatch};

/// How thick a net is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetStyle {
    /// The radius of the lines between control points.
    pub radius: f64,
    /// The radius of the balls at the control points; larger than that of the lines, or the
    /// two touch along a circle.
    pub joints: f64,
}

impl NetStyle {
    /// The most control points of a net that is drawn: each becomes a ball of 45 control points and
    /// two lines of 18, hundreds of leaves in all; more points than this cannot be told apart.
    pub const MAX_POINTS: usize = 1 << 16;

    /// The style of the lines as tubes.
    pub fn lines(&self) -> TubeStyle {
        TubeStyle { radius: self.radius, caps: Caps::Open, tolerance: None }
    }
}

/// Control points, and lines between neighbours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ControlNet {
    /// The points in space.
    pub points: Vec<DVec3>,
    /// The ends of each line, as indices of points.
    pub lines: Vec<[usize; 2]>,
}

impl ControlNet {
    /// The net moved by an affine map.
    #[must_use]
    pub fn transformed(&self, map: &DAffine3) -> Self {
        let points = self.points.iter().map(|&point| map.transform_point3(point)).collect();
        Self { points, lines: self.lines.clone() }
    }
}

impl From<&NurbsSurface> for ControlNet {
    /// Lines between neighbours along u and v.
    fn from(surface: &NurbsSurface) -> Self {
        let (nu, nv) = surface.size();
        let mut net = Self::default();
        for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
            let here = net.points.len();
            net.points.push(surface.point(i, j));
            net.lines.extend((i + 1 < nu).then_some([here, here + nv]));
            net.lines.extend((j + 1 < nv).then_some([here, here + 1]));
        }
        net
    }
}

impl From<&TrianglePatch> for ControlNet {
    /// Lines between points whose exponents differ by one in two places.
    fn from(patch: &TrianglePatch) -> Self {
        let n = patch.degree();
        let mut net = Self::default();
        for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
            let here = net.points.len();
            net.points.extend(patch.point(i, j));
            if i + j < n {
                let above = here + n + 1 - i; // (i + 1, j)
                net.lines.extend([[here, here + 1], [here, above], [here + 1, above]]);
            }
        }
        net
    }
}

impl From<&NurbsCurve> for ControlNet {
    /// The control polygon.
    fn from(curve: &NurbsCurve) -> Self {
        let count = curve.control().len();
        Self {
            points: (0..count).map(|i| curve.point(i)).collect(),
            lines: (1..count).map(|i| [i - 1, i]).collect(),
        }
    }
}

/// A control net as surfaces: a cylinder for each line, a ball for each point. Points that
/// coincide, as at poles and seams, are drawn once, and so are lines, also where they overlap.
///
/// # Errors
/// When a radius is not a positive length, there are too many points, one is not finite, or a line
/// ends at none of them.
pub fn control_net(net: &ControlNet, style: &NetStyle) -> Result<Vec<Component>, ConstructError> {
    let mut drawing = Drawing::among(net.points.iter().copied(), style.lines());
    drawing.net(net, style.joints)?;
    drawing.pieces()
}

#[cfg(test)]
mod tests {
    use super::super::ComponentKind;
    use super::*;
    use crate::geometry::{KnotVector, shapes};

    fn counts(pieces: &[Component]) -> [usize; 2] {
        let kinds = [ComponentKind::Line, ComponentKind::Point];
        kinds.map(|kind| pieces.iter().filter(|p| p.kind == kind).count())
    }

    #[test]
    fn poles_and_seams_are_drawn_once() {
        for size in [1e-8, 1.0, 1e8] {
            let style = NetStyle { radius: 0.02 * size, joints: 0.05 * size };
            let hemisphere = shapes::hemisphere(size).unwrap();
            // Two poles, 8 points; rows of 3 lines twice, columns of 3 lines four times.
            assert_eq!(
                counts(&control_net(&ControlNet::from(&hemisphere), &style).unwrap()),
                [6 + 12, 10]
            );
            // The sphere's net closes: 6 columns, of which one begins and ends the rows.
            let sphere = shapes::sphere(size).unwrap();
            assert_eq!(
                counts(&control_net(&ControlNet::from(&sphere), &style).unwrap()),
                [12 + 18, 14]
            );
        }
        let polygon = ControlNet::from(&shapes::circle_cubic());
        let polygon = control_net(&polygon, &NetStyle { radius: 0.1, joints: 0.2 });
        assert_eq!(counts(&polygon.unwrap()), [6, 6]);
        // A quartic triangle: 15 points, and the sides of 10 small triangles.
        let octant = ControlNet::from(&shapes::octant_quartic(1.0).unwrap());
        let octant = control_net(&octant, &NetStyle { radius: 0.01, joints: 0.02 });
        assert_eq!(counts(&octant.unwrap()), [30, 15]);
    }

    #[test]
    fn radii_must_be_lengths() {
        let plane = ControlNet::from(&shapes::plane(1.0, 1.0).unwrap());
        let message = |radius, joints| {
            control_net(&plane, &NetStyle { radius, joints }).unwrap_err().to_string()
        };
        assert_eq!(message(-1.0, 1.0), "tube: radius -1: it must be positive and finite");
        let knots = KnotVector::uniform(1, 300).unwrap();
        let points = (0..90_000).map(|k| DVec3::new(f64::from(k % 300), f64::from(k / 300), 0.0));
        let large = NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap();
        assert_eq!(
            control_net(&ControlNet::from(&large), &NetStyle { radius: 0.1, joints: 0.2 })
                .unwrap_err()
                .to_string(),
            "90000 control points: nets of up to 65536 can be drawn"
        );
        let nowhere = ControlNet { points: vec![DVec3::ZERO, DVec3::NAN], lines: Vec::new() };
        assert_eq!(
            control_net(&nowhere, &NetStyle { radius: 0.1, joints: 0.2 }).unwrap_err().to_string(),
            "control point 1 of the net is (NaN, NaN, NaN): coordinates must be finite (up to 1e70)"
        );
        assert_eq!(message(1.0, 0.0), "joint radius 0: it must be positive and finite");
    }

    #[test]
    fn lines_must_end_at_vertices() {
        let style = NetStyle { radius: 0.1, joints: 0.2 };
        let message = |lines: &[[usize; 2]]| {
            let net = ControlNet { points: vec![DVec3::ZERO, DVec3::X], lines: lines.to_vec() };
            control_net(&net, &style).unwrap_err().to_string()
        };
        let counted = "but the net has 2 control points; lines and vertices count from 0";
        assert_eq!(message(&[[0, 1], [0, 7]]), format!("line 1 ends at vertex 7, {counted}"));
        assert_eq!(message(&[[2, 0]]), format!("line 0 ends at vertex 2, {counted}"));
    }
}
