//! Surfaces of all kinds as lines in space.

use glam::{DVec2, DVec3};
use nurbray::geometry::{
    Direction, LimitSurface, NurbsCurve, NurbsSurface, RectSide, Surface, TrianglePatch, TrimEdge,
    TrimmedSurface,
};
use nurbray::scene::{Plane, PlottedSurface};
use plotters::style::RGBColor;

use super::panel::{COLORS, GREY, Item, Key, Mark, Panel, Path, Stroke};
use super::projection::Projection;
use super::space::pieces;

const BORDERS: RGBColor = COLORS[0];
const EDGES: RGBColor = COLORS[1];
const LINES: RGBColor = COLORS[5];

/// Each piece of a line is looked at this often to find how far it reaches.
const LOOKS: u32 = 8;

/// A curve in space on a surface, on these pieces of its parameter.
struct Line {
    at: Box<dyn Fn(f64) -> DVec3>,
    pieces: Vec<[f64; 2]>,
}

impl Line {
    fn new(at: impl Fn(f64) -> DVec3 + 'static) -> Self {
        Self { at: Box::new(at), pieces: vec![[0.0, 1.0]] }
    }

    fn of(curve: NurbsCurve) -> Self {
        let pieces = pieces(curve.knots());
        Self { at: Box::new(move |t| curve.point_at(t)), pieces }
    }

    fn along(edge: TrimEdge) -> Self {
        let pieces = edge.spans().collect();
        Self { at: Box::new(move |t| edge.point_at(t)), pieces }
    }

    /// Some points of it.
    fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let shares = (0..=LOOKS).map(|k| f64::from(k) / f64::from(LOOKS));
        self.pieces.iter().flat_map(move |&[a, b]| {
            shares.clone().map(move |share| (self.at)((a + share * (b - a)).min(b)))
        })
    }
}

/// The lines drawn of surfaces.
#[derive(Default)]
struct Lines {
    borders: Vec<Line>,
    edges: Vec<Line>,
    inner: Vec<Line>,
}

/// A panel with the borders of surfaces, their trim edges, `lines` curves of constant parameter
/// between borders, and on demand their control nets.
///
/// # Errors
/// When a trim edge has too high a degree.
pub(super) fn surfaces(
    title: Option<String>,
    plane: Option<Plane>,
    (plotted, lines, net): (&[PlottedSurface], usize, bool),
) -> Panel {
    let mut drawn = Lines::default();
    for one in plotted {
        match &one.surface {
            Surface::Nurbs(surface) => drawn.nurbs(surface, lines),
            Surface::Trimmed(surface) => drawn.trimmed(surface, lines),
            Surface::Triangle(patch) => drawn.triangle(patch, lines),
            Surface::Limit(surface) => drawn.limit(surface, lines),
            // Surfaces of any other kind are drawn by their points.
            other => drawn.any(other, lines),
        }
    }
    let nets = plotted.iter().map(|one| one.surface.control_net());
    let nets: Vec<_> = if net { nets.collect() } else { Vec::new() };
    let all = [&drawn.borders, &drawn.edges, &drawn.inner].into_iter().flatten();
    let points = all.flat_map(Line::points).chain(nets.iter().flat_map(|net| net.points.clone()));
    let projection = Projection::new(plane, points);

    let (mut items, mut legend) = (Vec::new(), Vec::new());
    for net in &nets {
        let points: Vec<DVec2> = net.points.iter().map(|&point| projection.of(point)).collect();
        items.extend(net.lines.iter().map(|&[a, b]| Item::Line {
            points: vec![points[a], points[b]],
            stroke: Stroke::thin(GREY),
        }));
        items.push(Item::Marks { points, mark: Mark::Ring, color: GREY });
    }
    let groups = [
        (drawn.inner, Stroke::thin(LINES), "curves of constant parameter"),
        (drawn.borders, Stroke::new(BORDERS, 1.6), "borders"),
        (drawn.edges, Stroke::new(EDGES, 1.6), "trim edges"),
    ];
    for (lines, stroke, name) in groups {
        if !lines.is_empty() {
            legend.push((Key::Line(stroke), name.to_owned()));
        }
        items.extend(lines.into_iter().map(|line| {
            let Line { at, pieces } = line;
            let path = Path { at: Box::new(move |t| projection.of(at(t))), pieces };
            Item::Curve { path, stroke }
        }));
    }
    legend.reverse();
    if net {
        legend.push((Key::Point(Mark::Ring, GREY), "control points".to_owned()));
    }
    let title = title.unwrap_or_else(|| "In space".to_owned());
    projection.panel(title, items, legend)
}

/// `count` evenly spaced values between two others.
fn between([start, end]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(move |k| start + k as f64 / (count + 1) as f64 * (end - start))
}

impl Lines {
    fn nurbs(&mut self, surface: &NurbsSurface, lines: usize) {
        for direction in Direction::BOTH {
            let curve = |at: f64| surface.curve_at(direction, at).ok();
            let ends = surface.knots(direction).domain();
            self.borders.extend(ends.into_iter().filter_map(curve).map(Line::of));
            self.inner.extend(between(ends, lines).filter_map(curve).map(Line::of));
        }
    }

    fn trimmed(&mut self, trimmed: &TrimmedSurface, lines: usize) {
        for direction in Direction::BOTH {
            let kept = |at: f64| trimmed.kept_curves(direction, at).unwrap_or_default();
            let ends = trimmed.surface().knots(direction).domain();
            self.borders.extend(ends.into_iter().flat_map(kept).map(Line::of));
            self.inner.extend(between(ends, lines).flat_map(kept).map(Line::of));
        }
        self.edges.extend(trimmed.edges().into_iter().map(Line::along));
    }

    fn triangle(&mut self, patch: &TrianglePatch, lines: usize) {
        // Along side k, from the line where the third coordinate is 0 towards its corner.
        for k in 0..3 {
            let line = |share: f64| {
                let patch = patch.clone();
                Line::new(move |t| {
                    let coordinates = [(1.0 - share) * (1.0 - t), (1.0 - share) * t, share];
                    patch.point_at(DVec2::new(coordinates[k], coordinates[(k + 1) % 3]))
                })
            };
            self.borders.push(line(0.0));
            self.inner.extend(between([0.0, 1.0], lines).map(line));
        }
    }

    /// The borders of a limit surface and of its cage's faces, and lines within, where the faces
    /// are part of the surface.
    fn limit(&mut self, surface: &LimitSurface, lines: usize) {
        for unit in 0..surface.unit_count() {
            for direction in Direction::BOTH {
                let curves =
                    |at| surface.unit_curves(unit, direction, at).into_iter().map(Line::of);
                self.borders.extend([0.0, 1.0].into_iter().flat_map(curves));
                self.inner.extend(between([0.0, 1.0], lines).flat_map(curves));
            }
        }
        // Doo–Sabin surfaces end within faces.
        for (index, patch) in surface.patches().iter().enumerate() {
            let Some(Ok(net)) = surface.surface(index) else { continue };
            let ranges = patch.rect.ranges();
            let is_within = |side: RectSide| ![0.0, 1.0].contains(&side.value_in(&ranges));
            let sides = RectSide::ALL.into_iter().filter(|&side| patch.border[side]);
            for side in sides.filter(|&side| is_within(side)) {
                let curve = net.curve_at(side.fixed(), side.value());
                self.borders.extend(curve.ok().map(Line::of));
            }
        }
    }

    fn any(&mut self, surface: &Surface, lines: usize) {
        let domain = surface.domain();
        for fixed in Direction::BOTH {
            let line = |at: f64| {
                let (surface, [start, end]) = (surface.clone(), domain[fixed.other()]);
                Line::new(move |t| {
                    surface.point_at(fixed.pair(at, start + t * (end - start)).into())
                })
            };
            self.borders.extend(domain[fixed].map(line));
            self.inner.extend(between(domain[fixed], lines).map(line));
        }
    }
}
