//! Areas between closed polygons.

use glam::DVec2;

/// The part of a closed polygon within a rectangle (Sutherland & Hodgman 1974). Where the polygon
/// leaves and comes back, the part runs along the rectangle's border; empty if nothing is left.
pub(super) fn clipped(ring: &[DVec2], [low, high]: [DVec2; 2]) -> Vec<DVec2> {
    let mut ring = ring.to_vec();
    for (axis, limit, sign) in
        [(0, low.x, 1.0), (0, high.x, -1.0), (1, low.y, 1.0), (1, high.y, -1.0)]
    {
        let depth = |point: DVec2| sign * (point[axis] - limit);
        let mut kept = Vec::with_capacity(ring.len() + 4);
        for (index, &here) in ring.iter().enumerate() {
            let before = ring[(index + ring.len() - 1) % ring.len()];
            let (from, to) = (depth(before), depth(here));
            if (from < 0.0) != (to < 0.0) {
                let mut crossing = before.lerp(here, from / (from - to));
                crossing[axis] = limit;
                kept.push(crossing);
            }
            if to >= 0.0 {
                kept.push(here);
            }
        }
        ring = kept;
    }
    if ring.len() < 3 { Vec::new() } else { ring }
}

/// Joins rings, none of which cross by more than a picture shows, into one closed polygon that winds
/// once around what lies within an odd number of them, and not at all around the rest. It runs the
/// rings in turn, each counterclockwise if an even number of others lies around it, and joins them
/// by slits that it runs both ways.
pub(super) fn keyhole(rings: &[Vec<DVec2>]) -> Vec<DVec2> {
    let mut outline = Vec::new();
    let Some(start) = rings.iter().find_map(|ring| ring.first()) else { return outline };
    let areas: Vec<f64> = rings.iter().map(|ring| area(ring)).collect();
    let bounds: Vec<[DVec2; 2]> = rings.iter().map(|ring| bounds(ring)).collect();
    for (index, ring) in rings.iter().enumerate() {
        let Some(&first) = ring.first() else { continue };
        // Most rings lie beside each other, as their bounds show.
        let [low, high] = bounds[index];
        let around = (0..rings.len()).filter(|&other| {
            let [outer_low, outer_high] = bounds[other];
            other != index
                && areas[other].abs() >= areas[index].abs()
                && outer_low.cmple(high).all()
                && outer_high.cmpge(low).all()
                && surrounds(&rings[other], ring)
        });
        let outward = (around.count() % 2 == 0) == (areas[index] > 0.0);
        if outward {
            outline.extend(ring);
        } else {
            outline.extend(ring.iter().rev());
        }
        outline.push(if outward { first } else { ring[ring.len() - 1] });
        outline.push(*start);
    }
    outline
}

/// The corners of the box around a polygon.
fn bounds(ring: &[DVec2]) -> [DVec2; 2] {
    let grown = |[low, high]: [DVec2; 2], point: &DVec2| [low.min(*point), high.max(*point)];
    ring.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], grown)
}

/// The area of a polygon, positive if it runs counterclockwise.
fn area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    0.5 * pairs.map(|(a, b)| (*a - origin).perp_dot(*b - origin)).sum::<f64>()
}

/// The most edges of a polygon that are looked at to see whether another one lies around it.
const MOST_VOTES: usize = 64;

/// Whether a polygon lies around another one, which does not cross it but may touch it: most of the
/// points just inside the other one's edges lie within it. Of very many edges only some are asked.
fn surrounds(outer: &[DVec2], inner: &[DVec2]) -> bool {
    let side = area(inner).signum();
    let pairs = inner.iter().zip(inner.iter().cycle().skip(1));
    // Those that are asked must be a good part of the polygon, not its shortest edges.
    let step = inner.len().div_ceil(MOST_VOTES).max(1);
    let length = |pairs: &mut dyn Iterator<Item = (&DVec2, &DVec2)>| -> f64 {
        pairs.map(|(a, b)| a.distance(*b)).sum()
    };
    let whole = length(&mut pairs.clone());
    let is_fair = step as f64 * length(&mut pairs.clone().step_by(step)) >= 0.5 * whole;
    let asked = pairs.step_by(if is_fair { step } else { 1 });
    let votes = asked.map(|(&a, &b)| {
        let inward = side * (b - a).perp();
        let within = winds(outer, 0.5 * (a + b) + 1e-3 * inward);
        if within { a.distance(b) } else { -a.distance(b) }
    });
    votes.sum::<f64>() > 0.0
}

/// Whether a point lies within a polygon, by the number of edges to its right.
fn winds(ring: &[DVec2], point: DVec2) -> bool {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossed = pairs.filter(|(a, b)| {
        let level = (a.y <= point.y) != (b.y <= point.y);
        level && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(center: [f64; 2], half: f64) -> Vec<DVec2> {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        corners.map(|corner| DVec2::from(center) + half * DVec2::from(corner)).to_vec()
    }

    #[test]
    fn holes_and_islands_in_them_are_told_apart_whatever_way_they_run() {
        for turned in 0..8 {
            let mut rings =
                [square([0.0, 0.0], 4.0), square([1.0, 1.0], 2.0), square([1.0, 1.0], 1.0)];
            for (index, ring) in rings.iter_mut().enumerate() {
                if turned >> index & 1 == 1 {
                    ring.reverse();
                }
            }
            // The area, counted as often as the outline winds around it, leaves out holes.
            assert!((area(&keyhole(&rings)) - (64.0 - 16.0 + 4.0)).abs() < 1e-12);
            rings.reverse();
            assert!((area(&keyhole(&rings)) - (64.0 - 16.0 + 4.0)).abs() < 1e-12);
        }
        // Two that touch along an edge, and one that touches the ring around it.
        let beside = [square([0.0, 0.0], 1.0), square([2.0, 0.0], 1.0)];
        assert!((area(&keyhole(&beside)) - 8.0).abs() < 1e-12);
        let touching = [square([0.0, 0.0], 2.0), square([1.0, 0.0], 1.0)];
        assert!((area(&keyhole(&touching)) - 12.0).abs() < 1e-12);
        assert!(keyhole(&[]).is_empty() && keyhole(&[Vec::new()]).is_empty());
    }

    #[test]
    fn the_part_within_a_rectangle() {
        let window = [DVec2::ZERO, DVec2::splat(3.0)];
        let part = |ring: &[DVec2]| area(&clipped(ring, window));
        assert_eq!(part(&square([1.0, 1.0], 1.0)), 4.0);
        assert_eq!(part(&square([0.0, 0.0], 1.0)), 1.0);
        assert_eq!(part(&square([0.0, 1.5], 5.0)), 9.0);
        assert!(clipped(&square([9.0, 9.0], 1.0), window).is_empty());
        // Around a corner and back: the way along the border encloses nothing.
        let hook = [
            [1.0, 1.0],
            [5.0, 1.0],
            [5.0, 5.0],
            [1.0, 5.0],
            [1.0, 4.0],
            [4.0, 4.0],
            [4.0, 2.0],
            [1.0, 2.0],
        ];
        let hook: Vec<DVec2> = hook.map(DVec2::from).to_vec();
        assert_eq!(part(&hook), 2.0);
    }
}
