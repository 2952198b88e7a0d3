//! Models to measure with that are too large, or too plain, to be scenes.

mod part;

use glam::DVec3;
use nurbray::geometry::{Direction, KnotVector, NurbsSurface, SurfaceError, shapes};

/// The names of the models, and what they are.
pub(crate) const MODELS: [(&str, &str); 6] = [
    ("sphere", "a unit sphere, one bicubic rational surface of two pieces with two poles"),
    ("wave64", "a hilly bicubic B-spline of 64 x 64 pieces, each of them bent"),
    ("wave256", "the same hills in 256 x 256 pieces, each of them bent"),
    ("wave1024", "the same hills in a million pieces, made only if asked for"),
    ("quintic", "a B-spline of degree 5 x 5, 7 x 7 pieces"),
    ("part", "a flange with eight bolts, nine biquadratic rational surfaces of revolution"),
];

/// The surfaces of a model; `None` for other names.
pub(crate) fn surfaces(name: &str) -> Option<Result<Vec<NurbsSurface>, SurfaceError>> {
    let one = |surface: Result<NurbsSurface, SurfaceError>| surface.map(|surface| vec![surface]);
    let surfaces = match name {
        "sphere" => Ok(shapes::sphere(1.0).into_iter().collect()),
        "wave64" => one(wave(3, 64)),
        "wave256" => one(wave(3, 256)),
        "wave1024" => one(wave(3, 1024)),
        "quintic" => one(wave(5, 7)),
        "part" => part::flange(),
        _ => return None,
    };
    Some(surfaces)
}

/// A B-spline over `[-1, 1]²` of this degree, uniform and unclamped, of `pieces` × `pieces`
/// pieces: hills of two sizes, and every control point up to half a step too high or too low,
/// so that each piece bends, however many there are.
fn wave(degree: usize, pieces: usize) -> Result<NurbsSurface, SurfaceError> {
    let points = pieces + degree;
    let step = 2.0 / pieces as f64;
    let hills = |x: f64, y: f64| {
        0.15 * (3.1 * x + 0.3).sin() * (2.7 * y).cos()
            + 0.05 * (9.0 * x).sin() * (8.0 * y + 1.0).sin()
    };
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64 * step, j as f64 * step);
        let bump = step * (noise((i * points + j) as u64) - 0.5);
        // Where the basis function of the control point has its peak.
        let peak = 0.5 * (degree as f64 - 1.0) * step + 1.0;
        DVec3::new(x - peak, y - peak, hills(x, y) + bump)
    };
    let net = (0..points).flat_map(|i| (0..points).map(move |j| point(i, j)));
    let knots = |direction| {
        KnotVector::uniform(degree, points)
            .map_err(|error| SurfaceError::Knots { direction, error })
    };
    NurbsSurface::new(knots(Direction::U)?, knots(Direction::V)?, net.collect(), None)
}

/// A number from 0 to 1 that depends on the index alone: the mixing of SplitMix64 (Steele, Lea
/// and Flood 2014), but for its last shift.
fn noise(index: u64) -> f64 {
    let z = (index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z >> 11) as f64 / (1_u64 << 53) as f64
}
