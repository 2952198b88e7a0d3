//! Hodographs: the curves that derivatives run through.

use glam::{DVec2, DVec3};
use nurbray::geometry::NurbsCurve;
use nurbray::scene::Plane;

use super::functions::{derivative, derived};
use super::panel::{GREY, Item, Key, Mark, Panel, Path, Stroke, color};
use super::projection::Projection;
use super::space::{knot_labels, knots, pieces, polygon};

/// Each piece is looked at this often to find how far it reaches.
const LOOKS: u32 = 16;

/// Where along an arrow from the origin its head is.
const HEAD: [f64; 2] = [0.9, 0.92];

/// The curve through which derivative `order` of a curve runs, beginning at the origin, with
/// arrows to it at the knots. Of a curve without weights it is a spline of a lower degree, with
/// control points of its own.
pub(super) fn hodograph(
    title: Option<String>,
    plane: Option<Plane>,
    (curve, order): (&NurbsCurve, usize),
) -> Panel {
    let spans = pieces(curve.knots());
    let control = control_points(curve, order).unwrap_or_default();
    let share = |k: u32| f64::from(k) / f64::from(LOOKS);
    let seen = spans.iter().flat_map(|&[a, b]| (0..=LOOKS).map(move |k| a + share(k) * (b - a)));
    let seen = seen.map(|t| curve.derivative(order, t));
    let projection =
        Projection::new(plane, seen.chain(control.iter().copied()).chain([DVec3::ZERO]));
    let at = {
        let curve = curve.clone();
        move |t: f64| projection.of(curve.derivative(order, t))
    };

    let (stroke, origin) = (Stroke::curve(color(0)), projection.of(DVec3::ZERO));
    let mut items = Vec::new();
    let control: Vec<DVec2> = control.into_iter().map(|point| projection.of(point)).collect();
    if !control.is_empty() {
        items.extend(polygon(&control, &vec![1.0; control.len()], "D"));
    }
    let (tips, texts) = knots(curve.knots(), order, &at);
    for &tip in &tips {
        items.push(Item::Line { points: vec![origin, tip], stroke: Stroke::thin(GREY) });
    }
    let steps = tips.iter().map(|&tip| HEAD.map(|share| origin.lerp(tip, share))).collect();
    items.push(Item::Arrows { steps, color: GREY });
    let labels = knot_labels(&control, &tips, texts);
    items.push(Item::Curve { path: Path { at: Box::new(at), pieces: spans }, stroke });
    items.extend(labels);
    items.push(Item::Marks { points: tips, mark: Mark::Diamond, color: color(0) });
    items.push(Item::Marks { points: vec![origin], mark: Mark::Dot, color: GREY });

    let mut legend = vec![(Key::Line(stroke), derived("C", order))];
    if !control.is_empty() {
        legend.push((Key::Point(Mark::Ring, GREY), "control points".to_owned()));
    }
    legend.push((Key::Point(Mark::Diamond, color(0)), "knots".to_owned()));
    legend.push((Key::Point(Mark::Dot, GREY), "origin".to_owned()));
    let title = title.unwrap_or_else(|| format!("Hodograph: {}", derivative(order)));
    projection.panel(title, items, legend)
}

/// The control points of derivative `order` of a curve without weights; `None` if it has weights
/// that differ, or jumps.
///
/// Each time, `D_i = p (P_{i+1} − P_i) / (t_{i+p+1} − t_{i+1})` over the knots without the first
/// and the last one (Piegl & Tiller 1997, eq. 3.4).
fn control_points(curve: &NurbsCurve, order: usize) -> Option<Vec<DVec3>> {
    let weight = curve.control()[0].w;
    if curve.control().iter().any(|point| point.w != weight) {
        return None;
    }
    let mut points: Vec<DVec3> = curve.points().collect();
    let mut knots = curve.knots().values();
    for p in (curve.knots().degree() + 1 - order..=curve.knots().degree()).rev() {
        let pairs = points.windows(2).enumerate();
        let steps = pairs.map(|(i, pair)| {
            let width = knots[i + p + 1] - knots[i + 1];
            p as f64 * (pair[1] - pair[0]) / width
        });
        points = steps.collect();
        knots = &knots[1..knots.len() - 1];
    }
    points.iter().all(|point| point.is_finite()).then_some(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbray::geometry::{KnotVector, shapes};

    /// The hodograph's own spline is the derivative, on all spans.
    #[test]
    fn control_points_make_the_derivative() {
        let values = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 2.5, 4.0, 4.0, 4.0, 4.0];
        let knots = KnotVector::new(3, values.clone()).unwrap();
        let points = [[0.0, 0.0, 1.0], [1.0, 2.0, 0.0], [3.0, 2.0, -1.0], [4.0, 0.0, 0.5]];
        let points = points.iter().chain(&points[..3]).map(|&point| point.into()).collect();
        let curve = NurbsCurve::new(knots, points, None).unwrap();
        for order in 1..=2 {
            let inner = values[order..values.len() - order].to_vec();
            let knots = KnotVector::new(3 - order, inner).unwrap();
            let control = control_points(&curve, order).unwrap();
            let hodograph = NurbsCurve::new(knots, control, None).unwrap();
            for k in 0..=40 {
                let t = 0.1 * f64::from(k);
                let off = hodograph.point_at(t).distance(curve.derivative(order, t));
                assert!(off < 1e-13, "order {order}, t = {t}: {off:e}");
            }
        }
        assert_eq!(control_points(&curve, 3).map(|points| points.len()), None, "it jumps");
        assert_eq!(control_points(&shapes::half_circle_cubic(), 1), None, "it has weights");
    }
}
