//! Places on surfaces where rays are hard to meet: borders, knot lines, corners, poles.

use glam::DVec3;
use nurbray::geometry::{NurbsSurface, SurfaceDerivatives};

use super::random::Random;

/// A point of a surface, by its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    /// Which surface.
    pub(crate) surface: usize,
    /// The first parameter.
    pub(crate) u: f64,
    /// The second parameter.
    pub(crate) v: f64,
}

/// One of the four borders of a surface's domain: one parameter is fixed, the other runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Border {
    /// Which surface.
    pub(crate) surface: usize,
    /// Which parameter is fixed: 0 for u, 1 for v.
    pub(crate) fixed: usize,
    /// What it is fixed at: an end of the domain.
    pub(crate) at: f64,
}

impl Border {
    /// The point where the other parameter is `t`.
    pub(crate) fn site(&self, t: f64) -> Site {
        let (u, v) = if self.fixed == 0 { (self.at, t) } else { (t, self.at) };
        Site { surface: self.surface, u, v }
    }
}

/// The deepest halving of a piece whose lines are aimed at: leaves are rarely smaller than a
/// sixteenth of a piece.
const HALVINGS: i32 = 4;

/// How many points of a border are looked at to find whether it is one point.
const POLE_SAMPLES: usize = 16;

/// A border whose points lie within this many roundings of one another is a pole: evaluation
/// errs by a few roundings for each degree.
const POLE_ROUNDINGS: f64 = 64.0;

/// The surfaces of a model, and how to find places on them.
#[derive(Debug)]
pub(crate) struct Sites<'a> {
    surfaces: &'a [NurbsSurface],
    /// For each surface and direction the non-empty spans between knots.
    spans: Vec<[Vec<(f64, f64)>; 2]>,
    poles: Vec<Border>,
    centre: DVec3,
    half_extent: DVec3,
}

impl<'a> Sites<'a> {
    /// Looks at every surface; `None` if there is none.
    pub(crate) fn new(surfaces: &'a [NurbsSurface]) -> Option<Self> {
        if surfaces.is_empty() {
            return None;
        }
        let spans = surfaces
            .iter()
            .map(|surface| {
                [surface.knots_u(), surface.knots_v()]
                    .map(|knots| knots.spans().map(|span| (span.start, span.end)).collect())
            })
            .collect();
        let (low, high) = bounds(surfaces);
        let mut sites = Self {
            surfaces,
            spans,
            poles: Vec::new(),
            centre: 0.5 * (low + high),
            half_extent: 0.5 * (high - low),
        };
        sites.poles = (0..surfaces.len())
            .flat_map(|surface| sites.borders(surface))
            .filter(|border| sites.is_pole(border))
            .collect();
        Some(sites)
    }

    /// The middle of the model's bounding box.
    pub(crate) fn centre(&self) -> DVec3 {
        self.centre
    }

    /// From the middle of the model's bounding box to its corner, coordinate by coordinate.
    pub(crate) fn half_extent(&self) -> DVec3 {
        self.half_extent
    }

    /// The radius of a sphere about the bounding box.
    pub(crate) fn radius(&self) -> f64 {
        self.half_extent.length()
    }

    /// Whether some border is collapsed to a point.
    pub(crate) fn has_poles(&self) -> bool {
        !self.poles.is_empty()
    }

    /// Point and derivatives at a site.
    pub(crate) fn derivatives(&self, site: Site) -> SurfaceDerivatives {
        self.surfaces[site.surface].derivatives(site.u, site.v)
    }

    /// The point at a site.
    pub(crate) fn point(&self, site: Site) -> DVec3 {
        self.surfaces[site.surface].point_at(site.u, site.v)
    }

    /// Any point of any surface; each surface and each of its spans as often as the others.
    pub(crate) fn anywhere(&self, random: &mut Random) -> Site {
        let surface = self.surface(random);
        let u = self.within_span(random, surface, 0);
        let v = self.within_span(random, surface, 1);
        Site { surface, u, v }
    }

    /// A point of some border, and that border.
    pub(crate) fn on_border(&self, random: &mut Random) -> (Border, Site) {
        let surface = self.surface(random);
        let border = self.borders(surface)[random.below(4)];
        (border, border.site(self.along(random, &border)))
    }

    /// A parameter on a border.
    pub(crate) fn along(&self, random: &mut Random, border: &Border) -> f64 {
        self.within_span(random, border.surface, 1 - border.fixed)
    }

    /// A point of a line along which pieces meet or are halved.
    pub(crate) fn on_line(&self, random: &mut Random) -> Site {
        let surface = self.surface(random);
        if random.coin() {
            let u = self.on_division(random, surface, 0);
            Site { surface, u, v: self.within_span(random, surface, 1) }
        } else {
            let v = self.on_division(random, surface, 1);
            Site { surface, u: self.within_span(random, surface, 0), v }
        }
    }

    /// A point where two such lines cross.
    pub(crate) fn on_corner(&self, random: &mut Random) -> Site {
        let surface = self.surface(random);
        let u = self.on_division(random, surface, 0);
        let v = self.on_division(random, surface, 1);
        Site { surface, u, v }
    }

    /// A point of a collapsed border; `None` if there is none.
    pub(crate) fn on_pole(&self, random: &mut Random) -> Option<Site> {
        let border = *self.poles.get(random.below(self.poles.len()))?;
        Some(border.site(self.along(random, &border)))
    }

    /// Two points with one parameter in common and the other in the same span: on a ruling,
    /// if the surface is ruled there.
    pub(crate) fn on_one_line(&self, random: &mut Random) -> [Site; 2] {
        let site = self.anywhere(random);
        let direction = random.below(2);
        let t = if direction == 0 { site.u } else { site.v };
        let spans = &self.spans[site.surface][direction];
        let span = spans.iter().find(|span| span.0 <= t && t < span.1).unwrap_or(&spans[0]);
        let other = random.between(span.0, span.1);
        match direction {
            0 => [site, Site { u: other, ..site }],
            _ => [site, Site { v: other, ..site }],
        }
    }

    fn surface(&self, random: &mut Random) -> usize {
        random.below(self.surfaces.len())
    }

    fn within_span(&self, random: &mut Random, surface: usize, direction: usize) -> f64 {
        let spans = &self.spans[surface][direction];
        let (start, end) = spans[random.below(spans.len())];
        random.between(start, end)
    }

    /// A knot, or a point that halves a span up to `HALVINGS` times.
    fn on_division(&self, random: &mut Random, surface: usize, direction: usize) -> f64 {
        let spans = &self.spans[surface][direction];
        let (start, end) = spans[random.below(spans.len())];
        let parts = f64::powi(2.0, random.below(HALVINGS as usize + 1) as i32);
        match random.below(parts as usize + 1) as f64 / parts {
            1.0 => end, // exactly, where start + (end − start) would round
            share => start + share * (end - start),
        }
    }

    fn borders(&self, surface: usize) -> [Border; 4] {
        let [u, v] = self.surfaces[surface].domain();
        [(0, u.0), (0, u.1), (1, v.0), (1, v.1)]
            .map(|(fixed, at)| Border { surface, fixed, at })
    }

    fn is_pole(&self, border: &Border) -> bool {
        let spans = &self.spans[border.surface][1 - border.fixed];
        let (start, end) = (spans[0].0, spans[spans.len() - 1].1);
        let at = |k: usize| {
            let t = start + (end - start) * k as f64 / POLE_SAMPLES as f64;
            self.point(border.site(t))
        };
        let first = at(0);
        let rounding = POLE_ROUNDINGS * f64::EPSILON * magnitude(&self.surfaces[border.surface]);
        (1..=POLE_SAMPLES).all(|k| at(k).distance(first) <= rounding)
    }
}

/// The largest coordinate of a surface's control points, in absolute value.
pub(crate) fn magnitude(surface: &NurbsSurface) -> f64 {
    let largest = |point: DVec3| point.abs().max_element();
    surface.control().iter().map(|c| largest(c.truncate() / c.w)).fold(0.0, f64::max)
}

/// The smallest and largest coordinates of all control points.
fn bounds(surfaces: &[NurbsSurface]) -> (DVec3, DVec3) {
    surfaces
        .iter()
        .flat_map(|surface| surface.control())
        .map(|c| c.truncate() / c.w)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}
