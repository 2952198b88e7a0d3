//! Why rays cannot be read.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::quoted::{DidYouMean, NoStandardInput, Quoted, WhyUnread};
use crate::math::{Counted, RayError};

/// Why a file cannot be read as a table.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The system refuses.
    #[error(
        "cannot read {}: {}{}{}",
        Quoted(path), WhyUnread(reason), DidYouMean(.nearest.as_deref()), NoStandardInput(path)
    )]
    Io {
        /// The file.
        path: PathBuf,
        /// An existing file that may have been meant, if this one does not exist.
        nearest: Option<PathBuf>,
        /// What the system says.
        reason: io::Error,
    },
    /// The file does not begin as a NumPy file does.
    #[error("{}: not a NumPy .npy file: {found}", .path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        found: String,
    },
    /// The numbers are of another kind.
    #[error("{}: found numbers of type {found}, needed float64 or float32 (array.astype('f8'))", .path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// The type in NumPy's notation.
        found: String,
    },
    /// The array has another shape.
    #[error("{}: found an array of shape {found}, needed {needed}", .path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// The shape, as NumPy writes it.
        found: String,
        /// The shapes that would do.
        needed: String,
    },
    /// The header promises more numbers than are possible.
    #[error("{}: the header tells of an array of {found} numbers: it is damaged", .path.display())]
    Absurd {
        /// The file.
        path: PathBuf,
        /// How many, in the words of the header.
        found: String,
    },
    /// The file ends too early.
    #[error("{}: found {} of data, needed {needed}: the file is cut short", .path.display(), Counted(usize::try_from(*.found).unwrap_or(usize::MAX), "byte"))]
    Truncated {
        /// The file.
        path: PathBuf,
        /// The bytes after the header.
        found: u64,
        /// The bytes the header promises.
        needed: u64,
    },
    /// A row is not a ray.
    #[error("{}: row {row}, counted from 0: {reason}", .path.display())]
    Ray {
        /// The file.
        path: PathBuf,
        /// The row, counted from 0.
        row: usize,
        /// What is wrong with it.
        #[source]
        reason: RayError,
    },
}
