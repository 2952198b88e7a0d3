//! What Catmull–Rom and Hermite splines are made from.

use glam::DVec2;
use nurbray::scene::SplineData;

use super::panel::{GREY, Item, Mark, Stroke};
use super::projection::Projection;

/// How long tangents are drawn, as a share of the derivatives: from a point to the control point
/// beside it.
const SHARE: f64 = 1.0 / 3.0;

/// Where along a tangent its head is.
const HEAD: [f64; 2] = [0.93, 0.97];

/// What the legend calls the tangents.
pub(super) const TANGENTS: &str = "derivatives × 1/3";

/// The points, where they are `seen`, and their polygon, or the tangents if there are any.
pub(super) fn spline_data(data: &SplineData, seen: &[DVec2], projection: Projection) -> Vec<Item> {
    let mut items = Vec::new();
    if data.derivatives.is_empty() {
        let outline = seen.iter().chain(seen.first().filter(|_| data.closed)).copied();
        items.push(Item::Line { points: outline.collect(), stroke: Stroke::thin(GREY) });
    }
    let tangents = data
        .points
        .iter()
        .zip(&data.derivatives)
        .map(|(&point, &along)| [point, point + SHARE * along].map(|end| projection.of(end)));
    let tangents: Vec<[DVec2; 2]> = tangents.collect();
    items.extend(
        tangents
            .iter()
            .map(|ends| Item::Line { points: ends.to_vec(), stroke: Stroke::thin(GREY) }),
    );
    let heads = tangents.iter().filter(|[from, to]| from != to);
    let steps = heads.map(|[from, to]| HEAD.map(|share| from.lerp(*to, share))).collect();
    items.push(Item::Arrows { steps, color: GREY });
    items.push(Item::Marks { points: seen.to_vec(), mark: Mark::Ring, color: GREY });
    items
}
