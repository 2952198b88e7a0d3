//! Surfaces as grids of triangles, and triangles along trims, for Embree only: `nurbray` itself
//! traces, measures and writes nothing through a mesh.

mod cell;
mod cut;
mod grid_mesh;
mod lattice;
mod piece;
mod plan;
mod tessellation;

pub use grid_mesh::{Grid, GridMesh, MAX_GRID_SIDE, MAX_VERTICES, MeshError, MeshPoint};
pub use tessellation::{Tessellation, TessellationPlan};
