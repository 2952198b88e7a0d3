//! The box around things in space, with numbers along three of its edges.

use glam::{DVec2, DVec3};
use nurbray::math::Aabb;

use super::panel::{GRID, INK, Item, Stroke};
use super::projection::Projection;
use super::ticks::Ticks;

/// The length of marks beside numbers, as a share of the box's longest edge.
const MARK: f64 = 0.02;

/// An edge whose length is seen as less than this share of the longest has no numbers: they would
/// lie upon each other.
const SHORTEST: f64 = 0.05;

/// For how many steps between numbers an edge has room that is seen as long as the picture: small
/// pictures are some 250 pixels wide, a number with a gap beside it 30.
const ROOM: f64 = 8.0;

/// The names of the axes.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// The box, and along x, y and z one of its edges on its outline as it is seen, with numbers: those
/// of x and y in front at the bottom (from below, the top), that of z on the left.
pub(super) fn box_axes(bounds: Aabb, projection: Projection) -> Vec<Item> {
    let size = bounds.size();
    if !(size.min_element() >= 0.0 && size.max_element().is_finite()) {
        return Vec::new(); // nothing is there
    }
    let mut items = outline(bounds, projection);
    let toward = projection.toward();
    let ahead = toward.cmpgt(DVec3::ZERO);
    let near = DVec3::select(ahead, bounds.max, bounds.min);
    let far = DVec3::select(ahead, bounds.min, bounds.max);
    let bottom = if toward.z < 0.0 { bounds.max.z } else { bounds.min.z };
    let front = near.with_z(bottom);
    let sides = [near.with_x(far.x), near.with_y(far.y)];
    let is_left = projection.of(sides[0]).x < projection.of(sides[1]).x;
    let left = sides[usize::from(!is_left)];
    let starts = [front, front, left];
    let middle = projection.of(bounds.center());
    let longest = size.max_element();
    let seen = seen_size(bounds, projection);
    for (axis, start) in starts.into_iter().enumerate() {
        let at = |value: f64| {
            let mut point = start;
            point[axis] = value;
            projection.of(point)
        };
        let [low, high] = [bounds.min[axis], bounds.max[axis]];
        let along = at(high) - at(low);
        if along.length() <= SHORTEST * longest {
            continue;
        }
        items.push(Item::Line { points: vec![at(low), at(high)], stroke: Stroke::thin(INK) });

        // Numbers are beside the edge, away from the box.
        let across = along.perp().normalize();
        let outwards = if across.dot(at(low) - middle) < 0.0 { -across } else { across };
        let ticks = Ticks::along([low, high], ROOM * along.length() / seen);
        for &value in &ticks.values {
            let (from, text) = (at(value), ticks.text(value));
            let to = from + MARK * longest * outwards;
            items.push(Item::Line { points: vec![from, to], stroke: Stroke::thin(INK) });
            items.push(Item::Label { at: to, towards: outwards, text, color: INK });
        }
        let end = at(high) + 2.0 * MARK * longest * along.normalize();
        let text = ticks.name(NAMES[axis]);
        items.push(Item::Label { at: end, towards: along, text, color: INK });
    }
    items
}

/// A corner of a box as it is seen; a bit for each axis, set at its upper end.
fn corner(Aabb { min, max }: Aabb, projection: Projection, bits: usize) -> DVec2 {
    let is_high = |axis: usize| bits >> axis & 1 == 1;
    projection.of(DVec3::select(glam::BVec3::new(is_high(0), is_high(1), is_high(2)), max, min))
}

/// The width or the height of a box as it is seen, whichever is larger.
fn seen_size(bounds: Aabb, projection: Projection) -> f64 {
    let corners = || (0..8).map(|bits| corner(bounds, projection, bits));
    let (low, high) = (corners().reduce(DVec2::min), corners().reduce(DVec2::max));
    (high.unwrap_or_default() - low.unwrap_or_default()).max_element()
}

/// The edges of a box.
fn outline(bounds: Aabb, projection: Projection) -> Vec<Item> {
    let corner = |bits: usize| corner(bounds, projection, bits);
    let edges = (0..8).flat_map(|bits: usize| {
        let others = [1, 2, 4].into_iter().filter(move |bit| bits & bit == 0);
        others.map(move |bit| [bits, bits | bit])
    });
    let line = |[a, b]: [usize; 2]| -> Vec<DVec2> { vec![corner(a), corner(b)] };
    edges.map(|ends| Item::Line { points: line(ends), stroke: Stroke::thin(GRID) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbray::scene::Plane;

    /// From wherever the box is seen, no edge with numbers runs through the box's picture, and each
    /// axis has two numbers at least.
    #[test]
    fn numbers_are_on_the_outline() {
        let bounds = Aabb { min: DVec3::new(-1.0, 2.1, 0.3), max: DVec3::new(3.0, 2.9, 1.0) };
        let corners = (0..8).map(|bits: usize| {
            let pick = |axis: usize| [bounds.min, bounds.max][bits >> axis & 1][axis];
            DVec3::new(pick(0), pick(1), pick(2))
        });
        let corners: Vec<DVec3> = corners.collect();
        for k in 0..48 {
            let (turn, height) = (0.13 + 0.4 * f64::from(k), [0.6, -0.4, 1.7][k as usize % 3]);
            let toward = DVec2::from_angle(turn).extend(height);
            let projection = Projection::new(Some(Plane::Across(toward)), corners.iter().copied());
            let items = box_axes(bounds, projection);
            let edges = items.iter().filter_map(|item| match item {
                Item::Line { points, stroke } if stroke.color == INK => Some(points),
                _ => None,
            });
            let long = edges.filter(|edge| edge[0].distance(edge[1]) > 0.1);
            let mut count = 0;
            for edge in long {
                let side =
                    |corner: &DVec3| (edge[1] - edge[0]).perp_dot(projection.of(*corner) - edge[0]);
                let sides: Vec<f64> = corners.iter().map(side).collect();
                let is_outer =
                    sides.iter().all(|&side| side > -1e-12) || sides.iter().all(|&s| s < 1e-12);
                assert!(is_outer, "{toward}: {sides:?}");
                count += 1;
            }
            assert_eq!(count, 3, "{toward}");
            let labels = items.iter().filter(|item| matches!(item, Item::Label { .. })).count();
            assert!(labels >= 3 * 3, "{toward}: {labels} labels");
        }
    }
}
