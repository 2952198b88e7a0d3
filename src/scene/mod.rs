//! What is seen: the scene as written, and the world ready to trace.
//!
//! A reader makes a [`Scene`] from a file, or code fills one in; [`World::new`] checks it,
//! puts the surfaces in their places, and chooses a view and lights where none are given.
//! Readers build a `Scene` and nothing else; rendering needs a `World` and nothing else.
//!
//! A scene may show surfaces that code has made:
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use glam::{DVec3, dvec3};
//! use nurbray::geometry::construct::{Axis, revolve};
//! use nurbray::geometry::{NurbsCurve, Surface};
//! use nurbray::render::{Channel, RenderSettings, render};
//! use nurbray::scene::{Object, Scene, Shape, Transform, World};
//!
//! // A vase: a profile turned about the z axis. It is placed by the object it belongs to.
//! let profile = [dvec3(0.5, 0.0, 0.0), dvec3(1.2, 0.0, 0.7), dvec3(0.3, 0.0, 1.5)];
//! let vase = revolve(&NurbsCurve::bezier(&profile)?, &Axis::new(DVec3::ZERO, DVec3::Z)?, 360.0)?;
//! let object = Object {
//!     parts: vec![Shape::from(Surface::from(vase)).into()],
//!     transform: vec![Transform::Scale(DVec3::splat(2.0)).into()],
//!     ..Object::default()
//! };
//! let scene = Scene { objects: vec![object], ..Scene::default() };
//!
//! let world = World::new(&scene)?;
//! let settings = RenderSettings { size: [32, 24], samples: 0..4, ..Default::default() };
//! let film = render(&world, &settings, &|_| ControlFlow::Continue(()))?;
//! assert_eq!(film.value(Channel::A, [16, 12]), Some(1.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where things are
//!
//! There are these folders, each of which uses only those above it, and `world` no plots:
//!
//! | | |
//! |---|---|
//! | `look` | what a picture is seen with: camera, lights, materials |
//! | `written` | the scene as its author wrote it, with its places |
//! | `errors` | why a scene cannot be shown, or a plot not be made |
//! | `making` | from what is written to surfaces in their places |
//! | `plots` | from plots as written to plots whose numbers are checked |
//! | `world` | the scene ready to trace |

mod errors;
mod look;
mod making;
mod plots;
mod world;
mod written;

pub use errors::{DrawError, PlotError, SceneError, SceneFault, TrimCurveFault};
pub use look::{Camera, CameraError, Light, LightError, Material, Projection, Rgb, Texture, View};
pub(crate) use look::{MAX_INTENSITY, MAX_LIGHT, share};
pub use plots::{
    LoopCurve, LoopCurveKind, Plot, PlottedBasis, PlottedCurve, PlottedFunctions, PlottedSurface,
    SplineData,
};
pub use world::{Instance, Placed, World};
pub(crate) use written::placed;
pub use written::{
    BSplineEnds, BasisSpec, CameraSpec, Construction, CurveEntry, CurveKind, CurveSpec, FigureSpec,
    ImportNote, IntegratorKind, Knots, Lens, LoopKind, LoopSense, LoopSpec, NamedArc, NamedShape,
    Net, Object, ObjectSpec, Part, PictureError, Place, Plane, PlotKind, PlotSpec, RenderDefaults,
    Scene, Scheme, Shape, Subdivision, Transform, TransformError, TriangleNet, TrimSpec,
    UnknownName, Written, nearest,
};
