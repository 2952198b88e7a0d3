//! Subdivision surfaces: polygon cages and their limit surfaces.
//!
//! A [`Cage`] is a polygon mesh, checked once. Its limit surface, Catmull–Clark's or Doo–Sabin's,
//! is a set of Bézier patches ([`LimitSurface`]). They are exact where the cage is regular. Near
//! extraordinary points, where no finite number of patches is exact, each is proved to be within a
//! tolerance.
//!
//! ```
//! use glam::{DVec2, DVec3};
//! use nurbray::geometry::{Cage, CageParts, Crease};
//!
//! // A tetrahedron, one edge of which is rounded late.
//! let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
//! let creases = vec![Crease { vertices: [0, 1], sharpness: 2.5 }];
//! let cage = Cage::new(CageParts { positions, faces, creases, ..CageParts::default() })?;
//!
//! // Three patches a triangle, one for each corner, where a single one fits.
//! let limit = cage.catmull_clark(1e-4)?;
//! assert!(limit.patches().len() >= 12 && limit.deviation() <= 0.5e-4);
//!
//! // A patch knows the part of the cage it is.
//! let rect = limit.patches()[0].rect;
//! assert_eq!((rect.face, rect.unit), (0, 0));
//! assert!(rect.unit_uv(DVec2::ONE).x <= 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod authored;
mod batches;
mod bicubic;
mod biquadratic;
mod catmull_clark;
mod creased;
mod doo_sabin;
mod error;
mod isolate;
mod limit_charts;
mod limit_curves;
mod limit_surface;
mod limits;
mod mesh;
mod net;
mod ring;
mod seams;
mod side;
mod side_groups;
mod topology;
mod tree;
mod vertex_rule;

pub use authored::{BoundaryRule, Cage, CageParts, Corner, Crease};
pub use error::{CageError, Feature, LimitError};
pub use limit_surface::{FaceRect, LimitPatch, LimitSurface};
pub use limits::LimitPoint;

#[cfg(test)]
mod tests;
