//! Why a scene cannot be shown.

use std::fmt;

use thiserror::Error;

use super::{DrawError, PlotError};
use crate::geometry::construct::ConstructError;
use crate::geometry::shapes::ShapeError;
use crate::geometry::trim::{TrimCurveError, TrimError, TrimLoopError};
use crate::geometry::{CurveError, LimitError, MoveError, SurfaceError, TriangleError};
use crate::intersect::BuildError;
use crate::scene::look::{CameraError, LightError};
use crate::scene::written::{
    ImportNote, LoopSense, PictureError, Place, TransformError, UnknownName, with_place,
};

/// Why a scene cannot be shown, and where its author wrote the fault.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    place: Place,
    fault: Box<SceneFault>,
}

impl SceneError {
    pub(crate) fn new(place: Place, fault: SceneFault) -> Self {
        Self { place, fault: Box::new(fault) }
    }

    /// Where the fault was written.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// What is wrong.
    pub fn fault(&self) -> &SceneFault {
        &self.fault
    }
}

impl std::error::Error for SceneError {}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        with_place(f, &self.place, &self.fault)?;
        // A scene made in code is not mended in the language of files.
        self.place.label().map_or(Ok(()), |_| f.write_str(self.fault.hint_for_files()))
    }
}

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneFault {
    /// Numbers that do not make a surface.
    #[error("surface \"{surface}\"{}{error}", separator(.error))]
    Surface {
        /// The surface's name.
        surface: String,
        /// What is wrong with it.
        error: SurfaceError,
    },
    /// Numbers that do not make a triangular patch.
    #[error("surface \"{surface}\": {error}")]
    Triangle {
        /// The surface's name.
        surface: String,
        /// What is wrong with it.
        error: TriangleError,
    },
    /// A cage without a surface.
    #[error("surface \"{surface}\": {error}")]
    Limit {
        /// The surface's name.
        surface: String,
        /// Why it has none.
        error: LimitError,
    },
    /// A surface that cannot be made from curves.
    #[error("surface \"{surface}\": {error}")]
    Construction {
        /// The surface's name.
        surface: String,
        /// Which curve or number is at fault.
        error: ConstructError,
    },
    /// A part of another object that cannot be drawn.
    #[error("surface \"{surface}\": {error}")]
    Drawing {
        /// The name of the surface that would be the drawing.
        surface: String,
        /// Which number is at fault, or what there is not to draw.
        error: DrawError,
    },
    /// A shape that cannot be made.
    #[error("surface \"{surface}\": {error}")]
    Shape {
        /// The surface's name.
        surface: String,
        /// What is wrong with it.
        error: ShapeError,
    },
    /// Loops that cannot trim a surface.
    #[error("surface \"{surface}\": trims: {error}")]
    Trims {
        /// The surface's name.
        surface: String,
        /// What is wrong with them.
        error: TrimError,
    },
    /// Numbers that do not make a curve of a loop.
    #[error("surface \"{surface}\": trims: loop {trim_loop}, curve {curve}: {error}")]
    TrimCurve {
        /// The surface's name.
        surface: String,
        /// Which loop, counted from 0.
        trim_loop: usize,
        /// Which of its curves, counted from 0.
        curve: usize,
        /// What is wrong with it.
        error: TrimCurveFault,
    },
    /// A loop that is not what its file says it is.
    #[error(
        "surface \"{surface}\": trims: loop {trim_loop} is written as {said}, but it has {around} around it and would be {found}"
    )]
    TrimSense {
        /// The surface's name.
        surface: String,
        /// Which loop, counted from 0.
        trim_loop: usize,
        /// What it is said to be.
        said: LoopSense,
        /// What it is.
        found: LoopSense,
        /// How many loops lie around it.
        around: usize,
    },
    /// Trims that leave nothing.
    #[error("surface \"{surface}\": trims: they keep no part of the surface")]
    NothingKept {
        /// The surface's name.
        surface: String,
    },
    /// Trims for a surface of a kind that cannot have any.
    #[error("object \"{object}\": trims cut NURBS surfaces, and this is {kind}")]
    NotTrimmed {
        /// The object's name.
        object: String,
        /// What it is.
        kind: &'static str,
    },
    /// Trims for a surface that is trimmed already.
    #[error("object \"{object}\": this surface is trimmed already, by its file or by what made it")]
    TrimmedTwice {
        /// The object's name.
        object: String,
    },
    /// Trims for several surfaces at once.
    #[error("object \"{object}\": trims cut one surface, and here are {count}")]
    TrimsOfSeveral {
        /// The object's name.
        object: String,
        /// How many surfaces it has.
        count: usize,
    },
    /// A step of a transform that is not a transform of space.
    #[error("object \"{object}\": {error}")]
    Transform {
        /// The object's name.
        object: String,
        /// What is wrong with it.
        error: TransformError,
    },
    /// A surface that its transform moves or scales out of the range of numbers.
    #[error("surface \"{surface}\", placed by its transform: {error}")]
    Placed {
        /// The surface's name.
        surface: String,
        /// What is wrong with it there.
        error: MoveError,
    },
    /// A material that the scene does not describe.
    #[error("object \"{object}\": {error}")]
    Material {
        /// The object's name.
        object: String,
        /// The name and the nearest known one.
        error: UnknownName,
    },
    /// A net or curves of an object that the scene does not have.
    #[error("object \"{object}\": {error}")]
    Draws {
        /// The object that draws.
        object: String,
        /// The name and the nearest known one.
        error: UnknownName,
    },
    /// A net of a net.
    #[error("object \"{object}\": \"{of}\" is itself drawn from another object: name that one")]
    DrawsDrawn {
        /// The object that draws.
        object: String,
        /// The object it names.
        of: String,
    },
    /// Two things with one name.
    #[error("the {what} name \"{name}\" is taken{}", elsewhere(.first))]
    Duplicate {
        /// An object or a material.
        what: &'static str,
        /// The name.
        name: String,
        /// Where it was given first.
        first: Place,
    },
    /// More control points than are sensible.
    #[error("{points} control points in all: at most {limit} are supported")]
    TooManyPoints {
        /// How many there are.
        points: usize,
        /// How many there may be.
        limit: usize,
    },
    /// There is no object.
    #[error("there is nothing to show: the scene has no object")]
    NoObjects,
    /// There are plots, but no object to trace.
    #[error("there is nothing to trace: the scene has plots, but no object")]
    OnlyPlots,
    /// A plot that cannot be drawn.
    #[error("plot {plot}: {error}")]
    Plot {
        /// Its title in quotes, or its number.
        plot: String,
        /// What is wrong with it.
        error: PlotError,
    },
    /// There is nothing to see in any object.
    #[error("there is no surface to show{}", not_imported(.notes))]
    Empty {
        /// What the file holds instead.
        notes: Vec<ImportNote>,
    },
    /// A light with invalid numbers.
    #[error("light {light}: {error}")]
    Light {
        /// Which, counted from 0.
        light: usize,
        /// What is wrong with it.
        error: LightError,
    },
    /// A material with an invalid colour or width of lines.
    #[error("material \"{material}\": {error}")]
    Texture {
        /// Its name.
        material: String,
        /// What is wrong with it.
        error: LightError,
    },
    /// A background that is not an amount of light.
    #[error("{0}")]
    Background(LightError),
    /// The picture cannot be made.
    #[error("{0}")]
    Picture(PictureError),
    /// The camera is not possible.
    #[error("camera: {0}")]
    Camera(CameraError),
    /// The surfaces cannot be prepared.
    #[error("{0}")]
    Build(BuildError),
}

impl SceneFault {
    /// What to write in a file to mend it; empty where the message says all there is to say.
    fn hint_for_files(&self) -> &'static str {
        match self {
            Self::NoObjects => " (write an [[object]], with a shape such as \"sphere\")",
            Self::OnlyPlots => {
                " (`nurbray plot` draws the plots; to trace, write an [[object]], with a shape such \
                 as \"sphere\")"
            }
            Self::Trims {
                error: TrimError::Loop { error: TrimLoopError::Open { curve: 0, next: 0, .. }, .. },
                ..
            } => {
                " (one curve alone must end where it begins; only a loop { polygon = … }, not one of \
                 curves, closes by itself)"
            }
            _ => "",
        }
    }
}

/// Why a curve of a loop cannot trim.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrimCurveFault {
    /// It is not a curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// It is not a curve in (u, v).
    #[error(transparent)]
    Trim(#[from] TrimCurveError),
}

/// A comma before `direction u: …`, a colon before the rest.
fn separator(error: &SurfaceError) -> &'static str {
    match error {
        SurfaceError::Knots { .. } | SurfaceError::Domain { .. } => ", ",
        _ => ": ",
    }
}

fn elsewhere(first: &Place) -> String {
    match first.position() {
        Some((line, column)) => format!(": it is given at {line}:{column}"),
        None => String::new(),
    }
}

fn not_imported(notes: &[ImportNote]) -> String {
    match notes {
        [] => String::new(),
        [first, rest @ ..] => {
            let more =
                if rest.is_empty() { String::new() } else { format!("; {} more", rest.len()) };
            format!(" (not imported: {}: {}{more})", first.what, first.why)
        }
    }
}
