//! Counts of cells for one chart: estimated, measured, refined, carried out.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::cut::{Cutter, outlines};
use super::grid_mesh::{GridMesh, MAX_GRID_SIDE, MeshError};
use super::lattice::Lattice;
use super::piece::{Piece, Row, Tangents};
use crate::geometry::trim::{Side, UvBox};
use crate::geometry::{BasisDerivatives, Chart, Direction, Span};

/// Points to measure on one chart, unless [`MIN_PROBES`] asks for more: about 10 ms of work.
const SAMPLE_BUDGET: usize = 1 << 17;

/// Cells measured along each side of a knot span, at least and at most. Odd, so that besides
/// the first and the last the middle one is among them: by symmetry the worst is often there.
const MIN_PROBES: usize = 3;
const MAX_PROBES: usize = 9;

/// Fractions at which each side of a cell is sampled: corners, middles, and the thirds at which
/// the centroids of its two triangles lie.
const FRACTIONS: [f64; 5] = [0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0];

/// A direction counts as a cause of a deviation if it contributes this share of it.
const SHARE: f64 = 0.1;

/// A chart and the number of cells for each of its knot spans along u and along v.
///
/// Its pieces share these counts: neighbours then have the same vertices on their common border.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// The smooth pieces: strips of equal u one after another, each from low v to high v.
    pieces: Vec<Piece>,
    /// In each direction, the number of the first span of each row of pieces, and of all spans.
    starts: [Vec<usize>; 2],
    spans: [Vec<Span>; 2],
    counts: [Vec<usize>; 2],
}

/// Largest distances between a chart and the triangles of its plan.
#[derive(Clone, Debug)]
pub(super) struct Deviations {
    /// Along edges that run in u, and in v, for each span in that direction.
    along: [Vec<f64>; 2],
    /// Anywhere, for each pair of spans, v fastest.
    total: Vec<f64>,
}

impl Deviations {
    pub(super) fn worst(&self) -> f64 {
        self.total.iter().copied().fold(0.0, f64::max)
    }
}

impl Plan {
    /// A plan with `cells(degree)` cells for every span.
    ///
    /// # Errors
    /// When the chart cannot be cut into pieces.
    pub(super) fn new(chart: Chart<'_>, cells: impl Fn(usize) -> usize) -> Result<Self, MeshError> {
        let count = Direction::BOTH.map(|d| cells(chart.surface.knots(d).degree()).max(1));
        let (pieces, columns) = Piece::all(chart)?;
        let (mut starts, mut spans) = ([vec![0], vec![0]], [Vec::new(), Vec::new()]);
        let firsts =
            [pieces.iter().step_by(columns).collect(), pieces.iter().take(columns).collect()];
        for (direction, firsts) in Direction::BOTH.into_iter().zip::<[Vec<&Piece>; 2]>(firsts) {
            for piece in firsts {
                spans[direction].extend(piece.knots(direction).spans());
                starts[direction].push(spans[direction].len());
            }
        }
        let counts = [vec![count[0]; spans[0].len()], vec![count[1]; spans[1].len()]];
        Ok(Self { pieces, starts, spans, counts })
    }

    /// The pieces, each with the numbers of its spans along u and along v.
    fn parts(&self) -> impl Iterator<Item = (&Piece, [Range<usize>; 2])> {
        let [rows, columns] = self
            .starts
            .each_ref()
            .map(|starts| starts.windows(2).map(|ends| ends[0]..ends[1]).collect::<Vec<_>>());
        let width = columns.len();
        let ranges = move |k: usize| [rows[k / width].clone(), columns[k % width].clone()];
        self.pieces.iter().enumerate().map(move |(k, piece)| (piece, ranges(k)))
    }

    /// Sets the counts from the deviation with the present ones; it falls with their square.
    ///
    /// Equal shares for both directions give the fewest cells, unless one direction is
    /// (nearly) straight: then the other may have the rest.
    pub(super) fn estimate(&mut self, distance: f64) {
        let measured = self.measure().along;
        let old = self.counts.clone();
        let needed = |direction: Direction, allowed: f64| -> Vec<usize> {
            let spans = measured[direction].iter().zip(&old[direction]);
            spans.map(|(&deviation, &count)| scaled(count, deviation / allowed)).collect()
        };
        let left = |direction: Direction, counts: &[usize]| -> f64 {
            let spans = measured[direction].iter().zip(&old[direction]).zip(counts);
            let used = spans
                .map(|((&deviation, &old), &new)| deviation * (old as f64 / new as f64).powi(2));
            (distance - used.fold(0.0, f64::max)).max(0.5 * distance)
        };
        let first_v = needed(Direction::V, 0.5 * distance);
        self.counts[0] = needed(Direction::U, left(Direction::V, &first_v));
        self.counts[1] = needed(Direction::V, left(Direction::U, &self.counts[0]));
    }

    /// Raises the counts where the deviation exceeds `distance`; returns whether it did
    /// anywhere.
    pub(super) fn refine(&mut self, distance: f64) -> bool {
        let measured = self.measure();
        let columns = self.spans[1].len();
        let mut growth = self.counts.clone().map(|counts| vec![1.0_f64; counts.len()]);
        for (at, &total) in measured.total.iter().enumerate() {
            if total <= distance {
                continue;
            }
            let place = [at / columns, at % columns];
            let causes = Direction::BOTH.map(|d| measured.along[d][place[d]] > SHARE * total);
            for direction in Direction::BOTH {
                if causes[direction] || causes == [false; 2] {
                    let grown = &mut growth[direction][place[direction]];
                    *grown = grown.max(total / distance);
                }
            }
        }
        for (counts, growth) in self.counts.iter_mut().zip(&growth) {
            for (count, &growth) in counts.iter_mut().zip(growth) {
                if growth > 1.0 {
                    *count = scaled(*count, growth).max(*count + 1);
                }
            }
        }
        measured.worst() > distance
    }

    /// The number of vertices that the plan makes without trims; those on a border between knot
    /// spans count in each.
    pub(super) fn vertex_count(&self) -> usize {
        let [rows, columns] = Direction::BOTH.map(|direction| {
            self.counts[direction].iter().fold(0, |sum: usize, n| sum.saturating_add(n + 1))
        });
        rows.saturating_mul(columns)
    }

    /// Adds the grids and triangles of the plan to a mesh. Trim curves become chords within
    /// `distance` of them in space, judged by how far the surface is stretched at the points
    /// sampled.
    pub(super) fn carry_out(&self, distance: f64, mesh: &mut GridMesh) -> Result<(), MeshError> {
        let too_many = |counts: &Vec<usize>| counts.iter().any(|&n| n + 1 > MAX_GRID_SIDE);
        if self.counts.iter().any(too_many) {
            let most = |counts: &[usize]| counts.iter().max().map_or(0, |&n| n + 1);
            let (rows, columns) = (most(&self.counts[0]), most(&self.counts[1]));
            return Err(MeshError::GridSides { rows, columns });
        }
        // All pieces have the trims of the chart.
        let outlines = match self.pieces.iter().find_map(|piece| piece.trims.as_ref()) {
            Some(trims) => {
                let speeds = self.pieces.iter().map(speeds).fold(DVec2::ZERO, DVec2::max);
                outlines(trims, distance, speeds)?
            }
            None => Vec::new(),
        };
        self.parts().try_for_each(|(piece, spans)| {
            let [us, vs] = self.parameters(&spans);
            let lattice = piece.lattice(us, vs, mesh.is_detailed());
            match &piece.trims {
                Some(trims) => Cutter::new(piece, trims, &lattice, &outlines).carry_out(mesh),
                None => {
                    let counts = Direction::BOTH.map(|d| &self.counts[d][spans[d].clone()]);
                    push_spans(&lattice, counts, mesh)
                }
            }
        })
    }

    /// All parameters of vertices on some spans in each direction.
    fn parameters(&self, spans: &[Range<usize>; 2]) -> [Vec<f64>; 2] {
        Direction::BOTH.map(|direction| {
            let range = spans[direction].clone();
            let spans = &self.spans[direction][range.clone()];
            let mut parameters = Vec::new();
            for (span, &count) in spans.iter().zip(&self.counts[direction][range]) {
                parameters.extend((0..count).map(|k| at(span, k as f64 / count as f64)));
            }
            parameters.extend(spans.last().map(|span| span.end));
            parameters
        })
    }

    /// The smallest and largest coordinates of the vertices that are kept, and of the ends of
    /// trim edges.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.parts().fold(nothing, |bounds, (piece, spans)| {
            let [us, vs] = self.parameters(&spans);
            let Lattice { us, vs, mut positions, .. } = piece.lattice(us, vs, false);
            if let Some(trims) = &piece.trims {
                let places = us.iter().flat_map(|&u| vs.iter().map(move |&v| DVec2::new(u, v)));
                let mut kept = places.map(|uv| trims.side_of(uv) != Side::Outside);
                positions.retain(|_| kept.next() == Some(true));
                let domain = UvBox::new([us[0], us[us.len() - 1]], [vs[0], vs[vs.len() - 1]]);
                let joints = trims.joints().filter(|joint| domain.holds(*joint));
                positions.extend(joints.map(|joint| piece.position(joint)));
            }
            positions.iter().fold(bounds, |(low, high), &at| (low.min(at), high.max(at)))
        })
    }

    /// How far the surface lies from its triangles, as sampled.
    pub(super) fn measure(&self) -> Deviations {
        let [rows, columns] = self.spans.each_ref().map(Vec::len);
        let share = SAMPLE_BUDGET / (FRACTIONS.len().pow(2) * rows * columns);
        let probes = (share.isqrt() | 1).clamp(MIN_PROBES, MAX_PROBES);
        let mut found = Deviations {
            along: [vec![0.0; rows], vec![0.0; columns]],
            total: vec![0.0; rows * columns],
        };
        for (piece, [rows, columns]) in self.parts() {
            self.measure_one(piece, [rows, columns], probes, &mut found);
        }
        found
    }

    /// Adds the deviations of one piece.
    fn measure_one(
        &self,
        piece: &Piece,
        spans: [Range<usize>; 2],
        probes: usize,
        found: &mut Deviations,
    ) {
        let columns = self.spans[1].len();
        let [spans_u, spans_v] = spans;
        let cells_v = self.cells(piece, Direction::V, spans_v, probes);
        for cell_u in self.cells(piece, Direction::U, spans_u, probes) {
            let sampled = cell_u.basis.each_ref().map(|basis| piece.row(basis));
            for cell_v in &cells_v {
                let cell = Cell::new(piece, [&cell_u, cell_v], &sampled);
                let (along_u, along_v, inside) = cell.deviations();
                let grow = |found: &mut f64, value: f64| *found = found.max(value);
                grow(&mut found.along[0][cell_u.span], along_u);
                grow(&mut found.along[1][cell_v.span], along_v);
                let total = &mut found.total[cell_u.span * columns + cell_v.span];
                grow(total, along_u.max(along_v).max(inside));
            }
        }
    }

    /// Cells of a piece to measure along one direction, at most `probes` a span.
    fn cells(
        &self,
        piece: &Piece,
        direction: Direction,
        spans: Range<usize>,
        probes: usize,
    ) -> Vec<CellSide> {
        let knots = piece.knots(direction);
        let [start, end] = knots.domain();
        let mut sides = Vec::new();
        for number in spans {
            let span = &self.spans[direction][number];
            let count = self.counts[direction][number];
            let taken = probes.min(count);
            for k in 0..taken {
                // First and last cell, and evenly between.
                let index = if taken == 1 { 0 } else { k * (count - 1) / (taken - 1) };
                let parameter = |f: f64| at(span, (index as f64 + f) / count as f64);
                sides.push(CellSide {
                    span: number,
                    ends_piece: [parameter(0.0) <= start, parameter(1.0) >= end],
                    basis: FRACTIONS.map(|f| knots.basis_derivatives(parameter(f))),
                });
            }
        }
        sides
    }
}

/// Adds all vertices of a piece, a grid for each knot span, which have these numbers of cells.
fn push_spans(
    lattice: &Lattice,
    [rows, columns]: [&[usize]; 2],
    mesh: &mut GridMesh,
) -> Result<(), MeshError> {
    let mut top = 0;
    for &height in rows {
        let mut left = 0;
        for &width in columns {
            mesh.push_lattice(lattice, [top..top + height, left..left + width])?;
            left += width;
        }
        top += height;
    }
    Ok(())
}

/// The largest sampled speeds of a piece: the lengths in space of a step of 1 in u, and in v.
fn speeds(piece: &Piece) -> DVec2 {
    let samples = Direction::BOTH.map(|direction| {
        let knots = piece.knots(direction);
        let spans = knots.spans().collect::<Vec<_>>();
        let at = spans.iter().flat_map(|span| FRACTIONS.map(|share| at(span, share)));
        at.map(|t| knots.basis_derivatives(t)).collect::<Vec<_>>()
    });
    let mut largest = DVec2::ZERO;
    for basis in &samples[0] {
        let row = piece.row(basis);
        for basis in &samples[1] {
            let Tangents { du, dv, .. } = piece.tangents(&row, basis);
            largest = largest.max(DVec2::new(du.length(), dv.length()));
        }
    }
    largest
}

/// One side of a cell: its span, whether its ends are ends of the piece, and the basis
/// functions at [`FRACTIONS`].
struct CellSide {
    span: usize,
    ends_piece: [bool; 2],
    basis: [BasisDerivatives; 5],
}

/// One cell, cut as [`GridMesh`] cuts it: `a` lowest, `b` next in u, `c` next in v.
struct Cell<'a> {
    piece: &'a Piece,
    sides: [&'a CellSide; 2],
    rows: &'a [Row; 5],
    corners: [DVec3; 4],
}

impl<'a> Cell<'a> {
    fn new(piece: &'a Piece, sides: [&'a CellSide; 2], rows: &'a [Row; 5]) -> Self {
        let corner = |i: usize, j: usize| piece.tangents(&rows[i], &sides[1].basis[j]).point;
        let corners = [corner(0, 0), corner(4, 0), corner(0, 4), corner(4, 4)];
        Self { piece, sides, rows, corners }
    }

    fn at(&self, i: usize, j: usize) -> Tangents {
        self.piece.tangents(&self.rows[i], &self.sides[1].basis[j])
    }

    /// The deviations along edges in u, along edges in v, and elsewhere.
    fn deviations(&self) -> (f64, f64, f64) {
        let [a, b, c, d] = self.corners;
        let [ends_u, ends_v] = self.sides.map(|side| side.ends_piece);
        let edge = |ends_piece: bool, i: usize, j: usize, chord: [DVec3; 2]| {
            let middle = self.at(i, j);
            if ends_piece {
                from_chord(middle.point, chord)
            } else {
                along_normal(middle, 0.5 * (chord[0] + chord[1]))
            }
        };
        let along_u = edge(ends_v[0], 2, 0, [a, b]).max(edge(ends_v[1], 2, 4, [c, d]));
        let along_v = edge(ends_u[0], 0, 2, [a, c]).max(edge(ends_u[1], 4, 2, [b, d]));
        let inside = along_normal(self.at(2, 2), 0.5 * (b + c))
            .max(along_normal(self.at(1, 1), (a + b + c) / 3.0))
            .max(along_normal(self.at(3, 3), (d + b + c) / 3.0));
        (along_u, along_v, inside)
    }
}

/// The distance along the normal between a point of the surface and the point of its triangle
/// with the same parameters: across the normal, points only slide on the surface.
fn along_normal(on_surface: Tangents, on_triangle: DVec3) -> f64 {
    let gap = on_surface.point - on_triangle;
    match on_surface.du.cross(on_surface.dv).try_normalize() {
        Some(normal) => gap.dot(normal).abs(),
        None => gap.length(),
    }
}

/// The distance between a point and the line through two others.
fn from_chord(point: DVec3, [from, to]: [DVec3; 2]) -> f64 {
    let gap = point - from;
    (to - from)
        .try_normalize()
        .map_or(gap.length(), |along| gap.reject_from_normalized(along).length())
}

/// The parameter a fraction of the way along a span; its ends are exact.
fn at(span: &Span, fraction: f64) -> f64 {
    if fraction >= 1.0 { span.end } else { span.start + fraction * (span.end - span.start) }
}

/// The number of cells needed instead of `count` to divide a deviation by `factor`.
/// [`MAX_GRID_SIDE`], one more than a grid can have, means: too many.
fn scaled(count: usize, factor: f64) -> usize {
    let cells = (count as f64 * factor.sqrt()).ceil();
    (cells as usize).clamp(1, MAX_GRID_SIDE)
}
