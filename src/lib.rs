//! nurbray meets rays with NURBS surfaces directly.

pub mod geometry;
pub mod intersect;
pub mod io;
pub mod math;
pub mod patch;
pub mod render;
pub mod scene;
