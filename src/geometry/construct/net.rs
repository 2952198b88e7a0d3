//! Control polygons and control nets.

use glam::{DAffine3, DVec3};

use crate::geometry::{NurbsCurve, NurbsSurface, TrianglePatch};

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
        let [nu, nv] = surface.size();
        let mut net = Self::default();
        for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
            let here = net.points.len();
            net.points.push(surface.vertex(i, j));
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
            points: (0..count).map(|i| curve.vertex(i)).collect(),
            lines: (1..count).map(|i| [i - 1, i]).collect(),
        }
    }
}
