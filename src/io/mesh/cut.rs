//! The part of a piece that trims keep: cells kept whole as grids, cut cells as triangles.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec2;

use super::cell::regions;
use super::grid_mesh::{GridMesh, MAX_GRID_SIDE, MeshError};
use super::lattice::Lattice;
use super::piece::Piece;
use crate::geometry::trim::{Side, Trims, UvBox};

/// The share of the tolerance that is spent on finding points of trim curves; the rest is spent on
/// leaving out as many of them as possible.
const FINE: f64 = 0.125;

/// Points nearer to a side of a cell than this share of the cell lie on it: as much as triangles of
/// a cell resolve.
const ON_SIDE: f64 = 1e-9;

/// The most points of a curve that one chord stands for: the work for each point is bounded by this.
const MOST_LEFT_OUT: usize = 512;

/// Trim curves as chords, and the cells of a piece that they cut.
pub(super) struct Cutter<'a> {
    piece: &'a Piece,
    trims: &'a Trims,
    lattice: &'a Lattice,
    /// The chords in each cell that has any, sides included. A chord that only touches a side is
    /// a point.
    chords: HashMap<(usize, usize), Vec<[DVec2; 2]>>,
}

impl<'a> Cutter<'a> {
    /// Enters `outlines`, the trim curves as chords, in the cells of a piece that they meet.
    pub(super) fn new(
        piece: &'a Piece,
        trims: &'a Trims,
        lattice: &'a Lattice,
        outlines: &[Vec<DVec2>],
    ) -> Self {
        let mut cutter = Self { piece, trims, lattice, chords: HashMap::new() };
        let (us, vs) = (&lattice.us, &lattice.vs);
        let domain = UvBox::new([us[0], us[us.len() - 1]], [vs[0], vs[vs.len() - 1]]);
        let domain = domain.grown(ON_SIDE * domain.size());
        for ends in outlines.iter().flat_map(|outline| outline.windows(2)) {
            if UvBox::around(ends.iter().copied()).meets(&domain) {
                let snapped = |at: DVec2| DVec2::new(on_side(at.x, us), on_side(at.y, vs));
                cutter.enter([snapped(ends[0]), snapped(ends[1])]);
            }
        }
        cutter
    }

    /// Enters a chord in the cells that it meets. Where it crosses a side, both cells there get the
    /// same point, bit for bit.
    fn enter(&mut self, [a, b]: [DVec2; 2]) {
        let (us, vs) = (&self.lattice.us, &self.lattice.vs);
        let [low, high] = if a.y <= b.y { [a, b] } else { [b, a] };
        let (left, right) = (low.x.min(high.x), low.x.max(high.x));
        let at_v = |v: f64| {
            let share = (v - low.y) / (high.y - low.y);
            let u = (low.x + share * (high.x - low.x)).clamp(left, right);
            DVec2::new(on_side(u, us), v)
        };
        let at_u = |u: f64| {
            let share = (u - low.x) / (high.x - low.x);
            let v = (low.y + share * (high.y - low.y)).clamp(low.y, high.y);
            DVec2::new(u, on_side(v, vs))
        };
        for j in met(low.y, high.y, vs) {
            let bottom = if low.y < vs[j] { at_v(vs[j]) } else { low };
            let top = if high.y > vs[j + 1] { at_v(vs[j + 1]) } else { high };
            let ends = if bottom.x <= top.x { [bottom, top] } else { [top, bottom] };
            for i in met(ends[0].x, ends[1].x, us) {
                let from = if ends[0].x < us[i] { at_u(us[i]) } else { ends[0] };
                let to = if ends[1].x > us[i + 1] { at_u(us[i + 1]) } else { ends[1] };
                // By rounding, a crossing near a corner may lie beyond the other side.
                let inside = |at: DVec2| DVec2::new(at.x, at.y.clamp(vs[j], vs[j + 1]));
                let chord = [inside(from), inside(to)];
                let cell = self.lattice.cell(i, j);
                if chord[0] != chord[1] || !is_corner(&cell, chord[0]) {
                    self.chords.entry((i, j)).or_default().push(chord);
                }
            }
        }
    }

    /// Adds the kept part of all cells: whole cells in grids as large as possible, and the
    /// triangles of the others.
    ///
    /// # Errors
    /// When the mesh becomes too large.
    pub(super) fn carry_out(&self, mesh: &mut GridMesh) -> Result<(), MeshError> {
        let mut whole = self.whole();
        let columns = self.lattice.vs.len() - 1;
        let rows = self.lattice.us.len() - 1;
        let most = MAX_GRID_SIDE - 1;
        for i in 0..rows {
            for j in 0..columns {
                let row = |i: usize| &whole[i * columns..(i + 1) * columns];
                let width = row(i)[j..].iter().take(most).take_while(|&&whole| whole).count();
                if width == 0 {
                    continue;
                }
                let filled = |&i: &usize| row(i)[j..j + width].iter().all(|&whole| whole);
                let height = (i..rows).take(most).take_while(filled).count();
                for i in i..i + height {
                    whole[i * columns + j..][..width].fill(false);
                }
                mesh.push_lattice(self.lattice, [i..i + height, j..j + width])?;
            }
        }
        let mut cut: Vec<_> =
            self.chords.iter().filter(|(at, chords)| self.cuts(**at, chords)).collect();
        cut.sort_unstable_by_key(|(at, _)| **at);
        let mut known = HashMap::new();
        cut.into_iter().try_for_each(|(&at, chords)| self.push_cut(at, chords, &mut known, mesh))
    }

    /// Whether chords divide a cell or add points to its sides: not if they are whole sides.
    fn cuts(&self, (i, j): (usize, usize), chords: &[[DVec2; 2]]) -> bool {
        let cell = self.lattice.cell(i, j);
        let is_side = |[a, b]: &[DVec2; 2]| {
            is_corner(&cell, *a) && is_corner(&cell, *b) && (a.x == b.x || a.y == b.y)
        };
        !chords.iter().all(is_side)
    }

    /// Which cells are kept as they are, row by row. Between neighbours without chords nothing
    /// changes, so the largest of them decides for all: the middle of one that is narrower than
    /// chords are exact may lie on the other side of a curve.
    fn whole(&self) -> Vec<bool> {
        let (rows, columns) = (self.lattice.us.len() - 1, self.lattice.vs.len() - 1);
        let mut whole = vec![false; rows * columns];
        let mut is_done = vec![false; rows * columns];
        for (&(i, j), chords) in &self.chords {
            is_done[i * columns + j] = true;
            whole[i * columns + j] = !self.cuts((i, j), chords) && self.keeps_middle(i, j);
        }
        for first in 0..rows * columns {
            let (mut plain, mut looked_at) = (Vec::new(), 0);
            let mut add = |cell: usize, plain: &mut Vec<usize>| {
                if !std::mem::replace(&mut is_done[cell], true) {
                    plain.push(cell);
                }
            };
            add(first, &mut plain);
            while let Some(&cell) = plain.get(looked_at) {
                looked_at += 1;
                let (i, j) = (cell / columns, cell % columns);
                let beside = [
                    (i > 0).then(|| cell - columns),
                    (i + 1 < rows).then(|| cell + columns),
                    (j > 0).then(|| cell - 1),
                    (j + 1 < columns).then(|| cell + 1),
                ];
                beside.into_iter().flatten().for_each(|cell| add(cell, &mut plain));
            }
            let area = |cell: usize| {
                let size = self.lattice.cell(cell / columns, cell % columns).size();
                size.x * size.y
            };
            let largest = plain.iter().copied().max_by(|a, b| area(*a).total_cmp(&area(*b)));
            let kept =
                largest.is_some_and(|cell| self.keeps_middle(cell / columns, cell % columns));
            plain.into_iter().for_each(|cell| whole[cell] = kept);
        }
        whole
    }

    fn keeps_middle(&self, i: usize, j: usize) -> bool {
        self.keeps(self.lattice.cell(i, j).center())
    }

    fn keeps(&self, uv: DVec2) -> bool {
        match self.trims.side_of(uv) {
            Side::Inside => true,
            Side::Outside => false,
            Side::Edge { inside, .. } => inside,
        }
    }

    /// Adds the triangles of the kept part of a cut cell. What lies between chords is kept or not as
    /// a whole, as the middle of its largest triangle is.
    fn push_cut(
        &self,
        at: (usize, usize),
        chords: &[[DVec2; 2]],
        known: &mut HashMap<[u64; 2], u32>,
        mesh: &mut GridMesh,
    ) -> Result<(), MeshError> {
        let regions = regions(&self.lattice.cell(at.0, at.1), chords);
        for region in regions.iter().filter(|region| self.keeps(region.middle)) {
            for triangle in &region.triangles {
                let mut corners = [0; 3];
                for (corner, uv) in corners.iter_mut().zip(triangle) {
                    *corner = self.vertex(at, *uv, known, mesh)?;
                }
                mesh.push_face(corners);
            }
        }
        Ok(())
    }

    /// The number of the vertex at `uv` in a cell. On the cell's sides its position is on the
    /// straight line between two vertices, which the neighbouring cell has, too.
    fn vertex(
        &self,
        (i, j): (usize, usize),
        uv: DVec2,
        known: &mut HashMap<[u64; 2], u32>,
        mesh: &mut GridMesh,
    ) -> Result<u32, MeshError> {
        let key = (uv + 0.0).to_array().map(f64::to_bits);
        if let Some(&number) = known.get(&key) {
            return Ok(number);
        }
        let UvBox { min, max } = self.lattice.cell(i, j);
        let at = (uv - min) / (max - min);
        let corner = |k: usize, l: usize| self.lattice.position(i + k, j + l);
        let between = |from: [usize; 2], to: [usize; 2], share: f64| {
            let [a, b] = [from, to].map(|[k, l]| corner(k, l));
            if share == 1.0 { b } else { a + share * (b - a) }
        };
        let position = if uv.x == min.x {
            between([0, 0], [0, 1], at.y)
        } else if uv.x == max.x {
            between([1, 0], [1, 1], at.y)
        } else if uv.y == min.y {
            between([0, 0], [1, 0], at.x)
        } else if uv.y == max.y {
            between([0, 1], [1, 1], at.x)
        } else {
            self.piece.position(uv)
        };
        let number = mesh.push_vertex(position, || self.piece.detail(uv))?;
        known.insert(key, number);
        Ok(number)
    }
}

/// The cells that the numbers from `low` to `high` meet, between neighbouring `sides`.
fn met(low: f64, high: f64, sides: &[f64]) -> Range<usize> {
    let first = sides.partition_point(|&side| side < low).saturating_sub(1);
    first..sides.partition_point(|&side| side <= high).min(sides.len() - 1)
}

/// The parameter, or that of a side of a cell that is as good as the same.
fn on_side(t: f64, sides: &[f64]) -> f64 {
    let next = sides.partition_point(|&side| side < t).clamp(1, sides.len() - 1);
    let (before, after) = (sides[next - 1], sides[next]);
    let near = ON_SIDE * (after - before);
    if (t - before).abs() <= near {
        before
    } else if (after - t).abs() <= near {
        after
    } else {
        t
    }
}

fn is_corner(cell: &UvBox, at: DVec2) -> bool {
    (at.x == cell.min.x || at.x == cell.max.x) && (at.y == cell.min.y || at.y == cell.max.y)
}

/// The trim curves of a surface as chords within `distance` of them in space, where steps of 1 in u
/// and in v are no longer than `speeds`, taken as at right angles.
///
/// # Errors
/// When that takes too many points.
pub(super) fn outlines(
    trims: &Trims,
    distance: f64,
    speeds: DVec2,
) -> Result<Vec<Vec<DVec2>>, MeshError> {
    let speeds = speeds.max(DVec2::splat(f64::MIN_POSITIVE));
    let fine = trims.outlines(FINE * distance / speeds.max_element())?;
    Ok(fine.iter().map(|outline| thinned(outline, (1.0 - FINE) * distance, speeds)).collect())
}

/// As few of the points of a polyline as leave the others within `distance` of the chords between
/// them, where steps of 1 in u and v are as long as `speeds`. The first and last remain.
fn thinned(points: &[DVec2], distance: f64, speeds: DVec2) -> Vec<DVec2> {
    let off = |point: DVec2, [from, to]: [DVec2; 2]| {
        let [chord, point] = [to - from, point - from].map(|step| speeds * step);
        let share = (point.dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
        if share.is_nan() { point.length() } else { point.distance(share * chord) }
    };
    let mut kept: Vec<DVec2> = points.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < points.len() {
        let near = |&to: &usize| {
            let ends = [points[from], points[to]];
            points[from + 1..to].iter().all(|&point| off(point, ends) <= distance)
        };
        let end = points.len().min(from + MOST_LEFT_OUT);
        from = (from + 2..end).take_while(near).last().unwrap_or(from + 1);
        kept.push(points[from]);
    }
    kept
}
