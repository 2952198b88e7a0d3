//! Curves in space, as plots of two of their coordinates.

use glam::{DVec2, DVec3};
use nurbray::geometry::KnotVector;
use nurbray::math::Measured;
use nurbray::scene::{CurveEntry, Plane, PlottedCurve};

use super::super::table::digits;
use super::panel::{GREY, Item, Key, Mark, Panel, Path, Scale, Stroke, color};

/// More control points or knots than this are not labelled: labels would cover them.
const MOST_LABELS: usize = 12;

/// The projection of space onto a plot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection(Plane);

impl Projection {
    /// The plane that was asked for, or the two coordinates in which these points vary most.
    pub(super) fn new(plane: Option<Plane>, points: impl Iterator<Item = DVec3>) -> Self {
        let around = points.fold(None, |around: Option<(DVec3, DVec3)>, point| {
            let (low, high) = around.unwrap_or((point, point));
            Some((low.min(point), high.max(point)))
        });
        let extent = around.map_or(DVec3::ZERO, |(low, high)| high - low);
        Self(plane.unwrap_or({
            let least = extent.min_element();
            match extent {
                extent if extent.z == least => Plane::Xy,
                extent if extent.y == least => Plane::Xz,
                _ => Plane::Yz,
            }
        }))
    }

    /// The coordinates of a point that are shown.
    pub(super) fn of(self, point: DVec3) -> DVec2 {
        match self.0 {
            Plane::Xy => DVec2::new(point.x, point.y),
            Plane::Xz => DVec2::new(point.x, point.z),
            Plane::Yz => DVec2::new(point.y, point.z),
        }
    }

    /// The names of the coordinates that are shown.
    pub(super) fn axes(self) -> [String; 2] {
        match self.0 {
            Plane::Xy => ["x", "y"],
            Plane::Xz => ["x", "z"],
            Plane::Yz => ["y", "z"],
        }
        .map(str::to_owned)
    }
}

/// The spans of a knot vector.
pub(super) fn pieces(knots: &KnotVector) -> Vec<[f64; 2]> {
    knots.spans().map(|span| [span.start, span.end]).collect()
}

/// The path of a curve in the projection.
pub(super) fn path(curve: &PlottedCurve, projection: Projection) -> Path {
    let pieces = pieces(curve.knots());
    let curve = curve.clone();
    Path { at: Box::new(move |t| projection.of(curve.point_at(t))), pieces }
}

/// A number in a label: short, as it is no more than a reminder.
pub(super) fn short(value: f64) -> String {
    let text = match value.abs() {
        size if size != 0.0 && !(1e-3..1e5).contains(&size) => format!("{value:.2e}"),
        _ => {
            let text = format!("{value:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    };
    text.replace('-', "−")
}

/// A number in the text of a figure: its first six digits.
pub(super) fn measured(value: f64) -> String {
    Measured(value).to_string().replace('-', "−")
}

/// One of several numbers that differ by up to `spread`: with as many digits as show a millionth
/// of that, six or more.
pub(super) fn told(value: f64, spread: f64) -> String {
    let before = (value.abs() / spread).log10().floor();
    let before = if before.is_finite() { before.clamp(0.0, 9.0) } else { 0.0 };
    digits(value, 6 + before as i32).replace('-', "−")
}

/// `P₁₂`.
pub(super) fn indexed(letter: &str, index: usize) -> String {
    let digits = index.to_string();
    let below = digits.chars().map(|digit| {
        let digit = digit.to_digit(10).unwrap_or(0);
        char::from_u32(u32::from('₀') + digit).unwrap_or('₀')
    });
    letter.chars().chain(below).collect()
}

/// Joins the labels of points that lie in one place, so that each place has one label. Points lie
/// in one place if no picture shows them apart, or if only rounding parts them.
fn joined(points: &[DVec2], texts: impl Iterator<Item = String>) -> Vec<(DVec2, String)> {
    let (low, high) = points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |around, &p| {
        (around.0.min(p), around.1.max(p))
    });
    let extent = (high - low).max_element();
    let mut labels: Vec<(DVec2, String)> = Vec::new();
    for (&point, text) in points.iter().zip(texts) {
        let near = (1e-9 * extent).max(8.0 * f64::EPSILON * point.abs().max_element());
        match labels.iter_mut().find(|(at, _)| at.distance(point) <= near) {
            Some((_, before)) => *before += &format!(", {text}"),
            None => labels.push((point, text)),
        }
    }
    labels
}

/// A control polygon with its points.
pub(super) fn bare_polygon(points: &[DVec2]) -> Vec<Item> {
    vec![
        Item::Line { points: points.to_vec(), stroke: Stroke::thin(GREY) },
        Item::Marks { points: points.to_vec(), mark: Mark::Ring, color: GREY },
    ]
}

/// A control polygon with its points and their names and, if the weights differ, their weights.
pub(super) fn polygon(points: &[DVec2], weights: &[f64], letter: &str) -> Vec<Item> {
    let mut items = bare_polygon(points);
    if points.len() > MOST_LABELS {
        return items;
    }
    let rational = weights.iter().any(|&weight| weight != weights[0]);
    let texts = weights.iter().enumerate().map(|(index, &weight)| match rational {
        true => format!("{}, w = {}", indexed(letter, index), short(weight)),
        false => indexed(letter, index),
    });
    let middle = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
    items.extend(joined(points, texts).into_iter().map(|(at, text)| Item::Label {
        at,
        towards: outwards(points, at, middle),
        text,
        color: GREY,
    }));
    items
}

/// The direction away from the polygon's edges at a point of it, or away from its middle where
/// it runs straight.
fn outwards(points: &[DVec2], at: DVec2, middle: DVec2) -> DVec2 {
    let toward_neighbours = points.windows(2).filter(|edge| edge[0] != edge[1]).map(|edge| {
        if edge[0] == at {
            (edge[1] - at).normalize_or_zero()
        } else if edge[1] == at {
            (edge[0] - at).normalize_or_zero()
        } else {
            DVec2::ZERO
        }
    });
    let away = -toward_neighbours.sum::<DVec2>();
    if away.length() > 0.3 { away } else { at - middle }
}

/// The points of a curve at its knots, with what to call them: parameter and multiplicity.
fn knots(curve: &PlottedCurve, projection: Projection) -> (Vec<DVec2>, Vec<String>) {
    let knots = curve.knots();
    let (_, end) = knots.domain();
    let parameters = knots.spans().map(|span| span.start).chain([end]);
    let named = parameters.map(|t| {
        let times = match knots.multiplicity(t) {
            1 => String::new(),
            times => format!(" (×{times})"),
        };
        (projection.of(curve.point_at(t)), format!("{}{times}", short(t)))
    });
    named.unzip()
}

/// Several curves in one plot.
pub(super) fn curves(
    title: Option<String>,
    plane: Option<Plane>,
    entries: &[CurveEntry<PlottedCurve>],
) -> Panel {
    let all = entries.iter().flat_map(|entry| entry.curve.points());
    let projection = Projection::new(plane, all);
    let single = entries.len() == 1;

    // Polygons lie behind all curves, each once.
    let mut items = Vec::new();
    let mut drawn: Vec<Vec<DVec2>> = Vec::new();
    for entry in entries.iter().filter(|entry| entry.polygon) {
        let points: Vec<DVec2> =
            entry.curve.points().into_iter().map(|point| projection.of(point)).collect();
        if !drawn.contains(&points) {
            let weights = if single { entry.curve.weights() } else { vec![1.0; points.len()] };
            items.extend(polygon(&points, &weights, "P"));
            drawn.push(points);
        }
    }
    let mut legend = Vec::new();
    let mut marks = Vec::new();
    for (index, entry) in entries.iter().enumerate() {
        let stroke = Stroke::numbered(index);
        items.push(Item::Curve { path: path(&entry.curve, projection), stroke });
        let label = match &entry.label {
            Some(label) => label.clone(),
            None if single => described(&entry.curve),
            None => format!("curve {index}"),
        };
        legend.push((Key::Line(stroke), label));
        if entry.knots {
            let (points, texts) = knots(&entry.curve, projection);
            if single && points.len() <= MOST_LABELS {
                marks.extend(knot_labels(&entry.curve, projection, &points, texts));
            }
            marks.push(Item::Marks { points, mark: Mark::Diamond, color: color(index) });
        }
    }
    items.extend(marks);
    if !drawn.is_empty() {
        legend.push((Key::Point(Mark::Ring, GREY), "control points".to_owned()));
    }
    if entries.iter().any(|entry| entry.knots) {
        let shade = if single { color(0) } else { GREY };
        legend.push((Key::Point(Mark::Diamond, shade), "knots".to_owned()));
    }
    let title = title.unwrap_or_else(|| match entries {
        [entry] => entry.label.clone().unwrap_or_else(|| described(&entry.curve)),
        _ => format!("{} curves", entries.len()),
    });
    Panel { title, axes: projection.axes(), scale: Scale::Space, items, legend }
}

/// Labels beside the knots of a curve, towards the middle of its control points.
fn knot_labels(
    curve: &PlottedCurve,
    projection: Projection,
    points: &[DVec2],
    texts: Vec<String>,
) -> Vec<Item> {
    let controls: Vec<DVec2> = curve.points().into_iter().map(|p| projection.of(p)).collect();
    let middle = controls.iter().sum::<DVec2>() / controls.len().max(1) as f64;
    let labels = joined(points, texts.into_iter()).into_iter();
    labels
        .map(|(at, text)| Item::Label {
            at,
            towards: if at == middle { DVec2::Y } else { middle - at },
            text: format!("t = {text}"),
            color: color(0),
        })
        .collect()
}

/// `rational curve of degree 3`.
pub(super) fn described(curve: &PlottedCurve) -> String {
    let weights = curve.weights();
    let kind = if weights.iter().any(|&w| w != weights[0]) { "rational curve" } else { "curve" };
    format!("{kind} of degree {}", curve.knots().degree())
}

/// The legend's entry for the curve of this number.
pub(super) fn entry(index: usize, text: &str) -> (Key, String) {
    (Key::Line(Stroke::numbered(index)), text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points that a picture shows apart have labels of their own, far from the origin, too.
    #[test]
    fn labels_of_one_place_are_joined() {
        for far in [0.0, 1.0, 1e8] {
            let points = [[0.0, 0.0], [1e-3, 0.0], [1e-14, 0.0]];
            let points = points.map(|point| DVec2::splat(far) + DVec2::from(point));
            let labels = joined(&points, ["a", "b", "c"].map(str::to_owned).into_iter());
            assert_eq!(labels, [(points[0], "a, c".to_owned()), (points[1], "b".to_owned())]);
        }
        assert_eq!(joined(&[DVec2::ONE; 2], ["a", "b"].map(str::to_owned).into_iter()).len(), 1);
    }
}
