//! The trims of a surface in its (u, v).

use glam::{DVec2, Vec3Swizzles};
use nurbray::geometry::trim::{Kept, TrimError, UvBox};
use nurbray::scene::{LoopCurve, LoopCurveKind, PlottedSurface};
use plotters::style::RGBColor;

use super::area::clipped;
use super::panel::{COLORS, GREY, INK, Item, Key, Mark, Panel, Path, Scale, Stroke};
use super::space::pieces;

/// The colour of what is kept: pale, so that loops and the grid's numbers show.
const KEPT: RGBColor = RGBColor(222, 236, 246);

/// Tolerances of the filled area, in shares of the domain: a twentieth of a pixel in a picture of a
/// thousand, or half a pixel if that needs too many points. The curves drawn over its edges are
/// exact to a tenth of a pixel in any picture.
const AREA: [f64; 2] = [5e-5, 5e-4];

/// A domain more than this many times as long as wide is stretched to fill the plot.
const SLENDER: f64 = 4.0;

/// More control points than this are not drawn: they would cover the curves.
const MOST_CONTROLS: usize = 400;

/// More loops than this have neither numbers nor arrows, which would cover the loops.
const MOST_MARKED: usize = 64;

/// Where along a loop the heads of its two arrows may be, as shares of its length: at the first
/// of these in the domain, and at the first more than a quarter farther on.
const ARROWS: [f64; 8] = [0.06, 0.19, 0.31, 0.44, 0.56, 0.69, 0.81, 0.94];

/// A panel with the loops of a trimmed surface and what they keep.
///
/// # Errors
/// When the loops would have too many points: those some 10⁸ times as large as the domain.
pub(super) fn trims(title: String, plotted: &PlottedSurface) -> Result<Panel, TrimError> {
    let Some(trimmed) = plotted.surface.trimmed() else { return Err(TrimError::NoLoops) };
    let trims = trimmed.trims();
    let bounds = trims.domain().bounds();
    let corners = [bounds.min, bounds.max];
    let border = rectangle(bounds);
    let [fine, coarse] = AREA.map(|share| share * bounds.size().min_element());
    let outlines = trims.outlines(fine).or_else(|_| trims.outlines(coarse))?;

    let mut rings: Vec<Vec<DVec2>> = Vec::new();
    if trims.kept() == Kept::Even {
        rings.push(border[..4].to_vec());
    }
    let inside = outlines.iter().map(|outline| clipped(&outline[1..], corners));
    rings.extend(inside.filter(|ring| !ring.is_empty()));
    let mut items = vec![Item::Area { rings, color: KEPT }];
    items.push(Item::Line { points: border, stroke: Stroke::thin(INK) });
    // If a loop comes several times, moved by periods, only one copy is drawn as written.
    for outline in &outlines {
        items.push(Item::Line { points: outline.clone(), stroke: Stroke::thin(GREY) });
    }

    let mut legend = vec![(Key::Area(KEPT), "kept".to_owned())];
    let mut kinds: Vec<LoopCurveKind> =
        plotted.loops.iter().flatten().map(|one| one.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let drawn =
        |&kind: &LoopCurveKind| (Key::Line(Stroke::curve(color(kind))), name(kind).to_owned());
    legend.extend(kinds.iter().map(drawn));
    items.extend(controls(&plotted.loops, &mut legend));
    for one in plotted.loops.iter().flatten() {
        let curve = one.curve.clone();
        let path =
            Path { pieces: pieces(curve.knots()), at: Box::new(move |t| curve.point_at(t).xy()) };
        items.push(Item::Curve { path, stroke: Stroke::curve(color(one.kind)) });
    }
    if plotted.loops.len() <= MOST_MARKED {
        items.push(arrows(&outlines, bounds));
    }
    items.extend(numbers(&plotted.loops));

    let axes = ["u", "v"].map(str::to_owned);
    let size = bounds.size();
    let slender = size.max_element() > SLENDER * size.min_element();
    let scale = if slender { Scale::Parameters } else { Scale::Space };
    Ok(Panel { title, axes, scale, items, legend })
}

/// The corners of a rectangle, counterclockwise, the first one twice.
fn rectangle(UvBox { min, max }: UvBox) -> Vec<DVec2> {
    vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y), min]
}

fn color(kind: LoopCurveKind) -> RGBColor {
    COLORS[match kind {
        LoopCurveKind::Lines => 0,
        LoopCurveKind::Arc => 1,
        LoopCurveKind::Bezier => 2,
        _ => 3,
    }]
}

fn name(kind: LoopCurveKind) -> &'static str {
    match kind {
        LoopCurveKind::Lines => "lines",
        LoopCurveKind::Arc => "arcs",
        LoopCurveKind::Bezier => "Bézier curves",
        _ => "splines",
    }
}

/// The control points of all curves but circles, which are written without any.
fn controls(loops: &[Vec<LoopCurve>], legend: &mut Vec<(Key, String)>) -> Vec<Item> {
    let written = loops.iter().flatten().filter(|one| one.kind != LoopCurveKind::Arc);
    let polygons: Vec<Vec<DVec2>> =
        written.map(|one| one.curve.points().map(|point| point.xy()).collect()).collect();
    let count: usize = polygons.iter().map(Vec::len).sum();
    if count == 0 || count > MOST_CONTROLS {
        return Vec::new();
    }
    legend.push((Key::Point(Mark::Ring, GREY), "control points".to_owned()));
    let polygon = |points: Vec<DVec2>| {
        [
            Item::Line { points: points.clone(), stroke: Stroke::thin(GREY) },
            Item::Marks { points, mark: Mark::Ring, color: GREY },
        ]
    };
    polygons.into_iter().flat_map(polygon).collect()
}

/// Arrows that show which way the loops run.
fn arrows(outlines: &[Vec<DVec2>], bounds: UvBox) -> Item {
    let mut steps = Vec::new();
    for outline in outlines {
        let length: f64 = outline.windows(2).map(|chord| chord[0].distance(chord[1])).sum();
        let (mut last, first) = (f64::NEG_INFINITY, steps.len());
        for share in ARROWS {
            let step = step_at(outline, share * length);
            if let Some([from, to]) = step
                && bounds.holds(0.5 * (from + to))
                && share > last + 0.25
            {
                steps.push([from, to]);
                last = share;
                if steps.len() == first + 2 {
                    break;
                }
            }
        }
    }
    Item::Arrows { steps, color: INK }
}

/// Two points close together around the place at a length `along` of a line.
fn step_at(line: &[DVec2], mut along: f64) -> Option<[DVec2; 2]> {
    for chord in line.windows(2) {
        let length = chord[0].distance(chord[1]);
        if along <= length && length > 0.0 {
            let at = chord[0].lerp(chord[1], along / length);
            let step = 1e-3 * (chord[1] - chord[0]);
            return Some([at - step, at + step]);
        }
        along -= length;
    }
    None
}

/// Marks where each loop begins, with the number that errors give the loop, unless there are more
/// than [`MOST_MARKED`] of them.
fn numbers(loops: &[Vec<LoopCurve>]) -> Vec<Item> {
    let starts = loops.iter().enumerate().filter_map(|(number, curves)| {
        let curve = &curves.first()?.curve;
        let start = curve.point_at(curve.domain()[0]).xy();
        let all = curves.iter().flat_map(|one| one.curve.points().map(|point| point.xy()));
        let (sum, count) = all.fold((DVec2::ZERO, 0.0), |(sum, n), point| (sum + point, n + 1.0));
        Some((number, start, start - sum / count))
    });
    let starts: Vec<_> = starts.collect();
    let points = starts.iter().map(|&(_, start, _)| start).collect();
    let mut items = vec![Item::Marks { points, mark: Mark::Dot, color: INK }];
    if starts.len() > MOST_MARKED {
        return items;
    }
    items.extend(starts.into_iter().map(|(number, at, towards)| Item::Label {
        at,
        towards,
        text: format!("loop {number}"),
        color: INK,
    }));
    items
}
