//! Files: scenes, models and rays in, pictures and hits out; and Embree, a library opened like
//! a file.

mod atomic;
#[cfg(feature = "embree")]
mod embree;
#[cfg(feature = "embree")]
mod embree_error;
#[cfg(feature = "embree")]
mod embree_rays;
mod exr;
pub mod geomdl;
mod load;
mod load_error;
#[cfg(test)]
mod mangled;
#[cfg(feature = "embree")]
pub mod mesh;
mod message;
mod npy;
mod npy_header;
mod png;
pub mod scene_toml;
mod source;

pub use atomic::{WriteError, check_writable, write_atomically};
#[cfg(feature = "embree")]
pub use embree::{Embree, EmbreePrimitive, EmbreeScene};
#[cfg(feature = "embree")]
pub use embree_error::EmbreeError;
#[cfg(feature = "embree")]
pub use embree_rays::{EmbreeHit, EmbreeRays, PacketWidth};
pub use exr::{ExrNotes, ExrPrecision, write_exr};
pub use geomdl::{Model, read_geomdl};
pub use load::load_input;
pub use load_error::{LoadError, LoadFault};
pub use npy::{NpyError, Table, read_rays, read_table, table_from_bytes, write_rows};
pub use png::{PngWarning, write_png};
pub use scene_toml::read_scene;
