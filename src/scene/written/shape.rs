//! Shapes the program knows by name.

use crate::geometry::Surface;
use crate::geometry::shapes::{self, OctantConstants, ShapeError};

/// A shape the program knows by name; [`shapes`] says how each lies and runs.
///
/// All are oriented outward, or towards +z where they have no inside; the documents'
/// patches are as the documents give them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NamedShape {
    /// A bicubic sphere around the origin, poles on the z axis.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// The same sphere as a biquadratic surface of revolution.
    SphereBiquadratic {
        /// Its radius.
        radius: f64,
    },
    /// The half `y ≥ 0` of a sphere, one bicubic patch.
    Hemisphere {
        /// Its radius.
        radius: f64,
    },
    /// The eighth `x, y, z ≥ 0` of a sphere, one biquadratic patch.
    Octant {
        /// Its radius.
        radius: f64,
    },
    /// The eighth `x, y, z ≥ 0` of a sphere, one quartic triangle.
    OctantQuartic {
        /// Its radius.
        radius: f64,
        /// `a₀ … a₂` and `b₀ … b₃`; Farin's if not given.
        constants: Option<([f64; 3], [f64; 4])>,
    },
    /// The side of a cylinder that stands on `z = 0`.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Its height.
        height: f64,
    },
    /// The side of a cone that stands on `z = 0`.
    Cone {
        /// The radius at its base.
        radius: f64,
        /// The height of its tip.
        height: f64,
    },
    /// A torus around the z axis.
    Torus {
        /// The radius of the circle in the middle of the tube.
        major: f64,
        /// The radius of the tube.
        minor: f64,
    },
    /// A disk in `z = 0` around the origin.
    Disk {
        /// Its radius.
        radius: f64,
    },
    /// A rectangle in `z = 0` around the origin.
    Plane {
        /// Its length along x.
        width: f64,
        /// Its length along y.
        height: f64,
    },
    /// A bicubic graph over a square.
    BicubicGraph,
    /// A bicubic hood.
    BicubicHood,
    /// The hood with its corners drawn into one point.
    BicubicHoodPinched,
    /// The 4 × 4 net of the OpenGL Programming Guide.
    RedBookPatch,
}

impl NamedShape {
    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::SphereBiquadratic { .. } => "sphere_biquadratic",
            Self::Hemisphere { .. } => "hemisphere",
            Self::Octant { .. } => "octant",
            Self::OctantQuartic { .. } => "octant_quartic",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Torus { .. } => "torus",
            Self::Disk { .. } => "disk",
            Self::Plane { .. } => "plane",
            Self::BicubicGraph => "lecture_patch_1",
            Self::BicubicHood => "lecture_patch_2",
            Self::BicubicHoodPinched => "lecture_patch_3",
            Self::RedBookPatch => "deck_patch",
        }
    }

    /// The surface.
    ///
    /// # Errors
    /// When a length is not positive and finite, a torus would meet itself, or the constants of an
    /// octant make no sphere.
    pub fn surface(&self) -> Result<Surface, ShapeError> {
        let surface = match *self {
            Self::Sphere { radius } => shapes::sphere(radius)?,
            Self::SphereBiquadratic { radius } => shapes::sphere_biquadratic(radius)?,
            Self::Hemisphere { radius } => shapes::hemisphere(radius)?,
            Self::Octant { radius } => shapes::octant_biquadratic(radius)?,
            Self::OctantQuartic { radius, constants } => {
                let constants = constants.map_or_else(
                    || Ok(OctantConstants::farin()),
                    |(a, b)| OctantConstants::new(a, b),
                );
                return Ok(constants?.octant(radius)?.into());
            }
            Self::Cylinder { radius, height } => shapes::cylinder(radius, height)?,
            Self::Cone { radius, height } => shapes::cone(radius, height)?,
            Self::Torus { major, minor } => shapes::torus(major, minor)?,
            Self::Disk { radius } => shapes::disk(radius)?,
            Self::Plane { width, height } => shapes::plane(width, height)?,
            Self::BicubicGraph => shapes::bicubic_graph(),
            Self::BicubicHood => shapes::bicubic_hood(),
            Self::BicubicHoodPinched => shapes::bicubic_hood_pinched(),
            Self::RedBookPatch => shapes::red_book_patch(),
        };
        Ok(surface.into())
    }
}
