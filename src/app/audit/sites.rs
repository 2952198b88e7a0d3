//! Places on surfaces that are hard for rays: borders, knot lines, corners, poles.

use glam::{DVec2, DVec3};
use nurbray::geometry::{Chart, Charts, Direction, Surface, SurfaceDerivatives};

use super::super::border::Border;
use super::super::random::Random;
use super::outlines::Outline;

/// A point of a surface, by its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    /// Which surface.
    pub(crate) surface: usize,
    /// Its parameters there.
    pub(crate) uv: DVec2,
}

/// The deepest halving of a piece at whose lines rays are aimed. Leaves are rarely smaller than a
/// sixteenth of a piece, but those at trim edges are cut down by steps of a 256th.
const HALVINGS: usize = 8;

/// How many points find the model's box.
const BOX_SAMPLES: u64 = 1 << 14;

/// The stream of random numbers of these points; rays have others.
const BOX_STREAM: u64 = u64::MAX;

/// The surfaces of a model, and how to find places on them.
#[derive(Debug)]
pub(crate) struct Sites<'a> {
    surfaces: &'a [Surface],
    /// The charts of all surfaces, with the surface each belongs to.
    charts: Vec<(usize, Chart<'a>)>,
    /// For each chart and direction the non-empty spans between knots.
    spans: Vec<[Vec<[f64; 2]>; 2]>,
    /// The borders of surfaces, and those that are collapsed, with their charts.
    borders: Vec<(usize, Border)>,
    poles: Vec<(usize, Border)>,
    /// Points on the edges that trims cut.
    trim_edges: Vec<Site>,
    /// The middle of the model's box, and from there to its corner.
    center: DVec3,
    half_extent: DVec3,
}

impl<'a> Sites<'a> {
    /// Looks at every surface; `None` if there is none.
    pub(crate) fn new(surfaces: &'a [Surface]) -> Option<Self> {
        if surfaces.is_empty() {
            return None;
        }
        let charts: Vec<(usize, Chart<'a>)> = surfaces
            .iter()
            .enumerate()
            .flat_map(|(owner, surface)| surface.charts().into_iter().map(move |c| (owner, c)))
            .collect();
        let spans = charts
            .iter()
            .map(|(_, chart)| {
                [chart.surface.knots_u(), chart.surface.knots_v()]
                    .map(|knots| knots.spans().map(|span| [span.start, span.end]).collect())
            })
            .collect();
        let all = charts.iter().enumerate();
        let borders: Vec<_> = all
            .flat_map(|(k, (_, chart))| {
                let kept = Border::of(chart).filter(|border| border.is_kept(chart));
                kept.map(move |border| (k, border)).collect::<Vec<_>>()
            })
            .collect();
        let is_pole = |(k, border): &&(usize, Border)| border.pole(&charts[*k].1.surface).is_some();
        let mut sites = Self {
            surfaces,
            poles: borders.iter().filter(is_pole).copied().collect(),
            borders,
            trim_edges: trim_edges(surfaces),
            charts,
            spans,
            center: DVec3::ZERO,
            half_extent: DVec3::ZERO,
        };
        let (low, high) = sites.sampled_box();
        (sites.center, sites.half_extent) = (0.5 * (low + high), 0.5 * (high - low));
        Some(sites)
    }

    /// The box of many random points, a little smaller than the model's. (A box of control points
    /// may be several times as large, and most rays to it miss.)
    fn sampled_box(&self) -> (DVec3, DVec3) {
        let points = (0..BOX_SAMPLES)
            .map(|index| self.point(self.anywhere(&mut Random::new(0, BOX_STREAM, index))));
        extent(points)
    }

    /// The middle of the model's box.
    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    /// From the middle of the model's box to its corner, coordinate by coordinate.
    pub(crate) fn half_extent(&self) -> DVec3 {
        self.half_extent
    }

    /// The radius of a sphere about the box.
    pub(crate) fn radius(&self) -> f64 {
        self.half_extent.length()
    }

    /// Whether some border is collapsed to a point.
    pub(crate) fn has_poles(&self) -> bool {
        !self.poles.is_empty()
    }

    /// Point and derivatives at a site.
    pub(crate) fn derivatives(&self, site: Site) -> SurfaceDerivatives {
        self.surfaces[site.surface].derivatives(site.uv)
    }

    /// The point at a site.
    pub(crate) fn point(&self, site: Site) -> DVec3 {
        self.surfaces[site.surface].point_at(site.uv)
    }

    /// A random point of any surface; all charts, and all spans of a chart, are equally likely.
    pub(crate) fn anywhere(&self, random: &mut Random) -> Site {
        let chart = self.chart(random);
        let u = self.within_span(random, chart, Direction::U);
        let v = self.within_span(random, chart, Direction::V);
        self.site(chart, DVec2::new(u, v))
    }

    /// A random border, and the chart it belongs to; `None` where no surface ends.
    pub(crate) fn border(&self, random: &mut Random) -> Option<(usize, Border)> {
        self.borders.get(random.below(self.borders.len().max(1))).copied()
    }

    /// Whether some surface has a border.
    pub(crate) fn has_borders(&self) -> bool {
        !self.borders.is_empty()
    }

    /// Whether some surface is trimmed within its domain.
    pub(crate) fn has_trim_edges(&self) -> bool {
        !self.trim_edges.is_empty()
    }

    /// A point of an edge that trims cut; `None` if there is none.
    pub(crate) fn on_trim_edge(&self, random: &mut Random) -> Option<Site> {
        self.trim_edges.get(random.below(self.trim_edges.len().max(1))).copied()
    }

    /// A point of a border.
    pub(crate) fn on_border(&self, random: &mut Random, (chart, border): (usize, Border)) -> Site {
        let spans = border.knots(&self.charts[chart].1.surface).spans();
        let spans: Vec<_> = spans.map(|span| [span.start, span.end]).collect();
        self.site(chart, border.uv(within(random, &spans)))
    }

    /// A point of a line along which pieces meet or are halved.
    pub(crate) fn on_line(&self, random: &mut Random) -> Site {
        let chart = self.chart(random);
        if random.coin() {
            let u = self.on_division(random, chart, Direction::U);
            let v = self.within_span(random, chart, Direction::V);
            self.site(chart, DVec2::new(u, v))
        } else {
            let v = self.on_division(random, chart, Direction::V);
            let u = self.within_span(random, chart, Direction::U);
            self.site(chart, DVec2::new(u, v))
        }
    }

    /// A point where two such lines cross.
    pub(crate) fn on_corner(&self, random: &mut Random) -> Site {
        let chart = self.chart(random);
        let u = self.on_division(random, chart, Direction::U);
        let v = self.on_division(random, chart, Direction::V);
        self.site(chart, DVec2::new(u, v))
    }

    /// A point of a collapsed border; `None` if there is none.
    pub(crate) fn on_pole(&self, random: &mut Random) -> Option<Site> {
        let pole = *self.poles.get(random.below(self.poles.len()))?;
        Some(self.on_border(random, pole))
    }

    /// Two points with one parameter in common and the other in the same span: on a ruling,
    /// if the surface is ruled there.
    pub(crate) fn on_one_line(&self, random: &mut Random) -> [Site; 2] {
        let chart = self.chart(random);
        let uv = Direction::BOTH.map(|direction| self.within_span(random, chart, direction));
        let along = Direction::BOTH[random.below(2)];
        let t = uv[along];
        let spans = &self.spans[chart][along];
        let span = spans.iter().find(|span| span[0] <= t && t < span[1]).unwrap_or(&spans[0]);
        let other = random.between(span[0], span[1]);
        let mut beside = uv;
        beside[along] = other;
        [uv, beside].map(|uv| self.site(chart, uv.into()))
    }

    fn chart(&self, random: &mut Random) -> usize {
        random.below(self.charts.len())
    }

    /// Returns the site at a place of a chart.
    fn site(&self, chart: usize, uv: DVec2) -> Site {
        let (surface, chart) = &self.charts[chart];
        Site { surface: *surface, uv: chart.uv(uv) }
    }

    fn within_span(&self, random: &mut Random, chart: usize, direction: Direction) -> f64 {
        within(random, &self.spans[chart][direction])
    }

    /// A knot, or a division point of a span that is halved up to `HALVINGS` times.
    fn on_division(&self, random: &mut Random, chart: usize, direction: Direction) -> f64 {
        let spans = &self.spans[chart][direction];
        let [start, end] = spans[random.below(spans.len())];
        let parts = f64::powi(2.0, random.below(HALVINGS + 1) as i32);
        match random.below(parts as usize + 1) as f64 / parts {
            1.0 => end, // exactly, where start + (end − start) would round
            share => start + share * (end - start),
        }
    }
}

/// Points on the edges that trims cut from surfaces.
fn trim_edges(surfaces: &[Surface]) -> Vec<Site> {
    let mut sites = Vec::new();
    for (surface, one) in surfaces.iter().enumerate() {
        if let Outline::Within(outlines) = Outline::of(one) {
            sites.extend(outlines.joints().map(|uv| Site { surface, uv }));
        }
    }
    sites
}

/// A random parameter in one of these spans, all of which are equally likely.
fn within(random: &mut Random, spans: &[[f64; 2]]) -> f64 {
    let [start, end] = spans[random.below(spans.len())];
    random.between(start, end)
}

/// The radius of a sphere about the box of all control points; 0 if there are none.
pub(crate) fn control_radius(surfaces: &[Surface]) -> f64 {
    let charts: Vec<_> = surfaces.iter().flat_map(Charts::charts).collect();
    if charts.is_empty() {
        return 0.0;
    }
    let control = charts.iter().flat_map(|chart| chart.surface.control());
    let (low, high) = extent(control.map(|c| c.project()));
    (0.5 * (high - low)).length()
}

/// The smallest and largest coordinates of these points.
fn extent(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}
