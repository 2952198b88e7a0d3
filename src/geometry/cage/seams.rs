//! Makes patches of a limit surface meet: each seam gets one curve, each vertex one point.

use std::collections::HashMap;

use glam::DVec3;

use super::error::LimitError;
use super::limit_surface::{LimitPatch, LimitSurface};
use super::mesh::Mesh;
use super::net::halve;
use super::side::{Line, Side, SideNumber};
use super::side_groups::Groups;
use super::topology::Topology;
use super::tree::MAX_LEVELS;
use crate::geometry::{Direction, RectSide};

/// The shares of the tolerance that patches may initially be from the surface. Moving patches to
/// meet their neighbours takes them farther from it, up to half of the tolerance. The first share
/// is nearly always enough; each further one starts again from the beginning.
const SHARES: [f64; 5] = [0.25, 0.1, 0.04, 0.016, 0.0064];

/// A limit surface without gaps, from patches within a share of the tolerance.
pub(super) fn within(
    tolerance: f64,
    cage: &Mesh,
    patches: impl Fn(f64) -> Result<LimitSurface, LimitError>,
) -> Result<LimitSurface, LimitError> {
    for share in SHARES {
        let mut surface = patches(share)?;
        close(&mut surface, cage);
        if surface.deviation() <= 0.5 * tolerance {
            return match surface.extent().checked() {
                Ok(_) => Ok(surface),
                Err(error) => Err(LimitError::Surface(Box::new(error))),
            };
        }
    }
    Err(LimitError::TooDeep { tolerance, levels: MAX_LEVELS })
}

/// A point of the cage at which patches have corners; parameters are stored as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Spot {
    Vertex(u32),
    Edge(u32, u64),
    Spoke(u32, u64),
    Middle(u32),
    Inside(usize, [u64; 2]),
}

/// Moves the borders of patches that are not exact, or not of the same size, so that neighbours
/// meet: sides of one length get the same control points bit for bit; a side beside a longer one
/// gets the control points of that part of the longer one, up to rounding. Inner control points
/// stay.
///
/// On every line the longest sides are kept, and among equally long ones the exact one; shorter
/// ones follow them. A side is settled before those that end within it: these belong to squares at
/// most half as long, or lie between two strips of a square. A side between strips comes after the
/// sides of squares longer than the strips are wide: where it ends, strips begin at a multiple of
/// their width, which the side of a square contains only if it is twice as long or longer.
///
/// Moving a patch adds to its deviation at most the largest distance by which a control point
/// moved.
pub(super) fn close(surface: &mut LimitSurface, mesh: &Mesh) {
    let layout = Layout::new(&mesh.topology);
    let mut moved = vec![0.0; surface.patches.len()];
    let mut spots: HashMap<Spot, DVec3> = HashMap::with_capacity(surface.patches.len());
    let sides = 0..4 * surface.patches.len() as SideNumber;
    let groups = Groups::of(sides, |number| layout.side(surface, number));
    for group in groups.iter() {
        let leader = layout.side(surface, group[0]);
        let mut curve = row(surface, &leader);
        let last = surface.degree;
        for (at, point) in layout.ends(surface, &leader).into_iter().zip([0, last]) {
            curve[point] = *spots.entry(at).or_insert(curve[point]);
        }
        moved[leader.patch] = set_row(surface, &leader, &curve).max(moved[leader.patch]);
        for &follower in &group[1..] {
            let side = layout.side(surface, follower);
            let mut part = part((curve, last + 1), [leader.from, leader.to], [side.from, side.to]);
            for (at, point) in layout.ends(surface, &side).into_iter().zip([0, last]) {
                part[point] = *spots.entry(at).or_insert(part[point]);
            }
            moved[side.patch] = set_row(surface, &side, &part).max(moved[side.patch]);
        }
    }

    // A patch that moves by only a few rounding errors is as exact as before.
    let magnitude = mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let rounding = 16.0 * f64::EPSILON * magnitude;
    for (patch, moved) in surface.patches.iter_mut().zip(moved) {
        if moved > rounding {
            patch.deviation += moved;
            patch.exact = false;
        }
    }
}

/// The indices in the net of the control points of a side, along its line.
fn places(surface: &LimitSurface, side: &Side) -> impl Iterator<Item = usize> + use<> {
    let (n, Side { which, reversed, .. }) = (surface.degree, *side);
    let first = side.patch * (n + 1) * (n + 1);
    (0..=n).map(move |k| {
        let [i, j] = which.control_point([n; 2], if reversed { n - k } else { k });
        first + i * (n + 1) + j
    })
}

/// The control points of a side along its line, `degree + 1` of them.
type Row = [DVec3; 4];

fn row(surface: &LimitSurface, side: &Side) -> Row {
    let mut row = [DVec3::ZERO; 4];
    for (point, at) in row.iter_mut().zip(places(surface, side)) {
        *point = surface.control[at];
    }
    row
}

/// Returns by how much the points move, at most: each of them moves once, since all sides that end
/// at a spot have the same point there.
fn set_row(surface: &mut LimitSurface, side: &Side, points: &Row) -> f64 {
    let mut moved = 0.0_f64;
    for (at, point) in places(surface, side).zip(points) {
        moved = moved.max(surface.control[at].distance(*point));
        surface.control[at] = *point;
    }
    moved
}

/// The part `wanted` of a curve of `count` points over `whole`, reached by a whole number of
/// halvings.
fn part((mut part, count): (Row, usize), whole: [f64; 2], wanted: [f64; 2]) -> Row {
    let [mut from, mut to] = whole;
    while [from, to] != wanted {
        let middle = 0.5 * (from + to);
        let upper = wanted[0] >= middle;
        halve(&mut part, count, (0, 1), upper);
        if upper {
            from = middle;
        } else {
            to = middle;
        }
    }
    part
}

/// Where the unit squares of a cage lie.
struct Layout<'a> {
    topology: &'a Topology,
    /// The corner of the cage at (0, 0) of each unit square, and whether the square is a whole
    /// quad.
    units: Vec<(u32, bool)>,
}

impl<'a> Layout<'a> {
    fn new(topology: &'a Topology) -> Self {
        let mut units = Vec::new();
        for face in 0..topology.face_count() {
            let range = topology.face_range(face);
            let quad = range.len() == 4;
            let count = if quad { 1 } else { range.len() };
            units.extend(range.take(count).map(|corner| (corner as u32, quad)));
        }
        Self { topology, units }
    }

    /// The side with a number: see [`SideNumber`].
    fn side(&self, surface: &LimitSurface, number: SideNumber) -> Side {
        let (patch, which) = (number as usize / 4, RectSide::ALL[number as usize % 4]);
        let LimitPatch { rect, exact, .. } = surface.patches[patch];
        let (fixed, along, ranges) = (which.fixed(), which.along(), rect.ranges());
        let value = which.value_in(&ranges);
        let (line, reversed, [a, b]) = self.line(rect.unit, (fixed, value), ranges[along]);
        let (from, to) = if reversed { (b, a) } else { (a, b) };
        let scale = if self.units[rect.unit].1 { 1.0 } else { 0.5 };
        let length = scale * rect.size[along];
        let between_strips = !rect.square().ranges()[fixed].contains(&value);
        let rank = if between_strips { scale * rect.size[fixed] } else { length };
        Side { line, from, to, reversed, length, rank, exact, patch, which }
    }

    /// The line of a unit square on which a parameter has this value, whether it runs against the
    /// other parameter, and where two values of the other parameter lie on it.
    fn line(
        &self,
        unit: usize,
        (fixed, value): (Direction, f64),
        at: [f64; 2],
    ) -> (Line, bool, [f64; 2]) {
        if value > 0.0 && value < 1.0 {
            let inside = Line::Inside { unit: unit as u32, fixed, at: value.to_bits() };
            return (inside, false, at);
        }
        let (corner, quad) = self.units[unit];
        let [first, last] = RectSide::ends_of(fixed);
        let side = if value == 0.0 { first } else { last };
        // The half-edge, which share of it one side of the unit square is, and whether it runs
        // backwards.
        let previous = || self.topology.previous(corner);
        let (half, share, backward) = match (side, quad) {
            (RectSide::FirstV, true) => (corner, 1.0, false),
            (RectSide::LastU, true) => (corner + 1, 1.0, false),
            (RectSide::LastV, true) => (corner + 2, 1.0, true),
            (RectSide::FirstU, true) => (corner + 3, 1.0, true),
            (RectSide::FirstV, false) => (corner, 0.5, false),
            (RectSide::FirstU, false) => (previous(), 0.5, true),
            (RectSide::LastU, false) => return (Line::Spoke(corner), false, at),
            (RectSide::LastV, false) => return (Line::Spoke(previous()), false, at),
        };
        let edge = self.topology.edge(half);
        let twin = self.topology.edge_corner(edge as usize) != half;
        let turn = |t: f64| if backward { 1.0 - share * t } else { share * t };
        let at = at.map(turn).map(|t| if twin { 1.0 - t } else { t });
        (Line::Edge(edge), backward != twin, at)
    }

    /// The points at which a side begins and ends, along its line.
    fn ends(&self, surface: &LimitSurface, side: &Side) -> [Spot; 2] {
        let rect = surface.patches[side.patch].rect;
        let (which, ranges) = (side.which, rect.ranges());
        let value = which.value_in(&ranges);
        let end = |t: f64| self.spot(rect.unit, which.fixed().pair(value, t));
        let [low, high] = ranges[which.along()].map(end);
        if side.reversed { [high, low] } else { [low, high] }
    }

    fn spot(&self, unit: usize, [x, y]: [f64; 2]) -> Spot {
        let outer = |t: f64| t == 0.0 || t == 1.0;
        let (line, _, [t, _]) = match (outer(x), outer(y)) {
            (false, false) => return Spot::Inside(unit, [x, y].map(f64::to_bits)),
            (true, _) => self.line(unit, (Direction::U, x), [y; 2]),
            (false, true) => self.line(unit, (Direction::V, y), [x; 2]),
        };
        let topology = self.topology;
        match line {
            Line::Edge(edge) => {
                let [start, end] = topology.edge_ends(topology.edge_corner(edge as usize));
                match t {
                    0.0 => Spot::Vertex(start),
                    1.0 => Spot::Vertex(end),
                    _ => Spot::Edge(edge, t.to_bits()),
                }
            }
            Line::Spoke(corner) => match t {
                0.0 => Spot::Edge(topology.edge(corner), 0.5_f64.to_bits()),
                1.0 => Spot::Middle(topology.face_of(corner)),
                _ => Spot::Spoke(corner, t.to_bits()),
            },
            Line::Inside { .. } => Spot::Inside(unit, [x, y].map(f64::to_bits)),
        }
    }
}
