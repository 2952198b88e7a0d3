//! Which part of a surface trims keep, found a second way: by even–odd against polylines.

use glam::DVec2;
use nurbray::geometry::Surface;
use nurbray::geometry::trim::Kept;

/// The largest distance of polylines from their curves, as a share of the domain's shorter side.
const TOLERANCE: f64 = 1e-3;

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
        let shorter = domain.iter().map(|(from, to)| to - from).fold(f64::INFINITY, f64::min);
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
    domain: [(f64, f64); 2],
}

impl Outlines {
    /// Whether a point is kept; `None` if a curve may pass on the point's other side.
    pub(crate) fn keeps(&self, uv: DVec2) -> Option<bool> {
        let mut odd = false;
        for pair in self.sides() {
            let [a, b] = pair;
            if distance(uv, a, b) <= 2.0 * self.tolerance {
                return None;
            }
            if (a.y <= uv.y) != (b.y <= uv.y) {
                let at = a.x + (uv.y - a.y) / (b.y - a.y) * (b.x - a.x);
                odd ^= at > uv.x;
            }
        }
        Some(odd == (self.kept == Kept::Odd))
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

    /// Whether a point is a corner of a polyline, within the domain or not.
    pub(crate) fn is_joint(&self, uv: DVec2) -> bool {
        self.lines.iter().flatten().any(|&joint| joint == uv)
    }

    /// The corners of the polylines within the domain, which lie on the curves to rounding.
    pub(crate) fn joints(&self) -> impl Iterator<Item = DVec2> {
        let [u, v] = self.domain;
        let within = move |p: &&DVec2| (u.0..=u.1).contains(&p.x) && (v.0..=v.1).contains(&p.y);
        self.lines.iter().flatten().filter(within).copied()
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
            assert!(outlines.is_joint(joint));
        }
        assert!(matches!(Outline::of(&plane.into()), Outline::Whole));
    }
}
