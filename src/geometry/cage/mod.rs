//! Subdivision surfaces: polygon cages and their limit surfaces.
//!
//! A [`Cage`] is a polygon mesh, checked once. Its limit surface, Catmull–Clark's or
//! Doo–Sabin's, comes as Bézier patches ([`LimitSurface`]): exact ones where the cage is
//! regular, and near extraordinary points, where no finite number of patches is exact, ones
//! within a tolerance that is proved for each.

mod authored;
mod bicubic;
mod biquadratic;
mod cage_error;
mod catmull_clark;
mod doo_sabin;
mod isolate;
mod limit_surface;
mod limits;
mod mesh;
mod ring;
mod topology;
mod tree;
mod vertex_rule;

pub use authored::{BoundaryRule, Cage, CageParts, Corner, Crease};
pub use cage_error::{CageError, Feature, LimitError};
pub use limit_surface::{FaceSquare, LimitPatch, LimitSurface};
pub use limits::LimitPoint;

#[cfg(test)]
mod tests;
