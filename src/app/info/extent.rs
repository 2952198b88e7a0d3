//! The box that a surface just fits in.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::{DVec2, DVec3, DVec4};
use nurbray::math::Aabb;
use nurbray::math::bernstein::restrict_net;
use nurbray::patch::TensorPatch;

/// The error allowed for the sides of a box, as a share of its size. A part of a surface bulges from
/// its control points by the square of its size, so four more halvings, two in each direction, gain
/// little more than one digit; f64 itself has 16 digits.
const TIGHTNESS: f64 = 1e-12;

/// The error of a side that cannot be avoided, relative to the largest coordinate: halving a
/// net about forty times rounds as often.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The most halvings for one side of a box: a tenth of a second's work. A surface that touches
/// its box in points needs a hundred. One that touches it along a curve that is not a parameter
/// line needs more the finer the tolerance, and has by then reached about 1e-9 of its size.
const MOST_HALVINGS: usize = 100_000;

/// The error bound of such a box's sides; `bounds` is the box itself, or one not much larger.
pub(super) fn tolerance(bounds: Aabb) -> f64 {
    f64::max(TIGHTNESS * bounds.size().max_element(), ROUNDINGS * bounds.magnitude())
}

/// The smallest box around these pieces of a surface, with sides parallel to the axes, to
/// within [`TIGHTNESS`]. Where that takes too long, it is the smallest box found that surely
/// holds all pieces.
///
/// For each side, the parts that may reach farthest are halved until none can reach farther
/// than a point known to be on the surface. A part lies in the hull of its Euclidean control
/// points, as weights are positive, and its corners lie on the surface.
pub(super) fn extent<'a>(pieces: impl Iterator<Item = &'a TensorPatch>) -> Aabb {
    extent_of_parts(pieces.map(|piece| (piece, [[0.0, 1.0]; 2])))
}

/// The same for parts of pieces: rectangles of their unit squares.
pub(super) fn extent_of_parts<'a>(
    parts: impl Iterator<Item = (&'a TensorPatch, [[f64; 2]; 2])>,
) -> Aabb {
    let nets: Vec<Net> = parts.map(|(piece, rect)| Net::new(piece, rect)).collect();
    let controls = nets.iter().flat_map(|net| &net.control).map(|c| c.project());
    let hull = Aabb::around(controls);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let within = |tolerance: f64| {
        let side = |axis: DVec3| farthest(&nets, axis, tolerance);
        Aabb {
            min: DVec3::from_array(axes.map(|axis| 0.0 - side(-axis))), // no −0
            max: DVec3::from_array(axes.map(side)),
        }
    };
    // Control points of small weights may be far away. Each box is much smaller than the one
    // before, until one is known well enough to say what is small.
    let mut allowed = tolerance(hull);
    loop {
        let found = within(allowed);
        let needed = tolerance(found);
        if allowed <= FINE_ENOUGH * needed || found.size().is_nan() {
            return found;
        }
        allowed = needed;
    }
}

/// A box that was looked for to within so many times its own tolerance is not looked for again.
const FINE_ENOUGH: f64 = 1.25;

/// The largest coordinate of the pieces along an axis.
fn farthest(nets: &[Net], axis: DVec3, tolerance: f64) -> f64 {
    let parts = nets.iter().map(|net| Part::of(net, axis));
    let mut reached = parts.map(|part| part.reached()).fold(f64::NEG_INFINITY, f64::max);
    let mut open: BinaryHeap<Part> = nets
        .iter()
        .map(|net| Part::of(net, axis))
        .filter(|part| part.limit > reached + tolerance)
        .collect();
    for _ in 0..MOST_HALVINGS {
        let Some(part) = open.pop() else { return reached };
        if part.limit <= reached + tolerance {
            return reached; // all other limits are no larger
        }
        for half in part.halves() {
            reached = reached.max(half.reached());
            if half.limit > reached + tolerance {
                open.push(half);
            }
        }
    }
    open.peek().map_or(reached, |part| part.limit.max(reached))
}

/// A part of a piece in Bernstein form.
struct Net {
    /// `(w x, w y, w z, w)`, second index fastest.
    control: Vec<DVec4>,
    /// Control points along the second parameter.
    columns: usize,
}

impl Net {
    fn new(piece: &TensorPatch, [s, t]: [[f64; 2]; 2]) -> Self {
        let mut control: Vec<DVec4> = piece.control().collect();
        if [s, t] != [[0.0, 1.0]; 2] {
            restrict_net(&mut control, piece.degree(), s, t);
        }
        Self { control, columns: piece.degree()[1] + 1 }
    }
}

/// One coordinate of a part of a piece, as a rational function in Bernstein form.
#[derive(Clone, Debug)]
struct Part {
    /// `(w x, w)`, second index fastest.
    net: Vec<DVec2>,
    /// Control points along the second parameter.
    columns: usize,
    /// The largest `x` of the control points: none on the surface is larger.
    limit: f64,
}

impl Part {
    fn of(net: &Net, axis: DVec3) -> Self {
        let along = |c: &DVec4| DVec2::new(axis.dot(c.truncate()), c.w);
        Self::new(net.control.iter().map(along).collect(), net.columns)
    }

    fn new(net: Vec<DVec2>, columns: usize) -> Self {
        let limit = net.iter().map(|c| c.x / c.y).fold(f64::NEG_INFINITY, f64::max);
        Self { net, columns, limit }
    }

    fn value(&self, row: usize, column: usize) -> f64 {
        let c = self.net[row * self.columns + column];
        c.x / c.y
    }

    fn rows(&self) -> usize {
        self.net.len() / self.columns
    }

    /// The largest value at a corner, where the surface passes through its control points.
    fn reached(&self) -> f64 {
        let (last_row, last_column) = (self.rows() - 1, self.columns - 1);
        let corners = [(0, 0), (0, last_column), (last_row, 0), (last_row, last_column)];
        corners.map(|(i, j)| self.value(i, j)).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The two halves, cut across the direction in which the values change most: along lines
    /// of constant value nothing is gained.
    fn halves(&self) -> [Self; 2] {
        let (rows, columns) = (self.rows(), self.columns);
        let pairs = |down: usize, right: usize| {
            let places =
                (0..rows - down).flat_map(move |i| (0..columns - right).map(move |j| (i, j)));
            places
                .map(|(i, j)| (self.value(i + down, j + right) - self.value(i, j)).abs())
                .fold(0.0, f64::max)
        };
        let across = usize::from(pairs(0, 1) >= pairs(1, 0));
        [[0.0, 0.5], [0.5, 1.0]].map(|half| {
            let mut ranges = [[0.0, 1.0]; 2];
            ranges[across] = half;
            let mut net = self.net.clone();
            restrict_net(&mut net, [rows - 1, columns - 1], ranges[0], ranges[1]);
            Self::new(net, columns)
        })
    }
}

/// Parts are ordered by how far they may reach.
impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.limit.total_cmp(&other.limit)
    }
}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Part {}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat};
    use nurbray::geometry::{NurbsSurface, shapes};
    use nurbray::intersect::SurfaceBvh;

    use super::*;

    fn tight(surface: &NurbsSurface) -> Aabb {
        let bvh = SurfaceBvh::build(std::slice::from_ref(surface)).unwrap();
        extent(bvh.patches().pieces().iter().map(|piece| &piece.patch))
    }

    /// Checks the box of a surface, to `within`.
    fn check(surface: &NurbsSurface, [min, max]: [DVec3; 2], within: f64) {
        let found = tight(surface);
        let off = (found.min - min).abs().max((found.max - max).abs()).max_element();
        assert!(off <= within, "{found:?}, not {min} {max}: {off}");
    }

    #[test]
    fn shapes_have_the_boxes_of_their_measures() {
        for size in [1e-8, 1.0, 1e8] {
            let within = 2e-12 * size;
            let all = DVec3::splat(size);
            check(&shapes::sphere(size).unwrap(), [-all, all], within);
            check(&shapes::sphere_biquadratic(size).unwrap(), [-all, all], within);
            let torus = shapes::torus(2.0 * size, 0.5 * size).unwrap();
            let corner = size * DVec3::new(2.5, 2.5, 0.5);
            check(&torus, [-corner, corner], 5.0 * within);
            let plane = shapes::plane(size, 3.0 * size).unwrap();
            let corner = size * DVec3::new(0.5, 1.5, 0.0);
            check(&plane, [-corner, corner], 0.0);
            let cone = shapes::cone(size, size).unwrap();
            check(&cone, [DVec3::new(-size, -size, 0.0), all], within);
        }
    }

    #[test]
    fn turned_and_far_away_too() {
        let sphere = shapes::sphere(1.0).unwrap();
        for (angle, offset) in [(0.3, 0.0), (1.2, 1e6)] {
            let center = DVec3::splat(offset);
            let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), angle);
            let moved = DAffine3::from_rotation_translation(turn, center);
            let moved = sphere.transformed(&moved).unwrap();
            check(&moved, [center - 1.0, center + 1.0], 4e-12 + 1e-13 * offset);
        }
        // Touching its box along circles: a torus on its side, and one askew, whose extent
        // along an axis with the angle a to its own is r + R sin a.
        let torus = shapes::torus(2.0, 0.5).unwrap();
        let a = 0.7_f64;
        let tilted = torus.transformed(&DAffine3::from_rotation_x(a)).unwrap();
        let corner = DVec3::new(2.5, 2.0 * a.cos() + 0.5, 2.0 * a.sin() + 0.5);
        check(&tilted, [-corner, corner], 1e-11);
    }

    /// Control points of small weights lie far off; the box is as exact as the surface is small.
    #[test]
    fn far_control_points_do_not_matter() {
        for far in [1e3, 1e6, 1e9] {
            let points = [[-1.0, 0.0], [0.3, far], [1.0, 0.37]];
            let points = points.iter().flat_map(|&[x, y]| [0.0, 1.0].map(|z| DVec3::new(x, y, z)));
            let weights = [1.0, 1.0, 1.0 / far, 1.0 / far, 1.0, 1.0].to_vec();
            let [u, v] = [2, 1].map(|p| nurbray::geometry::KnotVector::bezier(p).unwrap());
            let sheet = NurbsSurface::new(u, v, points.collect(), Some(weights)).unwrap();
            // y = (2 a + 0.37 t²) / (1 − 2 a + 2 a / far) with a = t (1 − t), by golden section.
            let y = |t: f64| {
                let a = t * (1.0 - t);
                (2.0 * a + 0.37 * t * t) / (1.0 - 2.0 * a + 2.0 * a / far)
            };
            let (mut low, mut high) = (0.3, 0.9);
            for _ in 0..80 {
                let [b, c] = [0.382, 0.618].map(|share| low + share * (high - low));
                if y(b) < y(c) { low = b } else { high = c }
            }
            let corner = DVec3::new(1.0, y(low), 1.0);
            check(&sheet, [DVec3::new(-1.0, 0.0, 0.0), corner], 4e-12);
        }
    }

    /// A ruled sheet sheared in (u, v) touches the top of its box along a diagonal.
    #[test]
    fn touching_along_a_curve_askew_costs_time_but_little_accuracy() {
        // z = 1 − (u − v)² as a biquadratic net: its polar form at (0, ½, 1)².
        let at = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let points = at.iter().flat_map(|u| {
            at.iter().map(move |v| {
                let (mean_u, mean_v) = (0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
                let z = 1.0 - (u[0] * u[1] - 2.0 * mean_u * mean_v + v[0] * v[1]);
                DVec3::new(mean_u, mean_v, z)
            })
        });
        let knots = nurbray::geometry::KnotVector::clamped_uniform(2, 3).unwrap();
        let sheet = NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap();
        assert!((sheet.point_at(DVec2::new(0.3, 0.7)).z - (1.0 - 0.16)).abs() < 1e-15);
        check(&sheet, [DVec3::ZERO, DVec3::ONE], 1e-9);
    }
}
