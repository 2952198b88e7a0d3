//! The cells of a piece that trims keep, as grids: whole cells, and the kept part of cut cells as
//! trapezoids.

use glam::{DVec2, DVec3};

use super::grid_mesh::{GridMesh, MeshError, MeshPoint};
use super::piece::Piece;
use crate::geometry::trim::{Coverage, Side, Trims, UvBox};

/// Trim curves as chords, and the cells of a piece that they cut.
pub(super) struct Cutter<'a> {
    piece: &'a Piece,
    trims: &'a Trims,
    us: &'a [f64],
    vs: &'a [f64],
    /// The vertices of all cells, row by row.
    vertices: &'a [MeshPoint],
    /// The chords that come near each interval of `vs`, the end with the smaller v first.
    chords: Vec<Vec<[DVec2; 2]>>,
}

/// A side of a trapezoid: u as a linear function of v.
#[derive(Clone, Copy)]
struct Edge {
    from: DVec2,
    to: DVec2,
}

impl Edge {
    fn at(&self, v: f64) -> f64 {
        let share = (v - self.from.y) / (self.to.y - self.from.y);
        self.from.x + share * (self.to.x - self.from.x)
    }
}

impl<'a> Cutter<'a> {
    /// Makes chords within `tolerance` of the trim curves, in units of u and v.
    ///
    /// # Errors
    /// When that takes too many points.
    pub(super) fn new(
        piece: &'a Piece,
        trims: &'a Trims,
        (us, vs, vertices): (&'a [f64], &'a [f64], &'a [MeshPoint]),
        tolerance: f64,
    ) -> Result<Self, MeshError> {
        let mut chords = vec![Vec::new(); vs.len().saturating_sub(1)];
        for outline in trims.outlines(tolerance)? {
            for ends in outline.windows(2) {
                let (low, high) =
                    if ends[0].y <= ends[1].y { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
                let first = vs.partition_point(|&v| v < low.y).saturating_sub(1);
                let meeting = vs.partition_point(|&v| v <= high.y).min(chords.len());
                for near in chords.iter_mut().take(meeting).skip(first) {
                    near.push([low, high]);
                }
            }
        }
        Ok(Self { piece, trims, us, vs, vertices, chords })
    }

    /// Adds the kept part of the cells `rows` × `columns`: each run of whole cells along v as one
    /// grid, each trapezoid of a cut cell as a grid of four vertices.
    ///
    /// # Errors
    /// When the mesh becomes too large.
    pub(super) fn carry_out(
        &self,
        rows: std::ops::Range<usize>,
        columns: std::ops::Range<usize>,
        mesh: &mut GridMesh,
    ) -> Result<(), MeshError> {
        for i in rows {
            let mut whole = columns.start;
            for j in columns.clone() {
                let coverage = self.trims.classify(&self.cell(i, j));
                if coverage == Coverage::Inside {
                    continue;
                }
                self.push_whole(i, whole..j, mesh)?;
                whole = j + 1;
                if coverage == Coverage::Mixed {
                    self.push_trapezoids(i, j, mesh)?;
                }
            }
            self.push_whole(i, whole..columns.end, mesh)?;
        }
        Ok(())
    }

    fn cell(&self, i: usize, j: usize) -> UvBox {
        UvBox::new([self.us[i], self.us[i + 1]], [self.vs[j], self.vs[j + 1]])
    }

    fn vertex(&self, i: usize, j: usize) -> MeshPoint {
        self.vertices[i * self.vs.len() + j]
    }

    fn push_whole(
        &self,
        i: usize,
        columns: std::ops::Range<usize>,
        mesh: &mut GridMesh,
    ) -> Result<(), MeshError> {
        if columns.is_empty() {
            return Ok(());
        }
        let first = columns.start;
        mesh.push_grid((2, columns.len() + 1), |row, column| self.vertex(i + row, first + column))
    }

    /// Adds the kept part of a cell. The cell is cut into strips at the v of every end of a chord
    /// and of every crossing of a chord with the cell's sides: each chord then crosses a whole
    /// strip or none of it, and chords do not cross each other.
    fn push_trapezoids(&self, i: usize, j: usize, mesh: &mut GridMesh) -> Result<(), MeshError> {
        let UvBox { min, max } = self.cell(i, j);
        let mut near: Vec<Edge> = self.chords[j]
            .iter()
            .filter(|[a, b]| a.x.min(b.x) < max.x && a.x.max(b.x) > min.x)
            .map(|&[from, to]| Edge { from, to })
            .collect();
        let mut levels = vec![min.y, max.y];
        levels.extend(near.iter().flat_map(|edge| [edge.from.y, edge.to.y]));
        // Chords along u end strips, but are not sides of any trapezoid.
        near.retain(|edge| edge.from.y < edge.to.y);
        for edge in &near {
            for side in [min.x, max.x] {
                let share = (side - edge.from.x) / (edge.to.x - edge.from.x);
                levels.push(edge.from.y + share * (edge.to.y - edge.from.y));
            }
        }
        levels.retain(|v| min.y <= *v && *v <= max.y); // drops NaN, too
        levels.sort_by(f64::total_cmp);
        levels.dedup();

        for strip in levels.windows(2) {
            let [low, high] = [strip[0], strip[1]];
            let middle = 0.5 * (low + high);
            let side = |u: f64| Edge { from: DVec2::new(u, low), to: DVec2::new(u, high) };
            let mut edges = vec![side(min.x), side(max.x)];
            edges.extend(near.iter().filter(|edge| {
                let across = edge.from.y <= low && high <= edge.to.y;
                let u = edge.at(middle);
                across && min.x < u && u < max.x
            }));
            edges.sort_by(|a, b| a.at(middle).total_cmp(&b.at(middle)));
            for pair in edges.windows(2) {
                let [left, right] = [pair[0], pair[1]];
                let inside = DVec2::new(0.5 * (left.at(middle) + right.at(middle)), middle);
                if self.trims.contains(inside) == Side::Outside {
                    continue;
                }
                mesh.push_grid((2, 2), |row, column| {
                    let v = if column == 0 { low } else { high };
                    let u = if row == 0 { left.at(v) } else { right.at(v) };
                    self.point((i, j), DVec2::new(u.clamp(min.x, max.x), v))
                })?;
            }
        }
        Ok(())
    }

    /// The point of the surface at `uv` in a cell. On the cell's sides its position is on the
    /// straight line between two vertices, which the neighbouring cell has, too.
    fn point(&self, (i, j): (usize, usize), uv: DVec2) -> MeshPoint {
        let UvBox { min, max } = self.cell(i, j);
        let at = (uv - min) / (max - min);
        let corner = |i: usize, j: usize| self.vertex(i, j).position;
        let between = |a: DVec3, b: DVec3, share: f64| {
            if share == 1.0 { b } else { a + share * (b - a) }
        };
        let on_side = if uv.x == min.x {
            Some(between(corner(i, j), corner(i, j + 1), at.y))
        } else if uv.x == max.x {
            Some(between(corner(i + 1, j), corner(i + 1, j + 1), at.y))
        } else if uv.y == min.y {
            Some(between(corner(i, j), corner(i + 1, j), at.x))
        } else if uv.y == max.y {
            Some(between(corner(i, j + 1), corner(i + 1, j + 1), at.x))
        } else {
            None
        };
        let point = self.piece.point(uv);
        MeshPoint { position: on_side.unwrap_or(point.position), ..point }
    }
}
