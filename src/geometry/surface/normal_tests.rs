//! Normals: right at collapsed edges, poles and corners with parallel tangents, at every
//! scale of model and parameters, and absent where there is none.

use std::ops::Range;

use glam::{DAffine3, DVec2, DVec3};

use crate::geometry::*;

fn scaled(surface: &NurbsSurface, scale: f64, shift: DVec3) -> NurbsSurface {
    let map = DAffine3::from_scale(DVec3::splat(scale));
    surface.transformed(&(DAffine3::from_translation(shift) * map)).unwrap()
}

/// The same surface over stretched parameters.
fn stretched(surface: &NurbsSurface, by_u: f64, by_v: f64) -> NurbsSurface {
    let stretch = |knots: &KnotVector, by: f64| {
        let values = knots.values().iter().map(|t| by * t).collect();
        KnotVector::new(knots.degree(), values).unwrap()
    };
    let (u, v) = (stretch(surface.knots_u(), by_u), stretch(surface.knots_v(), by_v));
    NurbsSurface::from_homogeneous(u, v, surface.control().to_vec()).unwrap()
}

/// Parameters at both ends of a domain, closer and closer to them, and between.
fn to_the_ends([a, b]: [f64; 2]) -> impl Iterator<Item = f64> {
    let inside = [0.0, 1e-300, 1e-17, 1e-15, 1e-13, 1e-11, 1e-9, 1e-6, 1e-3, 0.3, 0.5, 0.87];
    inside.into_iter().flat_map(move |s| [a + s * (b - a), b - s * (b - a)])
}

/// The largest error of a sphere's normals, except between the distances `hidden` (in
/// radii) from a pole.
fn worst_normal(sphere: &NurbsSurface, center: DVec3, hidden: Range<f64>) -> f64 {
    let [domain_u, domain_v] = sphere.domain();
    let mut worst: f64 = 0.0;
    for u in to_the_ends(domain_u) {
        for v in to_the_ends(domain_v) {
            let out = (sphere.point_at(DVec2::new(u, v)) - center).normalize();
            let from_pole = out.truncate().length();
            if !hidden.contains(&from_pole) {
                let off =
                    sphere.normal(DVec2::new(u, v)).map_or(2.0, |normal| (normal - out).length());
                worst = worst.max(off);
            }
        }
    }
    worst
}

fn spheres() -> [NurbsSurface; 3] {
    [shapes::sphere(1.0), shapes::sphere_biquadratic(1.0), shapes::hemisphere(1.0)]
        .map(Result::unwrap)
}

#[test]
fn spheres_have_outward_normals_at_their_poles_and_everywhere() {
    for sphere in spheres() {
        let right = |sphere: &NurbsSurface| {
            let worst = worst_normal(sphere, DVec3::ZERO, 0.0..0.0);
            assert!(worst < 1e-13, "off by {worst:e}: {sphere:?}");
        };
        right(&sphere);
        right(&sphere.insert_knot_u(0.3, 1).unwrap().insert_knot_v(0.6, 2).unwrap());
        for power in [-30, 30] {
            right(&scaled(&sphere, 2.0_f64.powi(power), DVec3::ZERO)); // without rounding
        }
        for (by_u, by_v) in [(1e6, 1e-6), (1e-6, 1e6), (1e8, 1e8), (1e-8, 1e-8)] {
            right(&stretched(&sphere, by_u, by_v));
        }
        right(&sphere.reversed_u().reversed_v());
    }
}

/// Where the points of a pole were rounded after their multiplication by different weights,
/// they no longer coincide: the surface as stored has a pole of the size of the rounding,
/// and its normals turn away within a few thousand such sizes.
#[test]
fn poles_that_collapse_up_to_rounding_have_their_normals() {
    let far = DVec3::new(1e6, -3e5, 7e5);
    for sphere in spheres() {
        for (scale, shift) in [(1e-8, 0.0), (0.7, 0.0), (1e8, 0.0), (1.0, 1.0), (0.03, 1.0)] {
            let moved = scaled(&sphere, scale, shift * far);
            let rounding = f64::EPSILON * (1.0 + shift * 1e6 / scale);
            let at_pole = 4.0 * rounding;
            for (from, tolerance) in [(2.0, 300.0 * rounding), (1e-3, 1e5 * rounding)] {
                let worst = worst_normal(&moved, shift * far, at_pole..from);
                assert!(worst < tolerance, "{scale}, {shift}, {from}: off by {worst:e}");
            }
        }
    }
}

#[test]
fn the_octant_faces_outward_up_to_its_pole() {
    let octant = shapes::octant_biquadratic(2.0).unwrap();
    assert!(worst_normal(&octant, DVec3::ZERO, 0.0..0.0) < 1e-13);
    assert_eq!(octant.normal(DVec2::new(0.3, 1.0)).unwrap(), DVec3::Z);
}

#[test]
fn the_tip_of_a_cone_has_the_limit_along_each_ruling() {
    let cone = shapes::cone(1.0, 2.0).unwrap();
    for u in [0.0, 0.1, 0.25, 0.6, 1.0] {
        let (tip, below) =
            (cone.normal(DVec2::new(u, 1.0)).unwrap(), cone.normal(DVec2::new(u, 0.5)).unwrap());
        assert!((tip - below).length() < 1e-13, "u = {u}: {tip} is not {below}");
        let near = cone.normal(DVec2::new(u, 1.0 - 1e-15)).unwrap();
        assert!((near - below).length() < 1e-13, "u = {u}: {near} is not {below}");
    }
}

/// Two cones that touch with their tips at an inner knot have no normal there.
#[test]
fn a_tip_within_the_domain_has_no_normal() {
    let side = shapes::cone(1.0, 1.0).unwrap();
    let knots = KnotVector::new(1, vec![0., 0., 0.5, 1., 1.]).unwrap();
    let control = side.control().chunks(2).flat_map(|pair| {
        let beyond = 2.0 * pair[1] - pair[0];
        [pair[0], pair[1], beyond]
    });
    let double =
        NurbsSurface::from_homogeneous(side.knots_u().clone(), knots, control.collect()).unwrap();
    assert_eq!(double.normal(DVec2::new(0.3, 0.5)), None);
    assert!(double.normal(DVec2::new(0.3, 0.4)).is_some());
    assert!(double.normal(DVec2::new(0.3, 0.6)).is_some());
}

#[test]
fn the_center_of_a_disk_faces_as_the_disk_does() {
    let disk = shapes::disk(3.0).unwrap();
    for u in [0.0, 1e-20, 1e-10, 0.5, 1.0] {
        for v in [0.0, 0.125, 0.25, 0.7, 1.0] {
            assert_eq!(disk.normal(DVec2::new(u, v)).unwrap(), DVec3::Z, "({u}, {v})");
        }
    }
}

/// A disk as one biquadratic patch: at its four corners both tangents are those of the rim.
#[test]
fn corners_with_parallel_tangents_have_the_normal_of_their_inside() {
    let c = std::f64::consts::FRAC_1_SQRT_2;
    for lift in [0.0, 0.25] {
        let at = |x: f64, y: f64| DVec3::new(x, y, lift * x * y);
        let points = vec![
            at(-c, -c),
            at(0.0, -2.0 * c),
            at(c, -c),
            at(-2.0 * c, 0.0),
            at(0.0, 0.0),
            at(2.0 * c, 0.0),
            at(-c, c),
            at(0.0, 2.0 * c),
            at(c, c),
        ];
        let weights = vec![1.0, c, 1.0, c, 1.0, c, 1.0, c, 1.0];
        let knots = KnotVector::bezier(2).unwrap();
        let disk = NurbsSurface::new(knots.clone(), knots, points, Some(weights)).unwrap();
        for (u, v, h, k) in
            [(0., 0., 1., 1.), (1., 0., -1., 1.), (0., 1., 1., -1.), (1., 1., -1., -1.)]
        {
            let corner = disk.normal(DVec2::new(u, v)).unwrap();
            let inside = disk.normal(DVec2::new(u + 1e-5 * h, v + 1e-5 * k)).unwrap();
            assert!((corner - inside).length() < 1e-3, "({u}, {v}): {corner}, inside {inside}");
        }
    }
}

/// Three control points of a corner in one place: both first derivatives vanish there.
#[test]
fn second_derivatives_decide_where_both_first_ones_vanish() {
    for scale in [1e-8, 1.0, 1e8] {
        let mut points: Vec<DVec3> =
            (0..9).map(|k| scale * DVec3::new(f64::from(k / 3), f64::from(k % 3), 0.0)).collect();
        points[1] = points[0];
        points[3] = points[0];
        let knots = KnotVector::bezier(2).unwrap();
        let corner = NurbsSurface::new(knots.clone(), knots, points, None).unwrap();
        assert_eq!(corner.normal(DVec2::ZERO).unwrap(), DVec3::Z);
        assert_eq!(corner.reversed_u().normal(DVec2::new(1.0, 0.0)).unwrap(), DVec3::NEG_Z);
    }
}

/// Derivatives as long as allowed sizes and domains make them, whose squares f64 does not hold.
#[test]
fn no_length_is_too_long() {
    let knots = || [2, 1].map(|degree| KnotVector::bezier(degree).unwrap());
    for (size, length) in [(1.0, 1.0), (1e15, 1e-70), (1e60, 1e-50), (1e69, 1e-45), (1e-60, 1e70)] {
        let row = |x: f64| [0.0, 1.0].map(|y| size * DVec3::new(x, y, 0.0));
        let points = [0.0, 1.0, 1.2].into_iter().flat_map(row).collect();
        let [knots_u, knots_v] = knots();
        let flat = NurbsSurface::new(knots_u, knots_v, points, None).unwrap();
        let flat = flat.on_domain([[0.0, length], [0.0, 1.0]]).unwrap();
        for u in [0.0, 0.5 * length, length] {
            assert_eq!(
                flat.normal(DVec2::new(u, 0.4)),
                Some(DVec3::Z),
                "{size:e} {length:e} {u:e}"
            );
        }
    }
    let heavy = Some(vec![1e-61, 1e-61, 1e60, 1e60]);
    let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
    let linear = || KnotVector::bezier(1).unwrap();
    let quick = NurbsSurface::new(linear(), linear(), points, heavy).unwrap();
    assert_eq!(quick.normal(DVec2::new(0.0, 0.4)), Some(DVec3::Z));
}

#[test]
fn no_limit_is_no_normal() {
    let sphere = shapes::sphere(1.0).unwrap();
    assert_eq!(sphere.normal(DVec2::new(f64::NAN, 0.3)), None);
    let pole = sphere.derivatives(DVec2::new(0.0, 0.3));
    assert_eq!(pole.unit_normal(DVec2::ZERO), None);
    assert_eq!(pole.unit_normal(DVec2::new(0.0, 1.0)), None);
    let up = pole.unit_normal(DVec2::X).unwrap();
    assert!((up - DVec3::Z).length() < 1e-15);
    assert_eq!(pole.unit_normal(DVec2::NEG_X).unwrap(), -up);
    // A surface that is only a curve has no normal anywhere.
    let knots = [2, 1].map(|degree| KnotVector::bezier(degree).unwrap());
    let points = [DVec3::ZERO, DVec3::X, DVec3::ONE].into_iter().flat_map(|p| [p, p]);
    let [knots_u, knots_v] = knots;
    let curve = NurbsSurface::new(knots_u, knots_v, points.collect(), None).unwrap();
    assert_eq!(curve.normal(DVec2::new(0.3, 0.3)), None);
    assert_eq!(curve.normal(DVec2::ZERO), None);
}

#[test]
fn shapes_face_outward() {
    let torus = shapes::torus(2.0, 0.5).unwrap();
    let cylinder = shapes::cylinder(1.5, 3.0).unwrap();
    let plane = shapes::plane(2.0, 3.0).unwrap();
    for i in 0..=20 {
        for j in 0..=20 {
            let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
            let ring = |p: DVec3| 2.0 * DVec3::new(p.x, p.y, 0.0).normalize();
            let p = torus.point_at(DVec2::new(u, v));
            assert!((p.distance(ring(p)) - 0.5).abs() < 1e-15 * 4.0);
            assert!(
                (torus.normal(DVec2::new(u, v)).unwrap() - (p - ring(p)) / 0.5).length() < 1e-14
            );
            let p = cylinder.point_at(DVec2::new(u, v));
            let axis = DVec3::new(0.0, 0.0, p.z);
            assert!((p.distance(axis) - 1.5).abs() < 1e-15 * 4.0 && (p.z - 3.0 * v).abs() < 1e-15);
            assert!(
                (cylinder.normal(DVec2::new(u, v)).unwrap() - (p - axis) / 1.5).length() < 1e-14
            );
            assert_eq!(plane.normal(DVec2::new(u, v)).unwrap(), DVec3::Z);
        }
    }
    let cone = shapes::cone(1.0, 1.0).unwrap();
    let slant = std::f64::consts::FRAC_1_SQRT_2;
    assert!(
        (cone.normal(DVec2::new(0.0, 0.5)).unwrap() - DVec3::new(slant, 0.0, slant)).length()
            < 1e-15
    );
}
