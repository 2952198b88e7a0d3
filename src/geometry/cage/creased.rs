//! Quads beside a semi-sharp crease that goes straight on: a few bicubic patches, exactly.
//!
//! Let creases of finite sharpness run along one axis of a quad only, each as sharp before and
//! after the quad as beside it, and let the quad be regular otherwise. Then the rules of refinement
//! (DeRose, Kass & Truong 1998) are products of a rule along the creases, that of uniform cubic
//! splines, and one across them: whatever refinement makes of the quad, along the creases it is one
//! spline. So the quad need only be halved across them, once for each step for which they are
//! sharp. (Nießner, Loop & Greiner 2012 evaluate single creases in this way.)

use glam::DVec3;

use super::mesh::Mesh;
use super::net::Net;
use super::topology::NONE;
use super::vertex_rule::decayed;
use crate::geometry::Direction;

/// A quad beside straight creases, or a strip of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct CreasedQuad {
    /// The direction across the creases.
    across: Direction,
    /// The control points of a uniform bicubic spline, by rows across the creases. The quad lies
    /// between the second and the third row, and so along the rows. What an infinitely sharp edge
    /// would hide is mirrored there, so that the spline ends at the edge.
    rows: [[DVec3; 4]; 4],
    /// The sharpness of the second and the third row; 0 if it is infinite, since the mirrored
    /// points keep that row where it is.
    sharpness: [f64; 2],
}

impl CreasedQuad {
    /// The quad of a face; `None` where it does not consist of strips.
    pub(super) fn of(mesh: &Mesh, face: usize) -> Option<Self> {
        /// The directions of the edges that leave the corners, in (u, v).
        const LEAVING: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        /// The places of the corners in `points`.
        const PLACES: [[usize; 2]; 4] = [[1, 1], [2, 1], [2, 2], [1, 2]];
        let corners = mesh.topology.face_range(face);
        if corners.len() != 4 {
            return None;
        }
        let corner = |k: usize| (corners.start + k) as u32;
        // The edges at the first and the last u, at the first and the last v.
        let sharpness = [[3, 1], [0, 2]].map(|sides| sides.map(|k| mesh.crease(corner(k))));
        let creased = sharpness.map(|sides| sides.iter().any(|&s| s > 0.0 && s.is_finite()));
        let across = match creased {
            [true, false] => Direction::U,
            [false, true] => Direction::V,
            _ => return None,
        };

        // By u, then by v.
        let mut points = [[DVec3::ZERO; 4]; 4];
        for (k, [u, v]) in PLACES.into_iter().enumerate() {
            let around = Around::of(mesh, corner(k))?;
            let ([a, b], [c, d]) = (LEAVING[k], LEAVING[(k + 3) % 4]);
            let steps = [[0, 0], [-a, -b], [c, d], [c - a, d - b]];
            let found = [Some(mesh.at(corner(k))), around.behind, around.beside, around.opposite];
            for ([x, y], point) in steps.into_iter().zip(found) {
                if let Some(point) = point {
                    points[u.wrapping_add_signed(x)][v.wrapping_add_signed(y)] = point;
                }
            }
        }
        let [first_u, first_v] = sharpness.map(|[first, _]| first == f64::INFINITY);
        let [last_u, last_v] = sharpness.map(|[_, last]| last == f64::INFINITY);
        for v in 0..4 {
            let column = mirrored(points.map(|row| row[v]), [first_u, last_u]);
            (0..4).for_each(|u| points[u][v] = column[u]);
        }
        points = points.map(|row| mirrored(row, [first_v, last_v]));

        let rows = if across == Direction::U { points } else { transposed(points) };
        let finite = |s: f64| if s.is_finite() { s } else { 0.0 };
        Some(Self { across, rows, sharpness: sharpness[across].map(finite) })
    }

    /// The direction across the creases.
    pub(super) fn across(&self) -> Direction {
        self.across
    }

    /// The two halves across the creases, the lower one first, refined by one step; `None` if
    /// nothing is sharp any more.
    pub(super) fn halves(&self) -> Option<[Self; 2]> {
        let Self { across, rows, sharpness: [first, last] } = *self;
        if first == 0.0 && last == 0.0 {
            return None;
        }
        let [before, first_row, last_row, after] = rows;
        let start = middle(before, first_row);
        let center = middle(first_row, last_row);
        let end = middle(last_row, after);
        let from = moved([before, first_row, last_row], first);
        let to = moved([first_row, last_row, after], last);
        let [first, last] = [first, last].map(decayed);
        Some([
            Self { across, rows: [start, from, center, to], sharpness: [first, 0.0] },
            Self { across, rows: [from, center, to, end], sharpness: [0.0, last] },
        ])
    }

    /// The patch that the surface over the quad is if nothing is sharp. Else a patch near it: as if
    /// the rows were sharp for ever, but with their borders, and the points beside them, moved to
    /// where the surface ends.
    pub(super) fn patch(&self) -> Net {
        let [before, first_row, last_row, after] = self.rows;
        let [first, last] = self.sharpness;
        let mut rows = self.rows;
        let mut ends = [[DVec3::ZERO; 4]; 2];
        if first > 0.0 {
            rows[0] = beyond(first_row, last_row);
            ends[0] = minus(limit([before, first_row, last_row], first), first_row);
        }
        if last > 0.0 {
            rows[3] = beyond(last_row, first_row);
            ends[1] = minus(limit([first_row, last_row, after], last), last_row);
        }
        let mut net = bezier_patch(self.across, rows);
        let moves = ends.map(bezier);
        for (k, point) in net.iter_mut().enumerate() {
            let place = [k / 4, k % 4];
            let (across, along) = (place[self.across], place[self.across.other()]);
            *point += moves[across / 2][along];
        }
        net
    }
}

/// The Bézier patch of a spline given by its rows across a direction, v fastest.
fn bezier_patch(across: Direction, rows: [[DVec3; 4]; 4]) -> Net {
    let points = transposed(transposed(rows.map(bezier)).map(bezier));
    let points = if across == Direction::U { points } else { transposed(points) };
    std::array::from_fn(|k| points[k / 4][k % 4])
}

/// What lies around a corner of a quad outside the quad.
struct Around {
    /// The far end of the edge that continues the corner's edge backwards.
    behind: Option<DVec3>,
    /// The far end of the edge that continues the edge that arrives at the corner.
    beside: Option<DVec3>,
    /// The far corner of the quad between these two edges.
    opposite: Option<DVec3>,
}

impl Around {
    /// `None` unless the vertex is regular: four quads, or two or one at the border, and each edge
    /// as sharp as the one that continues it.
    ///
    /// So the rules of refinement are products there. A vertex with its own sharpness stays where
    /// it is, as if edges crossed there that always stay sharp.
    fn of(mesh: &Mesh, corner: u32) -> Option<Self> {
        let topology = &mesh.topology;
        let vertex = topology.vertex(corner);
        let star = topology.star(vertex);
        if star.corners.iter().any(|&corner| topology.sides(corner) != 4) {
            return None;
        }
        let arriving = topology.previous(corner);
        let edges = [corner, arriving].map(|half| mesh.crease(half));
        let own = mesh.corners[vertex as usize];
        let fixed = own == f64::INFINITY && edges == [f64::INFINITY; 2];

        // The other halves of both edges, in the quads behind and beside.
        let known = |corner: u32| (corner != NONE).then_some(corner);
        let (arriving_twin, twin) = (known(topology.twin(arriving)), known(topology.twin(corner)));
        let closes = match (arriving_twin, twin) {
            (Some(_), Some(_)) => star.closed && star.corners.len() == 4 && (own == 0.0 || fixed),
            (None, None) => star.corners.len() == 1 && fixed,
            _ => !star.closed && star.corners.len() == 2 && (own == 0.0 || fixed),
        };
        let behind = arriving_twin.map(|half| topology.previous(half));
        let beside = twin.map(|half| topology.next(half));
        let goes_on = |half: Option<u32>, sharpness: f64| {
            half.is_none_or(|half| mesh.crease(half) == sharpness)
        };
        if !(closes && goes_on(behind, edges[0]) && goes_on(beside, edges[1])) {
            return None;
        }
        let tip = |half: u32| mesh.positions[topology.tip(half) as usize];
        let opposite =
            behind.filter(|_| beside.is_some()).and_then(|half| known(topology.twin(half)));
        Some(Self {
            behind: behind.map(|half| mesh.at(half)),
            beside: beside.map(tip),
            opposite: opposite.map(|half| tip(topology.next(half))),
        })
    }
}

/// The points with the first, the last or both replaced so that the uniform spline ends at the
/// second, the third or both.
fn mirrored([a, b, c, d]: [DVec3; 4], [first, last]: [bool; 2]) -> [DVec3; 4] {
    let start = if first { 2.0 * b - c } else { a };
    let end = if last { 2.0 * c - b } else { d };
    [start, b, c, end]
}

/// The mirror image of the next row on the other side of a row.
fn beyond(row: [DVec3; 4], next: [DVec3; 4]) -> [DVec3; 4] {
    std::array::from_fn(|k| 2.0 * row[k] - next[k])
}

fn minus(a: [DVec3; 4], b: [DVec3; 4]) -> [DVec3; 4] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn transposed(points: [[DVec3; 4]; 4]) -> [[DVec3; 4]; 4] {
    std::array::from_fn(|i| points.map(|row| row[i]))
}

/// The new row between two.
fn middle(a: [DVec3; 4], b: [DVec3; 4]) -> [DVec3; 4] {
    std::array::from_fn(|k| 0.5 * (a[k] + b[k]))
}

/// The row in the middle, of this sharpness, after a step.
fn moved([before, row, after]: [[DVec3; 4]; 3], sharpness: f64) -> [DVec3; 4] {
    let smooth = |k: usize| (6.0 * row[k] + (before[k] + after[k])) / 8.0;
    std::array::from_fn(|k| smooth(k).lerp(row[k], sharpness.min(1.0)))
}

/// Where the row in the middle, of this sharpness, goes in the limit.
fn limit([mut before, mut row, mut after]: [[DVec3; 4]; 3], mut sharpness: f64) -> [DVec3; 4] {
    while sharpness > 0.0 {
        let next = moved([before, row, after], sharpness);
        (before, after) = (middle(before, row), middle(row, after));
        row = next;
        sharpness = decayed(sharpness);
    }
    std::array::from_fn(|k| (4.0 * row[k] + (before[k] + after[k])) / 6.0)
}

/// The Bézier points of a uniform cubic spline's piece.
fn bezier([a, b, c, d]: [DVec3; 4]) -> [DVec3; 4] {
    let start = (4.0 * b + (a + c)) / 6.0;
    let end = (4.0 * c + (b + d)) / 6.0;
    [start, (2.0 * b + c) / 3.0, (2.0 * c + b) / 3.0, end]
}
