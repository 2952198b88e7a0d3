//! Grids of triangles, and triangles alone, that may carry the normals and parameters of a
//! surface.

use std::ops::Range;

use glam::{DVec2, DVec3};
use thiserror::Error;

use super::lattice::{Detail, Lattice};
use crate::geometry::SurfaceError;
use crate::geometry::trim::TrimError;

/// The most vertices along a side of a grid: Embree's documented limit.
pub const MAX_GRID_SIDE: usize = 32_767;

/// The most vertices of a mesh: 5 GB of positions, normals and parameters. 32 bits, as Embree
/// has, can number them.
pub const MAX_VERTICES: usize = 1 << 26;

/// Why a mesh cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A mesh would need more vertices than allowed.
    #[error("a mesh of {vertices} vertices is too large: at most {limit} are allowed")]
    TooManyVertices {
        /// How many there would be.
        vertices: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// A grid has fewer than 2 vertices along a side, or more than Embree allows.
    #[error("a grid of {rows} × {columns} vertices: each side needs 2 to {MAX_GRID_SIDE}")]
    GridSides {
        /// Rows of vertices.
        rows: usize,
        /// Vertices a row.
        columns: usize,
    },
    /// A surface cannot be cut at its creases.
    #[error("cutting at a crease: {0}")]
    Cut(#[from] SurfaceError),
    /// Trim curves need too many chords.
    #[error("cutting at trims: {0}")]
    Trims(#[from] TrimError),
    /// The tolerance asked for is not a positive number.
    #[error("a tolerance of {tolerance}: a positive fraction of the model's diagonal is needed")]
    Tolerance {
        /// As given.
        tolerance: f64,
    },
}

/// One vertex of a mesh, or a point between vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPoint {
    /// The place in space.
    pub position: DVec3,
    /// The unit normal `S_u × S_v` of the surface; NaN where it has none.
    pub normal: DVec3,
    /// The surface parameters.
    pub uv: DVec2,
}

/// A rectangle of vertices: rows of constant u, each row running along v.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    first: u32,
    rows: u16,
    columns: u16,
}

impl Grid {
    /// Its first vertex; the others follow row by row.
    pub fn first(&self) -> u32 {
        self.first
    }

    /// The number of rows.
    pub fn rows(&self) -> u16 {
        self.rows
    }

    /// The number of vertices of a row.
    pub fn columns(&self) -> u16 {
        self.columns
    }

    fn vertex(&self, row: u32, column: u32) -> u32 {
        self.first + row * u32::from(self.columns) + column
    }

    /// The cells, by their lowest row and column.
    fn cells(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (rows, columns) = (u32::from(self.rows) - 1, u32::from(self.columns) - 1);
        (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    }

    /// The two triangles of a cell, `[a, b, c]` and `[d, c, b]`, as Embree cuts it: `a` is its
    /// lowest corner, `b` the next along u, `c` the next along v, `d` the highest. Both are
    /// oriented as `S_u × S_v`.
    fn triangles(&self, row: u32, column: u32) -> [[u32; 3]; 2] {
        let (a, b) = (self.vertex(row, column), self.vertex(row + 1, column));
        let (c, d) = (self.vertex(row, column + 1), self.vertex(row + 1, column + 1));
        [[a, b, c], [d, c, b]]
    }
}

/// One surface as grids of triangles, with triangles alone, or faces, where trims cut it. It may
/// have the surface's own normals at the vertices.
///
/// # Invariants, kept by the functions that add to it
/// - every grid has 2 to [`MAX_GRID_SIDE`] rows and columns, and all its vertices;
/// - grids and faces have vertices of their own;
/// - there are as many normals and parameters as positions, or none; at most [`MAX_VERTICES`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GridMesh {
    /// Whether there are positions only.
    bare: bool,
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    uv: Vec<DVec2>,
    grids: Vec<Grid>,
    faces: Vec<[u32; 3]>,
}

impl GridMesh {
    /// A mesh without grids yet, with room for this many vertices: with normals and parameters, or
    /// bare.
    pub(super) fn with_room(vertices: usize, detailed: bool) -> Self {
        let details = if detailed { vertices } else { 0 };
        Self {
            bare: !detailed,
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(details),
            uv: Vec::with_capacity(details),
            grids: Vec::new(),
            faces: Vec::new(),
        }
    }

    /// Whether the vertices have normals and parameters.
    pub(super) fn is_detailed(&self) -> bool {
        !self.bare
    }

    /// Adds a grid of the cells `rows` × `columns` of a lattice, which has details if the mesh has.
    pub(super) fn push_lattice(
        &mut self,
        lattice: &Lattice,
        [rows, columns]: [Range<usize>; 2],
    ) -> Result<(), MeshError> {
        self.push_empty(rows.len() + 1, columns.len() + 1)?;
        for row in rows.start..=rows.end {
            let first = row * lattice.vs.len();
            let line = first + columns.start..first + columns.end + 1;
            self.positions.extend_from_slice(&lattice.positions[line.clone()]);
            if !self.bare {
                let details = &lattice.details[line];
                self.normals.extend(details.iter().map(|detail| detail.normal));
                self.uv.extend(details.iter().map(|detail| detail.uv));
            }
        }
        Ok(())
    }

    /// Adds a vertex for faces; returns its number.
    pub(super) fn push_vertex(
        &mut self,
        position: DVec3,
        detail: impl FnOnce() -> Detail,
    ) -> Result<u32, MeshError> {
        let number = self.positions.len();
        self.check_room(1)?;
        self.positions.push(position);
        if !self.bare {
            let Detail { normal, uv } = detail();
            self.normals.push(normal);
            self.uv.push(uv);
        }
        Ok(number as u32)
    }

    /// Adds a triangle of vertices for faces.
    pub(super) fn push_face(&mut self, corners: [u32; 3]) {
        self.faces.push(corners);
    }

    fn check_room(&self, more: usize) -> Result<(), MeshError> {
        let vertices = self.positions.len() + more;
        if vertices > MAX_VERTICES {
            return Err(MeshError::TooManyVertices { vertices, limit: MAX_VERTICES });
        }
        Ok(())
    }

    /// Adds a grid whose vertices must follow.
    fn push_empty(&mut self, rows: usize, columns: usize) -> Result<(), MeshError> {
        let sides = 2..=MAX_GRID_SIDE;
        if !sides.contains(&rows) || !sides.contains(&columns) {
            return Err(MeshError::GridSides { rows, columns });
        }
        self.check_room(rows * columns)?;
        self.grids.push(Grid {
            first: self.positions.len() as u32,
            rows: rows as u16,
            columns: columns as u16,
        });
        Ok(())
    }

    /// Adds a grid of `rows` × `columns` vertices, given row by row by `vertex(row, column)`.
    ///
    /// # Errors
    /// When a side has fewer than 2 vertices or more than [`MAX_GRID_SIDE`], or the mesh would
    /// have more than [`MAX_VERTICES`]. Nothing is added then.
    pub fn push_grid(
        &mut self,
        (rows, columns): (usize, usize),
        mut vertex: impl FnMut(usize, usize) -> MeshPoint,
    ) -> Result<(), MeshError> {
        self.push_empty(rows, columns)?;
        for row in 0..rows {
            for column in 0..columns {
                let MeshPoint { position, normal, uv } = vertex(row, column);
                self.positions.push(position);
                if !self.bare {
                    self.normals.push(normal);
                    self.uv.push(uv);
                }
            }
        }
        Ok(())
    }

    /// The vertices' places.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The unit normals of the surface at the vertices; NaN where it has none. Empty if the mesh
    /// was made without them.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// The surface parameters of the vertices. Empty if the mesh was made without them.
    pub fn uv(&self) -> &[DVec2] {
        &self.uv
    }

    /// The grids: one a knot span, as few as possible for the whole cells of a trimmed surface.
    pub fn grids(&self) -> &[Grid] {
        &self.grids
    }

    /// The vertices of the faces: triangles that belong to no grid, oriented as `S_u × S_v`.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The vertices of every triangle: two a cell, cells row by row, grid by grid, then the faces.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let of_grid = |grid: &'_ Grid| {
            let grid = *grid;
            grid.cells().flat_map(move |(row, column)| grid.triangles(row, column))
        };
        self.grids.iter().flat_map(of_grid).chain(self.faces.iter().copied())
    }

    /// The point of triangle `corners` with barycentric coordinates `place` of its second and
    /// third corner; the normal is interpolated and normalised. Normal and parameters are NaN if the
    /// mesh was made without them.
    ///
    /// # Panics
    /// When the mesh has no such vertices.
    pub fn at_triangle(&self, corners: [u32; 3], place: DVec2) -> MeshPoint {
        let weights = [1.0 - place.x - place.y, place.x, place.y];
        let mut point = MeshPoint { position: DVec3::ZERO, normal: DVec3::ZERO, uv: DVec2::ZERO };
        for (corner, weight) in corners.into_iter().zip(weights) {
            let corner = corner as usize;
            point.position += weight * self.positions[corner];
            point.normal += weight * self.normals.get(corner).unwrap_or(&DVec3::NAN);
            point.uv += weight * self.uv.get(corner).unwrap_or(&DVec2::NAN);
        }
        point.normal = point.normal.normalize();
        point
    }

    /// The point of grid number `grid` at `place`: the fraction of the way along a row, and
    /// from the first row to the last, as Embree reports a hit on a grid.
    ///
    /// # Panics
    /// When the mesh has no such grid.
    pub fn at_grid(&self, grid: usize, place: DVec2) -> MeshPoint {
        let grid = &self.grids[grid];
        // The cell and the place in it; the last cell is closed.
        let cell = |fraction: f64, vertices: u16| {
            let cells = f64::from(vertices) - 1.0;
            let scaled = (fraction * cells).clamp(0.0, cells);
            let index = scaled.floor().min(cells - 1.0);
            (index as u32, scaled - index)
        };
        let (column, along_v) = cell(place.x, grid.columns);
        let (row, along_u) = cell(place.y, grid.rows);
        let [low, high] = grid.triangles(row, column);
        if along_u + along_v <= 1.0 {
            self.at_triangle(low, DVec2::new(along_u, along_v))
        } else {
            self.at_triangle(high, DVec2::new(1.0 - along_u, 1.0 - along_v))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `z = x y` over a 3 × 4 rectangle of unit cells.
    fn saddle() -> GridMesh {
        let mut mesh = GridMesh::default();
        let vertex = |row: usize, column: usize| {
            let (x, y) = (row as f64, column as f64);
            let normal = DVec3::new(-y, -x, 1.0).normalize();
            MeshPoint { position: DVec3::new(x, y, x * y), normal, uv: DVec2::new(x, y) }
        };
        mesh.push_grid((4, 5), vertex).unwrap();
        mesh
    }

    #[test]
    fn triangles_cover_the_grid_and_face_along_the_normals() {
        let mesh = saddle();
        let triangles: Vec<_> = mesh.triangles().collect();
        assert_eq!(triangles.len(), 2 * 3 * 4);
        let mut area = 0.0;
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize]);
            let cross = (b - a).cross(c - a);
            assert!(cross.z > 0.0);
            area += 0.5 * cross.z; // of the projection on the plane z = 0
        }
        assert_eq!(area, 12.0);
    }

    #[test]
    fn places_on_a_grid_are_fractions_of_its_sides() {
        let mesh = saddle();
        // x runs over 3 cells along u (rows), y over 4 along v (columns).
        let point = mesh.at_grid(0, DVec2::new(1.25 / 4.0, 2.5 / 3.0));
        assert!((point.position - DVec3::new(2.5, 1.25, 3.0)).length() < 1e-14);
        assert!((point.uv - DVec2::new(2.5, 1.25)).length() < 1e-14);
        assert!((point.normal.length() - 1.0).abs() < 1e-15);
        let corner = mesh.at_grid(0, DVec2::ONE);
        assert_eq!(corner.position, DVec3::new(3.0, 4.0, 12.0));
    }

    #[test]
    fn refuses_grids_embree_cannot_hold() {
        let point = MeshPoint { position: DVec3::ZERO, normal: DVec3::Z, uv: DVec2::ZERO };
        let error = GridMesh::default().push_grid((2, 32_768), |_, _| point).unwrap_err();
        let message = "a grid of 2 × 32768 vertices: each side needs 2 to 32767";
        assert_eq!(error.to_string(), message);
        assert!(GridMesh::default().push_grid((1, 2), |_, _| point).is_err());
    }
}
