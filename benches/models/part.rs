//! A machine part as CAD systems make them: profiles of lines and arcs, turned about axes.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::{Direction, KnotVector, NurbsSurface, SurfaceError};

/// The next stretch of a profile: radius and height of its end.
#[derive(Clone, Copy, Debug)]
enum Stretch {
    /// A straight line.
    Line(f64, f64),
    /// A quarter of a circle or ellipse that rounds off a corner, given first.
    Corner([f64; 2], [f64; 2]),
}

use Stretch::{Corner, Line};

/// A pipe end with a flange, all edges rounded, a fillet between pipe and flange.
const BODY: ([f64; 2], [Stretch; 11]) = (
    [0.3, 0.0],
    [
        Line(0.3, 0.95),
        Corner([0.3, 1.0], [0.35, 1.0]),
        Line(0.55, 1.0),
        Corner([0.6, 1.0], [0.6, 0.95]),
        Line(0.6, 0.4),
        Corner([0.6, 0.2], [0.8, 0.2]),
        Line(1.4, 0.2),
        Corner([1.5, 0.2], [1.5, 0.1]),
        Line(1.5, 0.05),
        Corner([1.5, 0.0], [1.45, 0.0]),
        Line(0.3, 0.0),
    ],
);

/// A bolt's head: a cylinder with a dome.
const BOLT: ([f64; 2], [Stretch; 2]) =
    ([0.12, 0.2], [Line(0.12, 0.28), Corner([0.12, 0.36], [0.0, 0.36])]);

/// The number of bolts, and the radius of the circle they stand on.
const BOLTS: u32 = 8;
const BOLT_CIRCLE: f64 = 1.1;

/// The whole part.
pub(super) fn flange() -> Result<Vec<NurbsSurface>, SurfaceError> {
    let mut surfaces = vec![turned(BODY.0, &BODY.1)?];
    let bolt = turned(BOLT.0, &BOLT.1)?;
    for number in 0..BOLTS {
        let (sin, cos) = (TAU * f64::from(number) / f64::from(BOLTS)).sin_cos();
        let place = DVec3::new(BOLT_CIRCLE * cos, BOLT_CIRCLE * sin, 0.0);
        surfaces.push(bolt.transformed(&DAffine3::from_translation(place))?);
    }
    Ok(surfaces)
}

/// A profile turned about the z axis: degree 2 × 2, u around the axis in quarters, v along
/// the profile (Piegl & Tiller 1997, section 8.5).
fn turned(start: [f64; 2], stretches: &[Stretch]) -> Result<NurbsSurface, SurfaceError> {
    // Quadratic pieces: their inner points carry the weight of a quarter circle, or 1.
    let mut profile = vec![(DVec2::from_array(start), 1.0)];
    let mut last = DVec2::from_array(start);
    for &stretch in stretches {
        let (inner, weight, end) = match stretch {
            Line(r, z) => (0.5 * (last + DVec2::new(r, z)), 1.0, DVec2::new(r, z)),
            Corner(corner, end) => (corner.into(), FRAC_1_SQRT_2, end.into()),
        };
        profile.extend([(inner, weight), (end, 1.0)]);
        last = end;
    }
    // A square around the circle: its corners carry the weight.
    const SQUARE: [[f64; 2]; 9] = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
    ];
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (index, [x, y]) in SQUARE.into_iter().enumerate() {
        let around = if index % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 };
        for &(place, along) in &profile {
            points.push(DVec3::new(x * place.x, y * place.x, place.y));
            weights.push(around * along);
        }
    }
    let quarters = quadratic(4, Direction::U)?;
    NurbsSurface::new(quarters, quadratic(stretches.len(), Direction::V)?, points, Some(weights))
}

/// The knots of `pieces` quadratic pieces, one after the other.
fn quadratic(pieces: usize, direction: Direction) -> Result<KnotVector, SurfaceError> {
    let knots: Vec<(f64, usize)> =
        (0..=pieces).map(|k| (k as f64, if k == 0 || k == pieces { 3 } else { 2 })).collect();
    KnotVector::with_multiplicities(2, &knots)
        .map_err(|error| SurfaceError::Knots { direction, error })
}
