//! Surfaces as grids of triangles, for Embree only: nothing of ours is traced, measured or
//! written through a mesh.

mod cut;
mod grid_mesh;
mod piece;
mod plan;
mod tessellation;

pub use grid_mesh::{Grid, GridMesh, MAX_GRID_SIDE, MAX_VERTICES, MeshError, MeshPoint};
pub use tessellation::{Tessellation, TessellationPlan};
