//! Constructions step by step: de Casteljau, knot insertion, elevation, corner cutting, curvature
//! combs.

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};
use nurbray::geometry::{CornerCutting, CurveError, NurbsCurve, PolygonEnds};
use nurbray::math::Aabb;
use nurbray::scene::{Plane, PlottedCurve, Written};
use plotters::style::RGBColor;

use super::bending::Bending;
use super::panel::{GREY, Item, Key, Mark, Panel, Stroke, color};
use super::projection::Projection;
use super::space::{bare_polygon, described, entry, path, pieces, polygon, short, told};

/// How far the longest tooth of a comb reaches, in shares of the curve's size, if the author
/// does not say how long a tooth is.
const COMB_REACH: f64 = 0.3;

/// The colour of the curve that is constructed; the construction is drawn in other colours.
const CURVE: RGBColor = RGBColor(60, 60, 60);

fn projected(curve: &PlottedCurve, plane: Option<Plane>) -> (Projection, Vec<DVec2>, Vec<f64>) {
    let projection = Projection::new(plane, curve.points().into_iter());
    let points = curve.points().into_iter().map(|point| projection.of(point)).collect();
    (projection, points, curve.weights())
}

/// The rounds of de Boor's algorithm at `t`, beginning with the control points of its span, all in
/// homogeneous coordinates. On a Bézier curve they are de Casteljau's. Each round mixes
/// neighbours in the ratio in which `t` divides the knots they share (de Boor 1972).
fn rounds(curve: &PlottedCurve, t: f64) -> Vec<Vec<DVec4>> {
    let (p, knots) = (curve.knots().degree(), curve.knots().values());
    let span = curve.knots().span_index(t);
    let control: Vec<DVec4> = match curve {
        PlottedCurve::Nurbs(curve) | PlottedCurve::Spline { curve, .. } => curve.control().to_vec(),
        PlottedCurve::Weighted { basis, points } => {
            let weighted = points.iter().zip(basis.weights());
            weighted.map(|(&point, &weight)| (weight * point).extend(weight)).collect()
        }
    };
    let mut rounds = vec![control[span - p..=span].to_vec()];
    for round in 1..=p {
        let before = &rounds[round - 1];
        let mixed = (0..=p - round).map(|k| {
            let j = k + round;
            let (left, right) = (knots[span - p + j], knots[span + 1 + j - round]);
            let share = (t - left) / (right - left);
            (1.0 - share) * before[k] + share * before[k + 1]
        });
        let mixed = mixed.collect();
        rounds.push(mixed);
    }
    rounds
}

/// The coordinates of a point constructed on a curve, as text: `(1.25, 0.5)`; with z, unless the
/// curve lies in z = 0.
fn coordinates(curve: &PlottedCurve, point: DVec4) -> String {
    // What rounding in the rounds may leave of a coordinate that is 0, as a share of the largest.
    const ROUNDING: f64 = 1e-14;
    let bounds = Aabb::around(curve.points());
    let (reach, spread) = (bounds.magnitude(), bounds.size().max_element());
    let lies_flat = bounds.min.z == 0.0 && bounds.max.z == 0.0;
    let shown = if lies_flat { 2 } else { 3 };
    let point = (point.xyz() / point.w).to_array();
    let words = point[..shown]
        .iter()
        .map(|&x| told(if x.abs() <= ROUNDING * reach { 0.0 } else { x }, spread));
    format!("({})", words.collect::<Vec<_>>().join(", "))
}

/// The construction of a point by de Casteljau's or de Boor's algorithm.
pub(super) fn de_casteljau(
    title: Option<String>,
    plane: Option<Plane>,
    (curve, t): (&PlottedCurve, f64),
) -> Panel {
    let (projection, points, weights) = projected(curve, plane);
    let mut items = polygon(&points, &weights, "P");
    let drawn = Stroke::curve(CURVE);
    items.push(Item::Curve { path: path(curve, projection), stroke: drawn });
    let mut legend = vec![(Key::Line(drawn), "curve".to_owned())];
    let rounds = rounds(curve, t);
    let [start, end] = curve.knots().domain();
    for (round, control) in rounds.iter().enumerate().skip(1) {
        let shade = color(round - 1);
        // A point without weight has no place.
        let weighty = control.iter().filter(|point| point.w > 0.0);
        let points: Vec<DVec2> =
            weighty.map(|point| projection.of(point.xyz() / point.w)).collect();
        let last = round + 1 == rounds.len();
        let name = match (last, points.len()) {
            (true, _) => {
                format!("C({}) = {}", told(t, end - start), coordinates(curve, control[0]))
            }
            (false, 1..) => format!("round {round}"),
            _ => String::new(),
        };
        if points.len() > 1 {
            let stroke = Stroke::numbered(round - 1).wide(1.5);
            items.push(Item::Line { points: points.clone(), stroke });
            legend.push(entry(round - 1, &name));
        } else {
            legend.push((Key::Point(Mark::Dot, shade), name));
        }
        items.push(Item::Marks { points, mark: Mark::Dot, color: shade });
    }
    let name = if curve.knots().spans().count() > 1 { "De Boor" } else { "De Casteljau" };
    let title =
        title.unwrap_or_else(|| format!("{name}’s algorithm at t = {}", told(t, end - start)));
    projection.panel(title, items, legend)
}

/// The control polygons of a curve while knots are inserted.
///
/// # Errors
/// When a knot cannot be inserted.
pub(super) fn insertion(
    title: Option<String>,
    plane: Option<Plane>,
    (curve, knots): (&NurbsCurve, &[Written<f64>]),
) -> Result<Panel, CurveError> {
    let (projection, points, weights) = projected(&curve.clone().into(), plane);
    let mut items = polygon(&points, &weights, "P");
    let drawn = Stroke::curve(CURVE);
    items.push(Item::Curve { path: path(&curve.clone().into(), projection), stroke: drawn });
    let mut legend = vec![(Key::Line(drawn), "curve".to_owned())];
    let mut curve = curve.clone();
    for (index, knot) in knots.iter().enumerate() {
        let old: Vec<DVec3> = curve.points().collect();
        curve = curve.insert_knot(knot.value, 1)?;
        let all: Vec<DVec3> = curve.points().collect();
        let (shade, is_new) = (color(index), |point: &DVec3| !old.contains(point));
        let seen = |points: &[DVec3]| points.iter().map(|&p| projection.of(p)).collect();

        // Most of the polygon stays: only what changes is drawn.
        for edge in all.windows(2).filter(|edge| edge.iter().any(is_new)) {
            items
                .push(Item::Line { points: seen(edge), stroke: Stroke::numbered(index).wide(1.5) });
        }
        let new: Vec<DVec3> = all.iter().copied().filter(|point| is_new(point)).collect();
        items.push(Item::Marks { points: seen(&new), mark: Mark::Dot, color: shade });
        let before = knots[..index].iter().filter(|other| other.value == knot.value).count();
        legend.push(entry(index, &format!("{} inserted {}", short(knot.value), times(before + 1))));
    }
    let title = title.unwrap_or_else(|| "Knot insertion".to_owned());
    Ok(projection.panel(title, items, legend))
}

/// The control polygons of a curve while its degree is raised: they come closer to it.
///
/// # Errors
/// When the degree cannot be so high.
pub(super) fn elevation(
    title: Option<String>,
    plane: Option<Plane>,
    (curve, times): (&NurbsCurve, usize),
) -> Result<Panel, CurveError> {
    let (projection, points, weights) = projected(&curve.clone().into(), plane);
    let mut items = polygon(&points, &weights, "P");
    let mut rounds = Vec::new();
    let mut elevated = curve.clone();
    for round in 0..times {
        elevated = elevated.elevated(1)?;
        let points: Vec<DVec2> = elevated.points().map(|point| projection.of(point)).collect();
        let shade = color(round);
        let stroke = Stroke::numbered(round).wide(1.5);
        items.push(Item::Line { points: points.clone(), stroke });
        items.push(Item::Marks { points, mark: Mark::Dot, color: shade });
        rounds.push(entry(round, &format!("of degree {}", elevated.knots().degree())));
    }
    // The polygons lie behind the curve, to which all of them come closer.
    let drawn = Stroke::curve(CURVE);
    let curve = PlottedCurve::from(curve.clone());
    items.push(Item::Curve { path: path(&curve, projection), stroke: drawn });
    let mut legend = vec![(Key::Line(drawn), described(&curve))];
    legend.append(&mut rounds);
    let title = title.unwrap_or_else(|| "Degree elevation".to_owned());
    Ok(projection.panel(title, items, legend))
}

/// Polygons with their corners cut again and again, and the limit.
///
/// # Errors
/// When the polygon has too few corners.
pub(super) fn corner_cutting(
    title: Option<String>,
    plane: Option<Plane>,
    (scheme, ends): (CornerCutting, PolygonEnds),
    (corners, rounds): (&[DVec3], usize),
) -> Result<Panel, CurveError> {
    let projection = Projection::new(plane, corners.iter().copied());
    let outline = |corners: &[DVec3]| -> Vec<DVec2> {
        let closing = (ends == PolygonEnds::Closed).then(|| corners.first()).flatten();
        corners.iter().chain(closing).map(|&corner| projection.of(corner)).collect()
    };
    let limit = scheme.limit(corners, ends)?;
    let mut items = vec![Item::Line { points: outline(corners), stroke: Stroke::thin(GREY) }];
    let ringed = corners.iter().map(|&corner| projection.of(corner)).collect();
    items.push(Item::Marks { points: ringed, mark: Mark::Ring, color: GREY });
    let mut legend = vec![(Key::Point(Mark::Ring, GREY), "polygon".to_owned())];
    let mut polygon = corners.to_vec();
    for round in 0..rounds {
        polygon = scheme.cut(&polygon, ends)?;
        let shade = color(round);
        let stroke = Stroke::numbered(round).wide(1.4);
        items.push(Item::Line { points: outline(&polygon), stroke });
        let points = polygon.iter().map(|&corner| projection.of(corner)).collect();
        items.push(Item::Marks { points, mark: Mark::Dot, color: shade });
        legend.push(entry(round, &format!("cut {}", times(round + 1))));
    }
    let stroke = Stroke::curve(CURVE);
    items.push(Item::Curve { path: path(&limit.into(), projection), stroke });
    legend.push((Key::Line(stroke), "limit".to_owned()));
    let title = title.unwrap_or_else(|| match scheme {
        CornerCutting::Chaikin => "Chaikin’s corner cutting".to_owned(),
        CornerCutting::Cubic => "Cubic corner cutting".to_owned(),
    });
    Ok(projection.panel(title, items, legend))
}

fn times(number: usize) -> String {
    match number {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        more => format!("{more} times"),
    }
}

/// A curvature comb: a curve with teeth in proportion to its curvature, on its outer side.
pub(super) fn comb(
    title: Option<String>,
    plane: Option<Plane>,
    curve: &NurbsCurve,
    (teeth, scale): (usize, Option<f64>),
) -> Panel {
    let (projection, points, _) = projected(&curve.clone().into(), plane);
    let mut items = bare_polygon(&points);

    // The feet of the teeth, and how far each tip is from its foot at scale 1.
    let mut spans: Vec<Vec<(DVec3, DVec3)>> = Vec::new();
    let bending = Bending::of(curve);
    for [start, end] in pieces(curve.knots()) {
        let last = end.next_down(); // of this span, not the first of the next
        let feet = (0..=teeth).filter_map(|k| {
            let t = (start + k as f64 / teeth as f64 * (end - start)).min(last);
            bending.at(t).map(|(point, bend)| (point, -bend))
        });
        spans.push(feet.collect());
    }
    let longest = spans.iter().flatten().map(|(_, bend)| bend.length()).fold(0.0, f64::max);
    let size = points
        .iter()
        .fold(None, |around: Option<(DVec2, DVec2)>, &p| {
            let (low, high) = around.unwrap_or((p, p));
            Some((low.min(p), high.max(p)))
        })
        .map_or(0.0, |(low, high)| (high - low).max_element());
    let fitting = if longest > 0.0 { COMB_REACH * size / longest } else { 0.0 };
    let scale = scale.unwrap_or(fitting);

    let shade = color(1);
    for span in &spans {
        let tip = |&(foot, bend): &(DVec3, DVec3)| projection.of(foot + scale * bend);
        for tooth in span {
            let points = vec![projection.of(tooth.0), tip(tooth)];
            items.push(Item::Line { points, stroke: Stroke::new(shade, 0.7) });
        }
        let points = span.iter().map(tip).collect();
        items.push(Item::Line { points, stroke: Stroke::new(shade, 1.3) });
    }
    let stroke = Stroke::curve(color(0));
    items.push(Item::Curve { path: path(&curve.clone().into(), projection), stroke });
    let legend = vec![
        entry(0, "curve"),
        entry(1, &format!("curvature × {}", short(scale))),
        (Key::Point(Mark::Ring, GREY), "control points".to_owned()),
    ];
    let title = title.unwrap_or_else(|| "Curvature comb".to_owned());
    projection.panel(title, items, legend)
}

#[cfg(test)]
mod tests {
    use super::super::space::indexed;
    use super::*;
    use nurbray::geometry::shapes::{circle_cubic, half_circle_cubic};
    use nurbray::geometry::{KnotVector, RationalBasis};

    #[test]
    fn the_last_round_is_the_point_and_the_first_the_control_points() {
        for curve in [half_circle_cubic(), circle_cubic()] {
            for t in [0.0, 0.2, 0.5, 0.8, 1.0] {
                let rounds = rounds(&curve.clone().into(), t);
                assert_eq!(rounds.len(), 4);
                for (round, points) in rounds.iter().enumerate() {
                    assert_eq!(points.len(), 4 - round);
                }
                let last = rounds[3][0];
                assert!((last.xyz() / last.w).distance(curve.point_at(t)) < 1e-15, "{t}");
            }
        }
    }

    /// Rogers' example 4.1 at t = 3/2 for the weights he gives.
    #[test]
    fn points_are_told_in_numbers() {
        let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]).unwrap();
        let points = [[0.0, 0.0], [1.0, 2.0], [2.5, 0.0], [4.0, 2.0], [5.0, 0.0]];
        let told = |h3: f64, z: f64| {
            let points = points.map(|[x, y]| DVec3::new(x, y, z)).to_vec();
            let weights = vec![1.0, 1.0, h3, 1.0, 1.0];
            let curve = if h3 > 0.0 {
                NurbsCurve::new(knots.clone(), points, Some(weights)).unwrap().into()
            } else {
                let basis = RationalBasis::new(knots.clone(), weights).unwrap();
                PlottedCurve::Weighted { basis, points }
            };
            let panel = de_casteljau(None, Some(Plane::Xy), (&curve, 1.5));
            panel.legend[panel.legend.len() - 1].1.clone()
        };
        assert_eq!(told(0.0, 0.0), "C(1.5) = (2.5, 2)");
        assert_eq!(told(0.25, 0.0), "C(1.5) = (2.5, 1.14286)"); // 8/7
        assert_eq!(told(1.0, 0.0), "C(1.5) = (2.5, 0.5)");
        assert_eq!(told(5.0, -2.0), "C(1.5) = (2.5, 0.125, −2)");
        let end = de_casteljau(None, None, (&half_circle_cubic().into(), 1.0)).legend;
        assert_eq!(end[end.len() - 1].1, "C(1) = (0, −1)");
    }

    #[test]
    fn names() {
        assert_eq!(indexed("P", 12), "P₁₂");
        assert_eq!([0.25, 1.0 / 3.0, -2.0, 1e-9].map(short), ["0.25", "0.333", "−2", "1.00e−9"]);
    }
}
