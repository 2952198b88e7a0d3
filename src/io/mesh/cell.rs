//! Triangles of one cell of the parameters that chords cut.
//!
//! Chords touch, overlap or cross where loops do, as far as rounding lets them. So they are put on a
//! fine grid of the cell, and broken where they pass a point of it as nearly as that grid can tell,
//! until none crosses another (snap rounding: Hobby 1999). From then on all is exact: the grid's
//! numbers are integers, and the triangulation's predicates do not round.

use std::cmp::Ordering;
use std::collections::HashMap;

use glam::{DVec2, I64Vec2, Vec2Swizzles};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::geometry::trim::UvBox;

/// The steps of the grid along each side of the cell.
const STEPS: i64 = 1 << 30;

/// The most times that all chords are broken. Two or three are usual, and 13 the most that was seen.
const MOST_ROUNDS: usize = 64;

/// Where there are [`MANY`] chords, the cell has a point inside for so many of them, if there is
/// room: or thousands of triangles would reach from one curve to the corners, each in the box of all
/// others.
const CHORDS_A_POINT: usize = 8;
const MANY: usize = 128;

/// A part of the cell between chords.
pub(super) struct Region {
    /// The middle of its largest triangle.
    pub(super) middle: DVec2,
    pub(super) triangles: Vec<[DVec2; 3]>,
}

/// Divides a cell along chords within it.
pub(super) fn regions(cell: &UvBox, chords: &[[DVec2; 2]]) -> Vec<Region> {
    let mut grid = Grid { cell: *cell, known: HashMap::new() };
    let mut chords: Vec<Chord> = chords.iter().map(|ends| ends.map(|uv| grid.put(uv))).collect();
    // A chord of no length is a point on a side, which the cell beside it has, too.
    let points: Vec<I64Vec2> = chords.as_flattened().to_vec();
    chords.retain(|ends| ends[0] != ends[1]);
    let chords = untangled(chords, &points);

    let mut triangles = Triangles::new();
    let corners = [[0, 0], [STEPS, 0], [STEPS, STEPS], [0, STEPS]].map(I64Vec2::from_array);
    let ends = chords.as_flattened();
    let inner = if chords.len() < MANY { 0 } else { chords.len() / CHORDS_A_POINT };
    let inner = points_inside(ends, inner);
    // Insertion fails only for points that are no numbers or beyond all bounds.
    for place in corners.iter().chain(&points).chain(&inner) {
        let _ = triangles.insert(Corner(*place));
    }
    let mut are_exact = true;
    for ends in &chords {
        if let [Ok(from), Ok(to)] = ends.map(|place| triangles.insert(Corner(place))) {
            let can_add = triangles.can_add_constraint(from, to);
            are_exact &= can_add;
            if can_add {
                triangles.add_constraint(from, to);
            }
        }
    }
    grid.regions(&triangles, are_exact)
}

type Triangles = ConstrainedDelaunayTriangulation<Corner>;

/// A vertex of the triangles: a point of the grid.
struct Corner(I64Vec2);

impl HasPosition for Corner {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.0.x as f64, self.0.y as f64) // exact
    }
}

/// The points of a cell.
struct Grid {
    cell: UvBox,
    /// The parameters of ends of chords, which on a side of the cell are those of the cell beside
    /// it.
    known: HashMap<I64Vec2, DVec2>,
}

impl Grid {
    /// The point next to some parameters.
    fn put(&mut self, uv: DVec2) -> I64Vec2 {
        let UvBox { min, max } = self.cell;
        let place = ((uv - min) / (max - min) * STEPS as f64).round();
        let place = place.as_i64vec2().clamp(I64Vec2::ZERO, I64Vec2::splat(STEPS));
        // Of several, both cells beside a side take the same.
        let smaller = |a: DVec2, b: DVec2| if (a.x, a.y) <= (b.x, b.y) { a } else { b };
        self.known.entry(place).and_modify(|known| *known = smaller(*known, uv)).or_insert(uv);
        place
    }

    fn uv(&self, place: I64Vec2) -> DVec2 {
        let UvBox { min, max } = self.cell;
        let between = |k: usize| match place[k] {
            0 => min[k],
            STEPS => max[k],
            steps => min[k] + steps as f64 / STEPS as f64 * (max[k] - min[k]),
        };
        self.known.get(&place).copied().unwrap_or_else(|| DVec2::new(between(0), between(1)))
    }

    /// The triangles, collected between chords; each by itself if some chord is missing.
    fn regions(&self, triangles: &Triangles, are_exact: bool) -> Vec<Region> {
        let faces: Vec<_> = triangles.inner_faces().collect();
        let number: HashMap<_, _> =
            faces.iter().enumerate().map(|(k, face)| (face.fix(), k)).collect();
        let mut is_taken = vec![false; faces.len()];
        let mut regions = Vec::new();
        for first in 0..faces.len() {
            if is_taken[first] {
                continue;
            }
            is_taken[first] = true;
            let mut region = Region { middle: DVec2::NAN, triangles: Vec::new() };
            let (mut largest, mut waiting) = (0.0, vec![first]);
            while let Some(face) = waiting.pop() {
                let corners = faces[face].vertices().map(|vertex| self.uv(vertex.data().0));
                let area = faces[face].area();
                if area > largest {
                    (largest, region.middle) = (area, corners.iter().sum::<DVec2>() / 3.0);
                }
                region.triangles.push(corners);
                for edge in faces[face].adjacent_edges() {
                    let ends_here = !are_exact || edge.is_constraint_edge();
                    let beyond = edge.rev().face().as_inner();
                    let beyond = beyond.and_then(|face| number.get(&face.fix()));
                    if let (false, Some(&beyond)) = (ends_here, beyond)
                        && !is_taken[beyond]
                    {
                        is_taken[beyond] = true;
                        waiting.push(beyond);
                    }
                }
            }
            regions.push(region);
        }
        regions
    }
}

/// About so many points, evenly in the cell, but none near one of `others`, the ends of chords.
fn points_inside(others: &[I64Vec2], count: usize) -> Vec<I64Vec2> {
    let side = count.isqrt() as i64;
    if side == 0 {
        return Vec::new();
    }
    let mut is_free = vec![true; (side * side) as usize];
    for place in others {
        let [i, j] = [place.x, place.y].map(|at| (at * side / STEPS).min(side - 1));
        is_free[(i * side + j) as usize] = false;
    }
    let middle = |k: i64| (2 * k + 1) * STEPS / (2 * side);
    let places = (0..side).flat_map(|i| (0..side).map(move |j| I64Vec2::new(middle(i), middle(j))));
    places.zip(is_free).filter_map(|(place, is_free)| is_free.then_some(place)).collect()
}

/// The ends of a straight line.
type Chord = [I64Vec2; 2];

/// Chords broken so that they meet only in their ends and at none of `points`, each moved by no more
/// than a few steps of the grid. (If they were not done after [`MOST_ROUNDS`], triangles would be
/// judged one by one.)
fn untangled(mut chords: Vec<Chord>, points: &[I64Vec2]) -> Vec<Chord> {
    let mut points = points.to_vec();
    // What follows looks for neighbours along the first coordinate: the one in which chords are
    // shorter.
    let extent = chords.iter().fold(I64Vec2::ZERO, |sum, [from, to]| sum + (*to - *from).abs());
    let is_turned = extent.x > extent.y;
    if is_turned {
        points.iter_mut().chain(chords.as_flattened_mut()).for_each(|place| *place = place.yx());
    }
    for _ in 0..MOST_ROUNDS {
        for ends in &mut chords {
            ends.sort_unstable_by(in_order);
        }
        chords.sort_unstable_by(|a, b| in_order(&a[0], &b[0]).then(in_order(&a[1], &b[1])));
        chords.dedup();
        let crossings = crossings(&chords);
        points.extend(crossings.iter().flatten().chain(chords.as_flattened()));
        points.sort_unstable_by(in_order);
        points.dedup();
        let chords_and_crossings = chords.iter().zip(crossings);
        let broken: Vec<Chord> =
            chords_and_crossings.flat_map(|(chord, own)| broken(*chord, &points, own)).collect();
        if broken.len() == chords.len() {
            break;
        }
        chords = broken;
    }
    if is_turned {
        chords.as_flattened_mut().iter_mut().for_each(|place| *place = place.yx());
    }
    chords
}

fn in_order(a: &I64Vec2, b: &I64Vec2) -> Ordering {
    (a.x, a.y).cmp(&(b.x, b.y))
}

/// For each of some chords, which are in order, the points of the grid next to where others cross
/// it.
fn crossings(chords: &[Chord]) -> Vec<Vec<I64Vec2>> {
    let mut points = vec![Vec::new(); chords.len()];
    for (k, a) in chords.iter().enumerate() {
        let next = (k + 1..chords.len()).take_while(|&l| chords[l][0].x <= a[1].x);
        for l in next {
            if let Some(point) = crossing(a, &chords[l]) {
                points[k].push(point);
                points[l].push(point);
            }
        }
    }
    points
}

/// The point of the grid next to that where two chords cross, ends not included. It is never on a
/// side of the cell, where the cell beside it would lack it.
fn crossing(a: &Chord, b: &Chord) -> Option<I64Vec2> {
    let [low, high] = [a, b]
        .map(|[from, to]| [from.y.min(to.y), from.y.max(to.y)])
        .into_iter()
        .fold([i64::MIN, i64::MAX], |[low, high], [l, h]| [low.max(l), high.min(h)]);
    if low > high {
        return None;
    }
    let apart = |[x, y]: [i128; 2]| x.signum() * y.signum() < 0;
    let of_a = a.map(|end| side_of(b, end));
    if !apart(of_a) || !apart(b.map(|end| side_of(a, end))) {
        return None;
    }
    let share = of_a[0] as f64 / (of_a[0] - of_a[1]) as f64;
    let point = (a[0].as_dvec2() + share * (a[1] - a[0]).as_dvec2()).round().as_i64vec2();
    Some(point.clamp(I64Vec2::ONE, I64Vec2::splat(STEPS - 1)))
}

/// Twice the area of the triangle of a chord and a point: positive on its left.
fn side_of([from, to]: &Chord, point: I64Vec2) -> i128 {
    let [along, to_point] =
        [*to - *from, point - *from].map(|step| [i128::from(step.x), i128::from(step.y)]);
    along[0] * to_point[1] - along[1] * to_point[0]
}

/// A chord broken at its `own` points, and at those of all points, which are in order, that it
/// passes within half a step in both coordinates.
fn broken(chord @ [from, to]: Chord, points: &[I64Vec2], own: Vec<I64Vec2>) -> Vec<Chord> {
    let along = |point: I64Vec2| (point - from).as_dvec2().dot((to - from).as_dvec2());
    let (length, size) = (along(to), (to - from).abs());
    let first = points.partition_point(|point| point.x < from.x);
    let near = points[first..].iter().take_while(|point| point.x <= to.x);
    let (low, high) = (from.y.min(to.y), from.y.max(to.y));
    let is_passed = |point: &&I64Vec2| {
        (low..=high).contains(&point.y)
            && 2 * side_of(&chord, **point).abs() < i128::from(size.x + size.y)
    };
    let mut places: Vec<(f64, I64Vec2)> = near
        .filter(is_passed)
        .chain(&own)
        .map(|point| (along(*point), *point))
        .filter(|(at, point)| *at > 0.0 && *at < length && *point != from && *point != to)
        .collect();
    places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let inner = places.into_iter().map(|(_, point)| point);
    let mut places: Vec<I64Vec2> = [from].into_iter().chain(inner).chain([to]).collect();
    places.dedup();
    places.windows(2).map(|ends| [ends[0], ends[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::SplitMix;

    /// Chords between places a few steps of the grid apart, where breaking one may make others cross.
    #[test]
    fn chords_meet_only_in_their_ends_at_last() {
        let mut random = SplitMix::new(9);
        let mut wanted = vec![[[0, 0], [1, 1]], [[1, 0], [5, 0]], [[0, 1], [0, 5]]];
        for _ in 0..3000 {
            let chords = wanted.iter().map(|ends| ends.map(I64Vec2::from));
            let chords = chords.filter(|[from, to]| from != to).collect();
            let chords = untangled(chords, &[]);
            for (k, a) in chords.iter().enumerate() {
                for b in &chords[k + 1..] {
                    assert_eq!(crossing(a, b), None, "{a:?} and {b:?}, of {wanted:?}");
                }
            }
            let size = 4.0 + 36.0 * random.unit();
            let mut place = || [random.unit(), random.unit()].map(|x| (size * x) as i64 + 1);
            let [count, _] = place();
            wanted = (0..2 + count.min(22)).map(|_| [place(), place()]).collect();
        }
    }

    /// Chords from everywhere to everywhere, with ends on chords, and the same ones again.
    #[test]
    fn regions_fill_the_cell_and_end_at_chords() {
        let cell = UvBox::new([1.0, 1.5], [-2.0, -1.9]);
        let whole = cell.size().x * cell.size().y;
        let mut random = SplitMix::new(5);
        for count in [1, 2, 5, 20, 60] {
            for _ in 0..20 {
                let mut chords: Vec<[DVec2; 2]> = Vec::new();
                for k in 0..count {
                    let mut place =
                        || cell.min + cell.size() * DVec2::new(random.unit(), random.unit());
                    let [from, to] = [place(), place()];
                    let share = random.unit();
                    // Ends that lie on others as far as rounding lets them.
                    let on = |chord: &[DVec2; 2]| chord[0].lerp(chord[1], share);
                    chords.push(match k % 4 {
                        1 => [on(&chords[k - 1]), to],
                        2 => [on(&chords[k - 1]), on(&chords[k - 2])],
                        3 => [chords[k - 1][1], chords[k - 3][0]],
                        _ => [from, to],
                    });
                }
                let regions = regions(&cell, &chords);
                let mut sum = 0.0;
                for region in &regions {
                    for [a, b, c] in &region.triangles {
                        let area = 0.5 * (b - a).perp_dot(c - a);
                        // Ends of chords are where they were, not on the grid.
                        assert!(area > -1e-9 * whole, "{a}, {b}, {c}");
                        sum += area;
                        // No chord passes through it.
                        let sides = [[a, b], [b, c], [c, a]];
                        let depth = |at: DVec2| {
                            let from_side = |[from, to]: &[&DVec2; 2]| {
                                let [along, to_place] =
                                    [**to - **from, at - **from].map(|step| step / cell.size());
                                along.perp_dot(to_place) / along.length()
                            };
                            sides.iter().map(from_side).fold(f64::INFINITY, f64::min)
                        };
                        for [from, to] in &chords {
                            let places =
                                (0..16).map(|k| from.lerp(*to, (f64::from(k) + 0.5) / 16.0));
                            let deepest = places.map(depth).fold(f64::NEG_INFINITY, f64::max);
                            assert!(deepest < 1e-8, "{from} to {to} is {deepest} inside");
                        }
                    }
                }
                assert!((sum / whole - 1.0).abs() < 1e-9, "{sum} of {whole}");
            }
        }
    }
}
