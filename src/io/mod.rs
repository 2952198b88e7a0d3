//! Files, and the one library that is opened like a file.

mod atomic;
#[cfg(feature = "embree")]
mod embree;
#[cfg(feature = "embree")]
mod embree_error;
#[cfg(feature = "embree")]
mod embree_rays;
mod exr;
#[cfg(feature = "embree")]
pub mod mesh;
mod npy;
mod npy_header;
mod png;

pub use atomic::{WriteError, check_writable, write_atomically};
#[cfg(feature = "embree")]
pub use embree::{Embree, EmbreePrimitive, EmbreeScene};
#[cfg(feature = "embree")]
pub use embree_error::EmbreeError;
#[cfg(feature = "embree")]
pub use embree_rays::{EmbreeHit, EmbreeRays, PacketWidth};
pub use exr::{ExrNotes, ExrPrecision, write_exr};
pub use npy::{NpyError, Table, read_rays, read_table, write_rows};
pub use png::{PngWarning, write_png};
