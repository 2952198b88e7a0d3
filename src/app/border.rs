//! The borders of a surface's domain as curves in space.

use std::fmt;

use glam::{DVec2, DVec3};
use nurbray::geometry::{
    Chart, ChartMap, Direction, KnotVector, NurbsCurve, NurbsSurface, RectSide,
};
use nurbray::math::rounding::residual_factor;

/// The number of intervals between the points of a border that are compared to find a pole.
const POLE_SAMPLES: usize = 16;

/// One border of a surface's domain: one parameter is fixed, the other runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Border {
    /// Which parameter is fixed.
    fixed: Direction,
    /// What it is fixed at: an end of the domain, or a knot where the surface jumps.
    at: f64,
    /// Whether the border lies just before such a knot, where the surface ends, and not at the
    /// knot, where it begins.
    before: bool,
    /// Its ends in the whole surface's (u, v), if it is a side of a chart with parameters of its
    /// own.
    ends: Option<[DVec2; 2]>,
}

impl Border {
    /// The borders at the sides of the domain.
    pub(crate) fn all(surface: &NurbsSurface) -> [Self; 4] {
        let domain = surface.domain();
        RectSide::ALL.map(|side| {
            let (fixed, at) = (side.fixed(), side.value_in(&domain));
            Self { fixed, at, before: false, ends: None }
        })
    }

    /// The sides of a chart that are borders of its surface.
    pub(crate) fn of(chart: &Chart<'_>) -> impl Iterator<Item = Self> + use<> {
        let named = |side: Self| {
            let [from, to] = side.knots(&chart.surface).domain();
            let end = |t: f64| chart.map.uv(side.uv(t));
            let has_own = chart.map != ChartMap::Identity;
            Self { ends: has_own.then(|| [end(from), end(to)]), ..side }
        };
        let sides = Self::all(&chart.surface).map(named).into_iter().zip(chart.border);
        sides.filter_map(|(side, is_border)| is_border.then_some(side))
    }

    /// The borders of a chart at knots of full multiplicity within its domain, two at each, as the
    /// surface may jump there.
    pub(crate) fn inner(chart: &Chart<'_>) -> Vec<Self> {
        let mut inner = Vec::new();
        for fixed in Direction::BOTH {
            let knots = chart.surface.knots(fixed);
            let starts = knots.spans().skip(1).map(|span| span.start);
            for at in starts.filter(|&at| knots.multiplicity(at) > knots.degree()) {
                inner.extend([true, false].map(|before| Self { fixed, at, before, ends: None }));
            }
        }
        inner
    }

    /// Whether trims keep some of the border.
    pub(crate) fn is_kept(&self, chart: &Chart<'_>) -> bool {
        !self.kept(chart).is_empty()
    }

    /// The ranges of the running parameter where trims keep the border.
    pub(crate) fn kept(&self, chart: &Chart<'_>) -> Vec<[f64; 2]> {
        let [start, end] = self.knots(&chart.surface).domain();
        let Some(trims) = &chart.trims else { return vec![[start, end]] };
        trims.kept_along(self.fixed, self.value())
    }

    /// The fixed parameter.
    fn value(&self) -> f64 {
        if self.before { self.at.next_down() } else { self.at }
    }

    /// The surface parameters where the running one is `t`.
    pub(crate) fn uv(&self, t: f64) -> DVec2 {
        self.fixed.pair(self.value(), t).into()
    }

    /// The vector in (u, v) along the border that has the surface on its left: up along the last
    /// u, and so around the domain.
    pub(crate) fn around(&self, surface: &NurbsSurface) -> DVec2 {
        let is_last = self.before || self.at == surface.knots(self.fixed).domain()[1];
        match (self.fixed, is_last) {
            (Direction::U, true) => DVec2::Y,
            (Direction::U, false) => DVec2::NEG_Y,
            (Direction::V, true) => DVec2::NEG_X,
            (Direction::V, false) => DVec2::X,
        }
    }

    /// The knots of the parameter that runs.
    pub(crate) fn knots<'a>(&self, surface: &'a NurbsSurface) -> &'a KnotVector {
        surface.knots(self.fixed.other())
    }

    /// The point where the running parameter is `t`.
    pub(crate) fn point(&self, surface: &NurbsSurface, t: f64) -> DVec3 {
        surface.point_at(self.uv(t))
    }

    /// The point at `t`, and its derivative.
    pub(crate) fn tangent(&self, surface: &NurbsSurface, t: f64) -> (DVec3, DVec3) {
        let at = surface.derivatives(self.uv(t));
        (at.point, [at.du, at.dv][self.fixed.other()])
    }

    /// The border as a curve of its own, where it runs along a row of control points: at a clamped
    /// end of the domain.
    pub(crate) fn curve(&self, surface: &NurbsSurface) -> Option<NurbsCurve> {
        let across = surface.knots(self.fixed);
        let [start, end] = across.domain();
        if self.before || !across.is_clamped() || (self.at != start && self.at != end) {
            return None;
        }
        let along = self.knots(surface);
        let row = if self.at == start { 0 } else { across.point_count() - 1 };
        let points = (0..along.point_count()).map(|k| {
            let [i, j] = self.fixed.pair(row, k);
            surface.control()[i * surface.knots_v().point_count() + j]
        });
        NurbsCurve::from_homogeneous(along.clone(), points.collect()).ok()
    }

    /// The point that the border is collapsed to, if all its points agree to within rounding. (The
    /// tracer tells collapsed sides by the control points of each piece, which may be twice as far
    /// apart: a border that is nearly a point may be one for rays, and not here.)
    pub(crate) fn pole(&self, surface: &NurbsSurface) -> Option<DVec3> {
        let [start, end] = self.knots(surface).domain();
        let at =
            |k: usize| self.point(surface, start + (end - start) * k as f64 / POLE_SAMPLES as f64);
        let first = at(0);
        let close = 2.0 * rounding(surface);
        (1..=POLE_SAMPLES).all(|k| at(k).distance(first) <= close).then_some(first)
    }
}

impl fmt::Display for Border {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.ends {
            None => {
                let before = if self.before { "just before " } else { "" };
                write!(f, "{before}{} = {}", self.fixed, self.at)
            }
            Some([a, b]) if a.x == b.x => {
                write!(f, "u = {}, v {}..{}", a.x, a.y.min(b.y), a.y.max(b.y))
            }
            Some([a, b]) => {
                let (from, to) = (a.x.min(b.x), a.x.max(b.x));
                match a.y == b.y {
                    true => write!(f, "v = {}, u {from}..{to}", a.y),
                    false => write!(f, "u + v = {}, u {from}..{to}", a.x + a.y),
                }
            }
        }
    }
}

/// The largest coordinate of a surface's control points, in absolute value.
pub(crate) fn magnitude(surface: &NurbsSurface) -> f64 {
    let largest = |point: DVec3| point.abs().max_element();
    surface.control().iter().map(|c| largest(c.project())).fold(0.0, f64::max)
}

/// The error bound of a computed point of a surface.
pub(crate) fn rounding(surface: &NurbsSurface) -> f64 {
    let [p, q] = [surface.knots_u(), surface.knots_v()].map(KnotVector::degree);
    residual_factor(p, q) * magnitude(surface)
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::{Charts, TrianglePatch, shapes};

    use super::*;

    #[test]
    fn a_sphere_has_two_poles_and_two_seams_at_every_size() {
        for radius in [1e-8, 1.0, 1e8] {
            let sphere = shapes::sphere(radius).unwrap();
            let borders = Border::all(&sphere);
            let poles: Vec<DVec3> = borders.iter().filter_map(|b| b.pole(&sphere)).collect();
            assert_eq!(poles.len(), 2);
            assert!(poles.iter().all(|pole| (pole.length() / radius - 1.0).abs() < 1e-15));
            let seams: Vec<&Border> =
                borders.iter().filter(|b| b.pole(&sphere).is_none()).collect();
            let [start, end] = seams[0].knots(&sphere).domain();
            let t = 0.3 * start + 0.7 * end;
            let [a, b] = [seams[0], seams[1]].map(|seam| seam.point(&sphere, t));
            assert!(a.distance(b) <= rounding(&sphere));
        }
    }

    #[test]
    fn tangents_are_derivatives_of_points() {
        let torus = shapes::torus(3.0, 1.0).unwrap();
        for border in Border::all(&torus) {
            let [start, end] = border.knots(&torus).domain();
            let (t, h) = (0.37 * start + 0.63 * end, 1e-6 * (end - start));
            let ahead = border.point(&torus, t + h) - border.point(&torus, t - h);
            let (point, tangent) = border.tangent(&torus, t);
            assert!((ahead / (2.0 * h) - tangent).length() < 1e-7 * tangent.length());
            // The same of the row of control points along the border.
            let row = border.curve(&torus).unwrap().derivatives(t);
            assert!(row.point.distance(point) <= rounding(&torus), "{border}");
            assert!(row.first.distance(tangent) < 1e-14 * tangent.length(), "{border}");
        }
    }

    #[test]
    fn sides_of_triangles_are_named_by_the_whole_surface() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let triangle = TrianglePatch::new(1, corners, None).unwrap();
        let charts = triangle.charts();
        let mut names: Vec<String> =
            charts.iter().flat_map(Border::of).map(|border| border.to_string()).collect();
        names.sort();
        let sides = ["u + v = 1, u", "u = 0, v", "v = 0, u"];
        let halves =
            sides.iter().flat_map(|side| ["0..0.5", "0.5..1"].map(|half| format!("{side} {half}")));
        assert_eq!(names, halves.collect::<Vec<_>>());
        for chart in &charts {
            for border in Border::of(chart) {
                let [from, to] = border.knots(&chart.surface).domain();
                let ends = [from, to].map(|t| border.point(&chart.surface, t));
                // The patch is the plane of its parameters, turned.
                let [a, b] = border.ends.unwrap().map(|uv| triangle.point_at(uv));
                assert!(ends[0].distance(a) < 1e-15 && ends[1].distance(b) < 1e-15, "{border}");
            }
        }
    }
}
