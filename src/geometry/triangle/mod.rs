//! Triangular rational Bézier patches.

mod charts;
mod error;
#[cfg(test)]
mod tests;
mod triangle_patch;

pub use error::TriangleError;
pub use triangle_patch::{TrianglePatch, TriangleQuarter, TriangleSide};
