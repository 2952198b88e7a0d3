//! The source note's octant of a sphere as one quartic triangle.

use std::f64::consts::SQRT_2;

use glam::{DVec3, DVec4};

use super::{ShapeError, check_length};
use crate::geometry::TrianglePatch;

/// The octant `x, y, z ≥ 0` of a sphere around the origin as a rational quartic triangle,
/// symmetric in its three parameters, facing outward.
///
/// The corner `u = 1` is on the x axis, `v = 1` on the y axis, `w = 1 − u − v = 1` on the z
/// axis. Its sides are quarter circles of degree 4, those of
/// [`QuarticConstants`](super::QuarticConstants) with `w₁ = b₁/b₀`. D. Eberly,
/// "Representing a Circle or a Sphere with NURBS", 3.1.2, after Farin 1990; the constants
/// `a₀ … b₃` are right as printed there.
///
/// # Errors
/// When the radius is not positive and finite.
pub fn octant_quartic(radius: f64) -> Result<TrianglePatch, ShapeError> {
    check_length("radius", radius)?;
    let root = 3.0_f64.sqrt();
    let a0 = (root - 1.0) / root;
    let a1 = (root + 1.0) / (2.0 * root);
    let a2 = 1.0 - (5.0 - SQRT_2) * (7.0 - root) / 46.0;
    let b0 = 4.0 * root * (root - 1.0);
    let b1 = 3.0 * SQRT_2;
    let b2 = 4.0;
    let b3 = SQRT_2 * (3.0 + 2.0 * SQRT_2 - root) / root;

    // A coordinate depends on its own exponent and the largest one; the weight on the latter.
    let control = (0..=4).flat_map(|i| (0..=4 - i).map(move |j| [i, j, 4 - i - j])).map(|ijk| {
        let [i, j, k]: [usize; 3] = ijk;
        let largest = i.max(j).max(k);
        let inner = i.min(j).min(k) > 0;
        let coordinate = |exponent: usize| match (exponent, largest) {
            (0, _) => 0.0,
            (2, 2) if !inner => a1,
            (exponent, largest) if exponent == largest => 1.0,
            (_, 3) => a0,
            (_, _) => a2,
        };
        let weight = match largest {
            4 => b0,
            3 => b1,
            _ if !inner => b2,
            _ => b3,
        };
        let point: DVec3 = radius * DVec3::new(coordinate(i), coordinate(j), coordinate(k));
        (weight * point).extend(weight)
    });
    let control: Vec<DVec4> = control.collect();
    // The measures are checked and the numbers are known: this cannot fail but by the radius.
    TrianglePatch::from_homogeneous(4, control)
        .map_err(|_| ShapeError::Length { measure: "radius", value: radius })
}
