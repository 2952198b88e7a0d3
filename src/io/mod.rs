//! io.

mod atomic;
mod exr;
mod npy;
mod npy_header;
mod png;

pub use atomic::{WriteError, check_writable, write_atomically};
pub use exr::{ExrNotes, ExrPrecision, write_exr};
pub use npy::{NpyError, Table, read_rays, read_table, table_from_bytes, write_rows};
pub use png::{PngWarning, write_png};
