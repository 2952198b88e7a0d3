//! Closed forms: `F(x, y, z) = 0`, with `F < 0` inside.

use glam::DVec3;
use nurbray::geometry::{NurbsSurface, shapes};

use crate::double::Double;
use crate::polynomial::Polynomial;

/// A shape of size 1 at the origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Sphere,
    BiquadraticSphere,
    Cylinder,
    Cone,
    Torus,
    Disk,
    Plane,
}

const HEIGHT: f64 = 2.0;
const TUBE: f64 = 0.3;

impl Form {
    pub(crate) const ALL: [Self; 7] = [
        Self::Sphere,
        Self::BiquadraticSphere,
        Self::Cylinder,
        Self::Cone,
        Self::Torus,
        Self::Disk,
        Self::Plane,
    ];

    pub(crate) fn surface(self) -> NurbsSurface {
        let surface = match self {
            Self::Sphere => shapes::sphere(1.0),
            Self::BiquadraticSphere => shapes::sphere_biquadratic(1.0),
            Self::Cylinder => shapes::cylinder(1.0, HEIGHT),
            Self::Cone => shapes::cone(1.0, HEIGHT),
            Self::Torus => shapes::torus(1.0, TUBE),
            Self::Disk => shapes::disk(1.0),
            Self::Plane => shapes::plane(1.0, HEIGHT),
        };
        surface.unwrap()
    }

    pub(crate) fn is_closed(self) -> bool {
        matches!(self, Self::Sphere | Self::BiquadraticSphere | Self::Torus)
    }

    /// `F` along a line, given by its three coordinates as polynomials.
    pub(crate) fn along(self, [x, y, z]: &[Polynomial; 3]) -> Polynomial {
        let number = |c: Double| Polynomial(vec![c]);
        let around = x.times(x).plus(&y.times(y));
        match self {
            Self::Sphere | Self::BiquadraticSphere => {
                around.plus(&z.times(z)).plus(&number(Double::from(-1.0)))
            }
            Self::Cylinder => around.plus(&number(Double::from(-1.0))),
            Self::Cone => {
                let radius = number(Double::from(1.0)).plus(&z.scaled(-1.0 / HEIGHT));
                around.plus(&radius.times(&radius).scaled(-1.0))
            }
            Self::Torus => {
                // (x² + y² + z² + 1 − r²)² − 4 (x² + y²)
                let tube = Double::from(TUBE);
                let middle = number(Double::from(1.0) - tube * tube);
                let sum = around.plus(&z.times(z)).plus(&middle);
                sum.times(&sum).plus(&around.scaled(-4.0))
            }
            Self::Disk | Self::Plane => z.clone(),
        }
    }

    /// The gradient of `F`.
    pub(crate) fn gradient(self, p: DVec3) -> DVec3 {
        let around = DVec3::new(2.0 * p.x, 2.0 * p.y, 0.0);
        match self {
            Self::Sphere | Self::BiquadraticSphere => 2.0 * p,
            Self::Cylinder => around,
            Self::Cone => around + DVec3::Z * (2.0 / HEIGHT) * (1.0 - p.z / HEIGHT),
            Self::Torus => {
                let sum = p.length_squared() + 1.0 - TUBE * TUBE;
                4.0 * sum * p - 4.0 * around
            }
            Self::Disk | Self::Plane => DVec3::Z,
        }
    }

    /// How far inside the border a point of the whole form is; negative beyond it.
    pub(crate) fn inside_border(self, p: DVec3) -> f64 {
        match self {
            Self::Sphere | Self::BiquadraticSphere | Self::Torus => f64::INFINITY,
            Self::Cylinder | Self::Cone => p.z.min(HEIGHT - p.z),
            Self::Disk => 1.0 - p.x.hypot(p.y),
            Self::Plane => (0.5 - p.x.abs()).min(0.5 * HEIGHT - p.y.abs()),
        }
    }

    /// How far a point is from where the form has no tangent plane.
    pub(crate) fn tip_distance(self, p: DVec3) -> f64 {
        if self == Self::Cone { p.distance(DVec3::new(0.0, 0.0, HEIGHT)) } else { f64::INFINITY }
    }

    /// How far a point is from where the parametrisation ends in a point, at most 1.
    pub(crate) fn pole_distance(self, p: DVec3) -> f64 {
        let poles: &[DVec3] = match self {
            Self::Sphere | Self::BiquadraticSphere => &[DVec3::Z, DVec3::NEG_Z],
            Self::Cone => &[DVec3::new(0.0, 0.0, HEIGHT)],
            Self::Disk => &[DVec3::ZERO],
            Self::Cylinder | Self::Torus | Self::Plane => &[],
        };
        poles.iter().map(|pole| p.distance(*pole)).fold(1.0, f64::min)
    }
}
