//! Why an input cannot be read.

use std::fmt;
use std::path::PathBuf;

use super::quoted::{DidYouMean, NoStandardInput, Quoted, WhyUnread};
use crate::scene::{Place, SceneError};

/// Why an input cannot be read: one message with the file, the line and the column.
#[derive(Debug)]
pub struct LoadError {
    place: Place,
    fault: LoadFault,
}

/// What is wrong with an input.
#[derive(Debug)]
#[non_exhaustive]
pub enum LoadFault {
    /// The file cannot be opened or read.
    Read {
        /// Which file.
        path: PathBuf,
        /// A file beside it with a similar name.
        nearest: Option<PathBuf>,
        /// What the system says.
        error: std::io::Error,
    },
    /// It is a pipe or a device.
    NotAFile {
        /// Which.
        path: PathBuf,
    },
    /// It is a scene, where the shape of an object is needed.
    NotAShape {
        /// Which file.
        path: PathBuf,
    },
    /// It is larger than any sensible input.
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// The largest size that is read.
        limit: u64,
    },
    /// It is not UTF-8 text; the error's place is where valid text ends.
    NotText {
        /// Which file.
        path: PathBuf,
        /// How many bytes of text come first.
        valid: usize,
    },
    /// It is UTF-16 text, by the mark of the encoding.
    Utf16 {
        /// Which file.
        path: PathBuf,
    },
    /// It is of a type that is not read.
    UnknownType {
        /// Which file.
        path: PathBuf,
        /// What it seems to be.
        what: &'static str,
    },
    /// Its text is not a scene or a model.
    Malformed(String),
    /// The scene it describes is not possible.
    Scene(SceneError),
}

impl LoadError {
    pub(super) fn new(place: Place, fault: LoadFault) -> Self {
        Self { place, fault }
    }

    pub(super) fn malformed(place: Place, message: impl Into<String>) -> Self {
        Self::new(place, LoadFault::Malformed(message.into()))
    }

    /// What is wrong.
    pub fn fault(&self) -> &LoadFault {
        &self.fault
    }

    /// The place of the fault in the author's text, or where that text mentions the faulty file.
    pub fn place(&self) -> &Place {
        match &self.fault {
            LoadFault::Scene(error) => error.place(),
            _ => &self.place,
        }
    }
}

impl From<SceneError> for LoadError {
    fn from(error: SceneError) -> Self {
        Self::new(Place::default(), LoadFault::Scene(error))
    }
}

impl std::error::Error for LoadError {}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place.label() {
            Some(_) => write!(f, "{}: {}", self.place, self.fault),
            None => write!(f, "{}", self.fault),
        }
    }
}

impl fmt::Display for LoadFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { path, nearest, error } => {
                let meant = DidYouMean(nearest.as_deref());
                let hint = NoStandardInput(path);
                write!(f, "cannot read {}: {}{meant}{hint}", Quoted(path), WhyUnread(error))
            }
            Self::NotAFile { path } => {
                write!(f, "cannot read {}: it is a pipe or a device, not a file", Quoted(path))
            }
            Self::NotAShape { path } => write!(
                f,
                "{} is a scene, which cannot be the shape of an object; models (.json) and cages \
                 (.obj) can",
                Quoted(path)
            ),
            Self::TooLarge { path, bytes, limit } => {
                let path = Quoted(path);
                write!(f, "cannot read {path}: {bytes} bytes are more than the {limit} allowed")
            }
            Self::NotText { valid, .. } => {
                write!(f, "from here on the file is not UTF-8 text: byte {valid} cannot be read")
            }
            Self::Utf16 { .. } => {
                f.write_str("found UTF-16 text, by its first two bytes: save the file as UTF-8")
            }
            Self::UnknownType { path, what } => {
                write!(
                    f,
                    "cannot read {}: {what}; what can be read are scenes (.toml), geomdl JSON \
                     models (.json) and cages (.obj)",
                    Quoted(path)
                )
            }
            Self::Malformed(message) => f.write_str(message),
            Self::Scene(error) => write!(f, "{error}"),
        }
    }
}
