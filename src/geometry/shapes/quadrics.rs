//! Spheres and parts of them, and the plane.
//!
//! D. Eberly, "Representing a Circle or a Sphere with NURBS", 2003–2015 (its tables 2 and 3), with
//! [errata](crate::geometry::errata).

use glam::{DVec3, DVec4};

use super::{ShapeError, check_length, checked};
use crate::geometry::knots::unit_knots;
use crate::geometry::{KnotVector, NurbsSurface};

/// The half circle `x ≥ 0` from `(0, 1)` to `(0, −1)`, as `(x, y, w)` with `x`, `y` not yet
/// multiplied by `w`. On it `x² + y² = 1`, because the inner weights are 1/3 and their `x` is 2.
const HALF_CIRCLE: [(f64, f64, f64); 4] =
    [(0.0, 1.0, 1.0), (2.0, 1.0, 1.0 / 3.0), (2.0, -1.0, 1.0 / 3.0), (0.0, -1.0, 1.0)];

/// The circle in the plane of x and y that starts at `(1, 0)`, as `(x, y, w)` with `x`, `y` not yet
/// multiplied by `w`: two half circles.
const AROUND: [(f64, f64, f64); 7] = [
    (1.0, 0.0, 1.0),
    (1.0, 2.0, 1.0 / 3.0),
    (-1.0, 2.0, 1.0 / 3.0),
    (-1.0, 0.0, 1.0),
    (-1.0, -2.0, 1.0 / 3.0),
    (1.0, -2.0, 1.0 / 3.0),
    (1.0, 0.0, 1.0),
];

/// The sphere around the origin: bicubic, 4 × 7 control points.
///
/// `u` runs from the pole `+z` to the pole `−z`, `v` around, from `+x` over `+y`; both in
/// `[0, 1]`. The half planes of `v = 1/2` and of the seam `v = 0 = 1` are both at `y = 0`.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn sphere(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    let half = 0.5;
    let values = vec![0.0, 0.0, 0.0, 0.0, half, half, half, 1.0, 1.0, 1.0, 1.0];
    spherical(radius, KnotVector::derived(3, values), &AROUND)
}

/// Half of [`sphere`], `y ≥ 0`: a single bicubic piece of 4 × 4 control points.
///
/// `u` runs from the pole `+z` to the pole `−z`, `v` around, from `+x` over `+y` to `−x`.
/// It is [`hemisphere_inward`] with its parameters exchanged, which turns the normals outward.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn hemisphere(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    spherical(radius, unit_knots(3), &AROUND[..4])
}

/// The hemisphere with the parameters of Eberly's table 2, whose normals point *inward*: `u` runs
/// around, `v` from the pole `+z` to the pole `−z`.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn hemisphere_inward(radius: f64) -> Result<NurbsSurface, ShapeError> {
    Ok(hemisphere(radius)?.swapped())
}

/// The surface that is the product of the half circle from pole to pole and a circle around.
fn spherical(
    radius: f64,
    knots_v: KnotVector,
    around: &[(f64, f64, f64)],
) -> Result<NurbsSurface, ShapeError> {
    let control = HALF_CIRCLE.iter().flat_map(|&(r, z, weight)| {
        around.iter().map(move |&(x, y, w)| {
            let w = weight * w;
            (w * radius * DVec3::new(r * x, r * y, z)).extend(w)
        })
    });
    checked([unit_knots(3), knots_v], control.collect())
}

/// The octant `x, y, z ≥ 0` of a sphere around the origin, biquadratic, on the unit square.
///
/// `u` runs around from the plane `y = 0` to `x = 0`, `v` up from the equator `z = 0` to
/// the pole. It is [`octant_biquadratic_inward`] with its parameters exchanged, which turns the
/// normals outward.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn octant_biquadratic(radius: f64) -> Result<NurbsSurface, ShapeError> {
    Ok(octant_biquadratic_inward(radius)?.swapped())
}

/// The biquadratic octant with Eberly's parameters, whose normals point *inward*:
/// `((1−u²)(1−v²), (1−u²) 2v, 2u (1+v²)) / ((1+u²)(1+v²))` on the unit square.
///
/// `u = 1` is the pole, `v` runs around.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn octant_biquadratic_inward(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    // Bézier coefficients of 1 − t², 2t and 1 + t².
    let quarter = [(1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (0.0, 2.0, 2.0)];
    let control = quarter.iter().flat_map(|&(r, z, weight)| {
        quarter
            .iter()
            .map(move |&(x, y, w)| (radius * DVec3::new(r * x, r * y, z * w)).extend(weight * w))
    });
    checked([unit_knots(2), unit_knots(2)], control.collect())
}

/// The rectangle of this width (along x) and height (along y) around the origin in the
/// plane `z = 0`, facing `+z`; `(u, v)` in the unit square.
///
/// # Errors
/// When width or height is not from 1e-70 to 1e70.
pub fn plane(width: f64, height: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("width", width)?;
    check_length("height", height)?;
    let (x, y) = (width / 2.0, height / 2.0);
    let corner = |x, y| DVec4::new(x, y, 0.0, 1.0);
    let control = vec![corner(-x, -y), corner(-x, y), corner(x, -y), corner(x, y)];
    checked([unit_knots(1), unit_knots(1)], control)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn close(a: DVec3, b: [f64; 3]) {
        assert!((a - DVec3::from(b)).length() <= 1e-14 * a.length().max(1.0), "{a} is not {b:?}");
    }

    #[test]
    fn sphere_has_the_values_of_the_source_note() {
        let sphere = sphere(1.0).unwrap();
        let cases = [
            ((0.5, 0.25), [0., 1., 0.], [0., 0., -4.], [-8., 0., 0.]),
            (
                (0.25, 0.125),
                [12. / 25., 9. / 25., 4. / 5.],
                [256. / 125., 192. / 125., -48. / 25.],
                [-288. / 125., 384. / 125., 0.],
            ),
            (
                (1. / 3., 1. / 6.),
                [12. / 25., 16. / 25., 3. / 5.],
                [162. / 125., 216. / 125., -72. / 25.],
                [-576. / 125., 432. / 125., 0.],
            ),
            ((0.5, 0.75), [0., -1., 0.], [0., 0., -4.], [8., 0., 0.]),
            (
                (0.2, 0.875),
                [32. / 85., -24. / 85., 15. / 17.],
                [600. / 289., -450. / 289., -400. / 289.],
                [768. / 425., 1024. / 425., 0.],
            ),
            (
                (0.75, 0.625),
                [-12. / 25., -9. / 25., -4. / 5.],
                [256. / 125., 192. / 125., -48. / 25.],
                [288. / 125., -384. / 125., 0.],
            ),
        ];
        for ((u, v), point, du, dv) in cases {
            let s = sphere.derivatives(DVec2::new(u, v));
            close(s.point, point);
            close(s.du, du);
            close(s.dv, dv);
            close(sphere.normal(DVec2::new(u, v)).unwrap(), point);
        }
    }

    #[test]
    fn hemisphere_has_the_closed_form() {
        let inward = hemisphere_inward(1.0).unwrap();
        let outward = hemisphere(1.0).unwrap();
        close(inward.point_at(DVec2::new(0.25, 1.0 / 3.0)), [16. / 25., 12. / 25., 3. / 5.]);
        close(inward.point_at(DVec2::new(0.5, 0.5)), [0., 1., 0.]);
        for i in 0..=10 {
            for j in 0..=10 {
                let (u, v) = (f64::from(i) / 10.0, f64::from(j) / 10.0);
                let (wu, wv) = (2. * u * u - 2. * u + 1., 2. * v * v - 2. * v + 1.);
                let x = 2. * v * (2. * u - 1.) * (v - 1.) / (wu * wv);
                let y = 4. * u * v * (u - 1.) * (v - 1.) / (wu * wv);
                let z = (1. - 2. * v) / wv;
                close(inward.point_at(DVec2::new(u, v)), [x, y, z]);
                close(inward.normal(DVec2::new(u, v)).unwrap(), [-x, -y, -z]);
                close(outward.normal(DVec2::new(v, u)).unwrap(), [x, y, z]);
            }
        }
    }

    #[test]
    fn octants_differ_by_their_parameters_only() {
        let inward = octant_biquadratic_inward(1.0).unwrap();
        close(inward.point_at(DVec2::new(0.5, 0.5)), [9. / 25., 12. / 25., 4. / 5.]);
        close(inward.point_at(DVec2::new(1.0 / 3.0, 0.5)), [12. / 25., 16. / 25., 3. / 5.]);
        let octant = octant_biquadratic(1.0).unwrap();
        for i in 0..=10 {
            for j in 0..=10 {
                let (u, v) = (f64::from(i) / 10.0, f64::from(j) / 10.0);
                let point = inward.point_at(DVec2::new(u, v));
                assert!((point.length() - 1.0).abs() < 1e-15);
                assert!((octant.point_at(DVec2::new(v, u)) - point).length() < 1e-15);
                close(inward.normal(DVec2::new(u, v)).unwrap(), (-point).into());
                close(octant.normal(DVec2::new(v, u)).unwrap(), point.into());
            }
        }
    }

    #[test]
    fn spheres_are_round_at_every_scale() {
        for radius in [1e-8, 0.3, 1.0, 1e8] {
            let sphere = sphere(radius).unwrap();
            for i in 0..=30 {
                for j in 0..=30 {
                    let point =
                        sphere.point_at(DVec2::new(f64::from(i) / 30.0, f64::from(j) / 30.0));
                    assert!((point.length() / radius - 1.0).abs() < 1e-15, "{point}");
                }
            }
        }
    }

    #[test]
    fn measures_must_be_lengths() {
        assert_eq!(
            sphere(-1.0).unwrap_err().to_string(),
            "radius -1: it must be positive and finite (from 1e-70 to 1e70)"
        );
        for bad in [0.0, f64::NAN, f64::INFINITY, 1e200] {
            assert!(hemisphere(bad).is_err() && octant_biquadratic(bad).is_err());
            assert!(plane(bad, 1.0).is_err() && plane(1.0, bad).is_err());
        }
    }
}
