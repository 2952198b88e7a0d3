//! Surfaces made from curves: revolution, extrusion, ruled surfaces, Coons patches, lofts,
//! sweeps; and curves and control nets made visible as tubes and ribbons.
//!
//! All become [`NurbsSurface`](super::NurbsSurface)s. Rational surfaces are exact: the control
//! points of the surface itself are stored.
//!
//! Profiles, sections, paths and the curves inside tubes and ribbons must not *fold*, that is, turn
//! round and run back over the stretch they have just run through: the surface would cover itself
//! twice. Corners, cusps whose two sides part, and curves that touch or cross themselves are not
//! folds. Nor may a revolution or an extrusion take a part of its profile to where another part has
//! been, as when a full circle is turned about its diameter by more than 180°, or turned or moved
//! within its own plane.
//!
//! ```
//! use glam::{DVec2, DVec3};
//! use nurbray::geometry::NurbsCurve;
//! use nurbray::geometry::construct::{Axis, revolve};
//!
//! // A cone: a slanted line turned about the z axis.
//! let line = NurbsCurve::polyline(&[DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 3.0)])?;
//! let cone = revolve(&line, &Axis::Z, 360.0)?;
//! let middle = cone.point_at(DVec2::new(0.125, line.domain()[1] / 2.0));
//! assert!((middle.truncate().length() - 1.0).abs() < 1e-15);
//! assert_eq!(cone.point(5, 1), Some(DVec3::new(0.0, 0.0, 3.0))); // the tip, whatever u
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod axis_points;
mod collinear;
mod compatible;
mod component;
mod coons;
mod coons_corner;
mod drawing;
#[cfg(test)]
mod drawing_tests;
mod error;
mod fold;
#[cfg(test)]
mod fold_tests;
mod frames;
mod interpolate;
mod loft;
mod moving;
mod net;
mod net_size;
mod path;
mod places;
mod revolve;
mod ruled;
#[cfg(test)]
mod sliver_tests;
mod slivers;
#[cfg(test)]
mod sound_tests;
mod stops;
mod styles;
mod sweep;
mod sweep_options;
#[cfg(test)]
mod sweep_tests;
mod tightest;
mod tube;
mod tube_parts;

pub use axis::Axis;
pub use component::{Component, ComponentKind};
pub use coons::{Borders, coons};
pub use coons_corner::CoonsCorner;
pub use drawing::{Drawing, control_net};
pub use error::{ConstructError, DirectionOf};
pub use loft::{LOFT_DEGREE, Loft, loft};
pub use net::ControlNet;
pub use revolve::revolve;
pub use ruled::{extrude, ruled};
pub use styles::{Caps, NetStyle, RibbonStyle, TubeStyle};
pub use sweep::{sweep, sweep_size};
pub use sweep_options::{MAX_SCALES, Sweep, SweepOptions};
pub use tightest::Tightest;
pub use tube::{ribbon, tube};
