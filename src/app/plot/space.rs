//! Curves in space.

use glam::DVec2;
use nurbray::geometry::KnotVector;
use nurbray::math::Measured;
use nurbray::scene::{CurveEntry, Plane, PlottedCurve, SplineData};

use super::super::table::digits;
use super::panel::{GREY, Item, Key, Mark, Panel, Path, Stroke, color};
use super::projection::Projection;
use super::spline_data::{TANGENTS, spline_data};

/// More control points or knots than this are not labelled: labels would cover them.
const MOST_LABELS: usize = 12;

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
            Some((_, before)) if *before == text => {}
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
    items.extend(names(points, weights, letter));
    items
}

/// The names of control points and, if the weights differ, their weights.
fn names(points: &[DVec2], weights: &[f64], letter: &str) -> Vec<Item> {
    if points.len() > MOST_LABELS {
        return Vec::new();
    }
    let rational = weights.iter().any(|&weight| weight != weights[0]);
    let texts = weights.iter().enumerate().map(|(index, &weight)| match rational {
        true => format!("{}, w = {}", indexed(letter, index), short(weight)),
        false => indexed(letter, index),
    });
    let middle = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
    let label =
        |(at, text)| Item::Label { at, towards: outwards(points, at, middle), text, color: GREY };
    joined(points, texts).into_iter().map(label).collect()
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

/// The points of a curve, or of derivative `order` of it, `at` its knots, with what to call them:
/// parameter and multiplicity. Where it may jump, one point ends a piece and another one begins the
/// next.
pub(super) fn knots(
    knots: &KnotVector,
    order: usize,
    at: impl Fn(f64) -> DVec2,
) -> (Vec<DVec2>, Vec<String>) {
    let [start, end] = knots.domain();
    let parameters = knots.spans().map(|span| span.start).chain([end]);
    let named = parameters.flat_map(|t| {
        let multiplicity = knots.multiplicity(t);
        let times = match multiplicity {
            1 => String::new(),
            times => format!(" (×{times})"),
        };
        let jumps = multiplicity + order > knots.degree() && start < t && t < end;
        let before = jumps.then(|| at(t.next_down()));
        let text = format!("{}{times}", short(t));
        before.into_iter().chain([at(t)]).map(move |point| (point, text.clone()))
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
    let mut given: Vec<&SplineData> = Vec::new();
    for entry in entries.iter().filter(|entry| entry.polygon) {
        if let PlottedCurve::Spline { data, .. } = &entry.curve {
            if !given.contains(&data) {
                let seen = data.points.iter().map(|&point| projection.of(point));
                let seen: Vec<DVec2> = seen.collect();
                items.extend(spline_data(data, &seen, projection));
                items.extend(names(&seen, &vec![1.0; seen.len()], "P"));
                given.push(data);
            }
            continue;
        }
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
            let at = |t| projection.of(entry.curve.point_at(t));
            let (points, texts) = knots(entry.curve.knots(), 0, at);
            if single {
                let controls: Vec<DVec2> =
                    entry.curve.points().into_iter().map(|p| projection.of(p)).collect();
                marks.extend(knot_labels(&controls, &points, texts));
            }
            marks.push(Item::Marks { points, mark: Mark::Diamond, color: color(index) });
        }
    }
    items.extend(marks);
    if !drawn.is_empty() {
        legend.push((Key::Point(Mark::Ring, GREY), "control points".to_owned()));
    }
    if !given.is_empty() {
        legend.push((Key::Point(Mark::Ring, GREY), "points".to_owned()));
    }
    if given.iter().any(|data| !data.derivatives.is_empty()) {
        legend.push((Key::Line(Stroke::thin(GREY)), TANGENTS.to_owned()));
    }
    if entries.iter().any(|entry| entry.knots) {
        let shade = if single { color(0) } else { GREY };
        legend.push((Key::Point(Mark::Diamond, shade), "knots".to_owned()));
    }
    let title = title.unwrap_or_else(|| match entries {
        [entry] => entry.label.clone().unwrap_or_else(|| described(&entry.curve)),
        _ => format!("{} curves", entries.len()),
    });
    projection.panel(title, items, legend)
}

/// Labels beside the knots of a curve, towards the middle of its control points; none if they are
/// too many to be read.
pub(super) fn knot_labels(controls: &[DVec2], points: &[DVec2], texts: Vec<String>) -> Vec<Item> {
    if points.len() > MOST_LABELS {
        return Vec::new();
    }
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
