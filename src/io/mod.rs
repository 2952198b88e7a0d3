//! Files, and the one library that is opened like a file.

#[cfg(feature = "embree")]
mod embree;
#[cfg(feature = "embree")]
mod embree_error;
#[cfg(feature = "embree")]
mod embree_rays;
#[cfg(feature = "embree")]
pub mod mesh;

#[cfg(feature = "embree")]
pub use embree::{Embree, EmbreePrimitive, EmbreeScene};
#[cfg(feature = "embree")]
pub use embree_error::EmbreeError;
#[cfg(feature = "embree")]
pub use embree_rays::{EmbreeHit, EmbreeRays, PacketWidth};
