//! The scene as its author wrote it: plain data, with the places that errors will name. Of lights,
//! materials and colours it says what `look` says. An entry may be checked by itself where it
//! becomes geometry: a net becomes a surface, points and knots a curve, a cage its limit surface.
//! How surfaces get to their places, and the errors of a whole scene, are not known here.

mod construction;
mod curve;
mod document;
mod import_note;
mod named_arc;
mod names;
mod net;
mod place;
mod plot_spec;
mod settings;
mod shape;
mod subdivision;
mod transform;
mod triangle;
mod trim_spec;

pub use construction::Construction;
pub(in crate::scene) use curve::CurveFault;
pub use curve::{BSplineEnds, CurveKind, CurveSpec};
pub use document::{CameraSpec, Lens, Object, Part, Scene, Shape};
pub use import_note::ImportNote;
pub use named_arc::NamedArc;
pub use names::{UnknownName, nearest};
pub use net::{Knots, Net};
pub(in crate::scene) use net::{evenly_spaced, knot_vector, wrapped};
pub(in crate::scene) use place::with_place;
pub use place::{Place, Written};
pub use plot_spec::{BasisSpec, CurveEntry, FigureSpec, ObjectSpec, Plane, PlotKind, PlotSpec};
pub(in crate::scene) use plot_spec::{MAX_FUNCTIONS, MAX_LINES, MAX_ROUNDS, MAX_TEETH};
pub use settings::{IntegratorKind, PictureError, RenderDefaults};
pub use shape::NamedShape;
pub use subdivision::{Scheme, Subdivision};
pub(crate) use transform::placed;
pub use transform::{Transform, TransformError};
pub use triangle::TriangleNet;
pub use trim_spec::{LoopKind, LoopSense, LoopSpec, TrimSpec};
