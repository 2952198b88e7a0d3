//! Places on surfaces where rays are hard to meet: borders, knot lines, corners, poles.

use glam::DVec3;
use nurbray::geometry::{NurbsSurface, SurfaceDerivatives};

use super::super::border::Border;
use super::super::random::Random;

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

/// The deepest halving of a piece whose lines are aimed at: leaves are rarely smaller than a
/// sixteenth of a piece.
const HALVINGS: i32 = 4;

/// The surfaces of a model, and how to find places on them.
#[derive(Debug)]
pub(crate) struct Sites<'a> {
    surfaces: &'a [NurbsSurface],
    /// For each surface and direction the non-empty spans between knots.
    spans: Vec<[Vec<(f64, f64)>; 2]>,
    poles: Vec<(usize, Border)>,
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
        let borders = surfaces
            .iter()
            .enumerate()
            .flat_map(|(index, surface)| Border::all(surface).map(|border| (index, border)));
        let poles = borders.filter(|(index, border)| border.pole(&surfaces[*index]).is_some());
        Some(Self {
            surfaces,
            spans,
            poles: poles.collect(),
            centre: 0.5 * (low + high),
            half_extent: 0.5 * (high - low),
        })
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

    /// Some border, and the surface it belongs to.
    pub(crate) fn border(&self, random: &mut Random) -> (usize, Border) {
        let surface = self.surface(random);
        (surface, Border::all(&self.surfaces[surface])[random.below(4)])
    }

    /// A point of a border.
    pub(crate) fn on_border(
        &self,
        random: &mut Random,
        (surface, border): (usize, Border),
    ) -> Site {
        let spans = border.knots(&self.surfaces[surface]).spans();
        let spans: Vec<_> = spans.map(|span| (span.start, span.end)).collect();
        let (u, v) = border.uv(within(random, &spans));
        Site { surface, u, v }
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
        let pole = *self.poles.get(random.below(self.poles.len()))?;
        Some(self.on_border(random, pole))
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
        within(random, &self.spans[surface][direction])
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
}

/// Anywhere in one of these spans, each as often as the others.
fn within(random: &mut Random, spans: &[(f64, f64)]) -> f64 {
    let (start, end) = spans[random.below(spans.len())];
    random.between(start, end)
}

/// The smallest and largest coordinates of all control points.
fn bounds(surfaces: &[NurbsSurface]) -> (DVec3, DVec3) {
    surfaces
        .iter()
        .flat_map(|surface| surface.control())
        .map(|c| c.truncate() / c.w)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}
