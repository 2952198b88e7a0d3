//! Which part of a surface trims keep, found a second way: by even–odd against polylines.

use std::f64::consts::PI;

use glam::DVec2;
use nurbray::geometry::Surface;
use nurbray::geometry::trim::Kept;

/// The largest distance of polylines from their curves, as a share of the domain's shorter side.
const TOLERANCE: f64 = 1e-3;

/// How far beside a corner it is asked what is kept there, as a share of the domain: less than
/// polylines' sides are long, and far more than rounding.
const BESIDE: f64 = 1e-7;

/// The part of a surface that trims keep.
#[derive(Clone, Debug)]
pub(crate) enum Outline {
    /// All of it.
    Whole,
    /// The inside of these loops, or the outside.
    Within(Outlines),
    /// Unknown: the surface is so large beside its trims that no polyline is fine enough.
    Unknown,
}

impl Outline {
    /// Returns the outline of a surface.
    pub(crate) fn of(surface: &Surface) -> Self {
        let Some(trimmed) = surface.trimmed() else { return Self::Whole };
        let (trims, domain) = (trimmed.trims(), surface.domain());
        let shorter = domain.iter().map(|[from, to]| to - from).fold(f64::INFINITY, f64::min);
        let tolerance = TOLERANCE * shorter;
        match trims.outlines(tolerance) {
            Ok(lines) => Self::Within(Outlines { lines, kept: trims.kept(), tolerance, domain }),
            Err(_) => Self::Unknown,
        }
    }

    /// The loops, where they are known.
    pub(crate) fn lines(&self) -> Option<&Outlines> {
        if let Self::Within(outlines) = self { Some(outlines) } else { None }
    }
}

/// The loops of a surface's trims as closed polylines. They check the tracer, which uses the
/// curves themselves.
#[derive(Clone, Debug)]
pub(crate) struct Outlines {
    lines: Vec<Vec<DVec2>>,
    kept: Kept,
    /// How far a curve may be from its polyline.
    tolerance: f64,
    domain: [[f64; 2]; 2],
}

impl Outlines {
    /// Whether a point is kept; `None` if a curve may pass on the point's other side.
    pub(crate) fn keeps(&self, uv: DVec2) -> Option<bool> {
        let is_near = self.sides().any(|[a, b]| distance(uv, a, b) <= 2.0 * self.tolerance);
        (!is_near).then(|| self.polygons_keep(uv))
    }

    /// Whether a point is kept by the polylines.
    fn polygons_keep(&self, uv: DVec2) -> bool {
        let is_crossed = |[a, b]: [DVec2; 2]| {
            let is_level = (a.y <= uv.y) != (b.y <= uv.y);
            is_level && a.x + (uv.y - a.y) / (b.y - a.y) * (b.x - a.x) > uv.x
        };
        let odd = self.sides().filter(|&side| is_crossed(side)).count() % 2 != 0;
        odd == (self.kept == Kept::Odd)
    }

    /// Whether a polyline passes within `reach` of a point, in u and in v separately.
    pub(crate) fn passes(&self, uv: DVec2, reach: DVec2) -> bool {
        let reach = reach + self.tolerance; // infinite where a tangent vanishes
        self.sides().any(|[from, to]| {
            // The part of the side that is near in u and in v.
            let (offset, along) = ((from - uv).to_array(), (to - from).to_array());
            let (mut first, mut last) = (0f64, 1f64);
            for k in 0..2 {
                let ends = [-reach[k], reach[k]].map(|end| (end - offset[k]) / along[k]);
                if along[k] != 0.0 {
                    first = first.max(ends[0].min(ends[1]));
                    last = last.min(ends[0].max(ends[1]));
                } else if offset[k].abs() > reach[k] {
                    return false;
                }
            }
            first <= last
        })
    }

    /// Whether a point is a corner of a polyline at which something is kept: in one of the sectors
    /// between the sides that end there, within the domain. A corner on the domain's border may
    /// have nothing but what is cut off around it, and so may one where loops touch: there hits
    /// are neither due nor false.
    pub(crate) fn is_kept_corner(&self, uv: DVec2) -> bool {
        let [low, high] = self.domain_corners();
        let size = high - low;
        let ends = |[a, b]: [DVec2; 2]| [(a, b), (b, a)];
        let sides = self.sides().flat_map(ends).filter(|&(end, _)| end == uv);
        let mut angles: Vec<f64> = sides.map(|(_, to)| ((to - uv) / size).to_angle()).collect();
        if angles.is_empty() {
            return false;
        }
        // So that no sector reaches round a corner of the domain, or beyond its border.
        angles.extend([-1.0, -0.5, 0.0, 0.5, 1.0].map(|half_turns| half_turns * PI));
        angles.sort_by(f64::total_cmp);
        angles.windows(2).any(|sector| {
            let middle = DVec2::from_angle(0.5 * (sector[0] + sector[1]));
            let beside = uv + BESIDE * middle * size;
            let is_within = beside.cmpgt(low).all() && beside.cmplt(high).all();
            is_within && self.polygons_keep(beside)
        })
    }

    /// The corners of the polylines within the domain, which lie on the curves to rounding.
    pub(crate) fn joints(&self) -> impl Iterator<Item = DVec2> {
        let [low, high] = self.domain_corners();
        let within = move |p: &&DVec2| p.cmpge(low).all() && p.cmple(high).all();
        self.lines.iter().flatten().filter(within).copied()
    }

    /// The lower and the upper ends of the domain.
    fn domain_corners(&self) -> [DVec2; 2] {
        let [u, v] = self.domain;
        [DVec2::new(u[0], v[0]), DVec2::new(u[1], v[1])]
    }

    fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.lines.iter().flat_map(|line| line.windows(2).map(|pair| [pair[0], pair[1]]))
    }
}

/// The distance of a point from a line segment.
fn distance(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let (along, offset) = (to - from, point - from);
    let share = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share };
    (offset - share * along).length()
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::trim::{TrimDomain, TrimLoop, Trims};
    use nurbray::geometry::{TrimmedSurface, shapes};

    use super::*;

    #[test]
    fn a_ring_is_kept_between_its_circles() {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let circle = |radius| TrimLoop::circle(DVec2::splat(0.5), radius).unwrap();
        let domain = TrimDomain::of(&plane).unwrap();
        let trims = Trims::new(domain, Kept::Odd, &[circle(0.4), circle(0.2)]).unwrap();
        let ring = TrimmedSurface::new(plane.clone(), trims).unwrap().into();
        let outline = Outline::of(&ring);
        let outlines = outline.lines().unwrap();
        for (u, kept) in [(0.5, false), (0.65, false), (0.75, true), (0.95, false)] {
            assert_eq!(outlines.keeps(DVec2::new(u, 0.5)), Some(kept), "{u}");
        }
        assert_eq!(outlines.keeps(DVec2::new(0.9005, 0.5)), None);
        // The inner circle is 0.2 from the middle: along a diagonal, more than 0.14 in u and in v.
        let middle = DVec2::splat(0.5);
        for (reach, near) in [((0.3, 0.0), true), ((0.15, 0.15), true), ((0.13, 0.13), false)] {
            assert_eq!(outlines.passes(middle, reach.into()), near, "{reach:?}");
        }
        assert!(outlines.passes(DVec2::new(0.95, 0.5), DVec2::new(0.06, 0.0)));
        assert!(outlines.passes(DVec2::new(0.95, 0.99), DVec2::new(0.06, f64::INFINITY)));
        assert!(!outlines.passes(DVec2::new(0.95, 0.99), DVec2::new(0.04, f64::INFINITY)));
        for joint in outlines.joints() {
            let radius = joint.distance(DVec2::splat(0.5));
            assert!((radius - 0.4).abs().min((radius - 0.2).abs()) < 1e-15, "{joint}");
            assert!(outlines.is_kept_corner(joint));
        }
        assert!(!outlines.is_kept_corner(DVec2::new(0.75, 0.5)));
        assert!(matches!(Outline::of(&plane.into()), Outline::Whole));
    }

    #[test]
    fn corners_at_which_all_is_cut_off_are_not_kept() {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let domain = TrimDomain::of(&plane).unwrap();
        let from = |u: [f64; 2], v: [f64; 2]| {
            let corners = [(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])];
            TrimLoop::polygon(&corners.map(DVec2::from)).unwrap()
        };
        // The upper half, and a square beside a square below it.
        let squares = [from([0.2, 0.4], [0.1, 0.3]), from([0.4, 0.6], [0.1, 0.3])];
        let loops = [&[from([0.0, 1.0], [0.5, 1.0])][..], &squares].concat();
        let trims = Trims::new(domain, Kept::Even, &loops).unwrap();
        let outline = Outline::of(&TrimmedSurface::new(plane, trims).unwrap().into());
        let outlines = outline.lines().unwrap();
        let kept = [(0.0, 0.5), (1.0, 0.5), (0.2, 0.1), (0.4, 0.1), (0.4, 0.3)];
        let cut_off = [(0.0, 1.0), (1.0, 1.0)];
        for (corners, is_kept) in [(&kept[..], true), (&cut_off, false)] {
            for &corner in corners {
                assert_eq!(outlines.is_kept_corner(corner.into()), is_kept, "{corner:?}");
            }
        }
    }
}
