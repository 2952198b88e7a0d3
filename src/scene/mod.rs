//! What is seen: the scene as written, and the world ready to trace.
//!
//! A reader makes a [`Scene`] from a file, or code fills one in; [`World::new`] checks it,
//! puts the surfaces in their places, and chooses a view and lights where none are given.
//! Readers build a `Scene` and nothing else; rendering needs a `World` and nothing else.

mod camera;
mod construction;
mod curve;
mod document;
mod drawn;
#[cfg(test)]
mod drawn_tests;
mod error;
mod framing;
mod light;
mod material;
mod names;
mod net;
mod note_circle;
mod palette;
mod place;
mod placing;
mod plot;
mod plot_error;
mod plotted;
mod plotted_basis;
mod settings;
mod shape;
mod spacing;
mod subdivision;
mod transform;
mod triangle;
mod trims;
mod unique_names;
mod workshop;
mod world;

pub use camera::{Camera, CameraError, Projection, View};
pub use construction::Construction;
pub use curve::{BSplineEnds, CurveKind, CurveSpec};
pub use document::{CameraSpec, ImportNote, Lens, Object, Part, Scene, Shape};
pub use error::{SceneError, SceneFault};
pub use light::{Light, LightError, Rgb};
pub(crate) use material::share;
pub use material::{Material, Texture};
pub use names::{UnknownName, nearest};
pub use net::{Knots, Net};
pub use note_circle::NoteCircle;
pub use place::{Place, Written};
pub use plot::{CurveEntry, FigureSpec, Plane, Plot, PlotKind, PlotSpec, PlottedCurve};
pub use plot_error::PlotError;
pub use plotted::{LoopCurve, LoopCurveKind, ObjectSpec, PlottedSurface};
pub use plotted_basis::{BasisSpec, PlottedBasis, PlottedFunctions};
pub use settings::{IntegratorKind, PictureError, RenderDefaults};
pub use shape::NamedShape;
pub use subdivision::{Scheme, Subdivision};
pub(crate) use transform::placed;
pub use transform::{Transform, TransformError};
pub use triangle::TriangleNet;
pub use trims::{LoopKind, LoopSense, LoopSpec, TrimCurveFault, TrimSpec};
pub use world::{Instance, Placed, World};
