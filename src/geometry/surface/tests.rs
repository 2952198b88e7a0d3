//! Surfaces: refused input, properties that operations keep, and values of derivatives.

use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4};

use crate::geometry::*;

fn knots(degree: usize, points: usize) -> KnotVector {
    KnotVector::clamped_uniform(degree, points).unwrap()
}

fn net(nu: usize, nv: usize) -> Vec<DVec3> {
    (0..nu * nv).map(|k| DVec3::new((k / nv) as f64, (k % nv) as f64, 0.0)).collect()
}

#[test]
fn points_and_weights_are_those_of_the_indices() {
    let weights: Vec<f64> = (0..12).map(|k| 2f64.powi(k % 3)).collect();
    let surface = NurbsSurface::new(knots(2, 3), knots(1, 4), net(3, 4), Some(weights.clone()));
    let surface = surface.unwrap();
    assert_eq!(surface.degree(), [2, 1]);
    assert_eq!(surface.points().collect::<Vec<_>>(), net(3, 4));
    assert_eq!(surface.points().nth(6), surface.point(1, 2));
    assert_eq!(surface.weights().collect::<Vec<_>>(), weights);
}

#[test]
fn errors_name_the_control_point() {
    let message = |points: Vec<DVec3>, weights: Option<Vec<f64>>| {
        NurbsSurface::new(knots(2, 3), knots(1, 4), points, weights).unwrap_err().to_string()
    };
    assert_eq!(message(net(3, 3), None), "9 control points, but the knots need 3 × 4 of them");
    assert_eq!(
        message(net(3, 4), Some(vec![1.0; 11])),
        "11 weights for 12 control points: each needs one, or none has any"
    );
    for (weight, shown) in [(0.0, "0"), (-2.0, "-2"), (f64::NAN, "NaN"), (1e200, "1e200")] {
        let mut weights = vec![1.0; 12];
        weights[6] = weight;
        assert_eq!(
            message(net(3, 4), Some(weights)),
            format!(
                "the weight of control point (1, 2) is {shown}: \
                 it must be positive and finite (from 1e-70 to 1e70)"
            )
        );
    }
    let mut points = net(3, 4);
    points[11].y = f64::NEG_INFINITY;
    assert_eq!(
        message(points, Some(vec![2.0; 12])),
        "control point (2, 3) is (2, -inf, 0): coordinates must be finite (up to 1e70)"
    );
    assert_eq!(
        message(vec![DVec3::ONE; 12], Some((1..=12).map(f64::from).collect())),
        "all control points are (1, 1, 1): the surface has no extent"
    );
    assert_eq!(
        message((0..12).map(|k| DVec3::new(f64::from(k), 0.0, 1e-15)).collect(), None),
        "all control points lie on the line from (0, 0, 1e-15) to (11, 0, 1e-15), to within \
         rounding: the surface has no area"
    );
    let mut points = net(3, 4);
    points[5].x = 1e308;
    assert_eq!(
        message(points, None),
        "control point (1, 1) is (1e308, 1, 0): coordinates must be finite (up to 1e70)"
    );
    assert_eq!(
        message(net(3, 4).iter().map(|p| p / 1e80).collect(), None),
        "the control points span 3e-80: at least 1e-70 is needed"
    );
}

#[test]
fn domains_have_lengths_that_derivatives_can_be_divided_by() {
    for (length, usable) in [(1e-71, false), (1e-70, true), (1e70, true), (1e71, false)] {
        let long = KnotVector::new(1, vec![0.0, 0.0, length, length]).unwrap();
        let surface = NurbsSurface::new(long, knots(1, 2), net(2, 2), None);
        assert_eq!(surface.is_ok(), usable, "{length}");
        if length > 1e70 {
            assert_eq!(
                surface.unwrap_err().to_string(),
                "direction u: the domain runs from 0 to 1e71: lengths from 1e-70 to 1e70 are \
                 supported"
            );
        }
    }
}

#[test]
fn operations_refuse_what_they_cannot_do() {
    let plane = shapes::plane(1.0, 1.0).unwrap();
    assert_eq!(
        plane.split_v(1.0).unwrap_err().to_string(),
        "direction v: the parameter 1 does not lie inside the domain from 0 to 1"
    );
    assert!(matches!(plane.split_u(f64::NAN), Err(SurfaceError::Parameter { .. })));
    assert!(matches!(plane.insert_knot_u(-0.1, 1), Err(SurfaceError::Parameter { .. })));
    assert_eq!(
        plane.insert_knot_u(0.5, 3).unwrap_err().to_string(),
        "direction u: knot 0.5 is repeated 3 times: degree 1 allows up to 2"
    );
    assert!(plane.insert_knot_u(0.5, usize::MAX).is_err());
    assert_eq!(
        plane.elevated_v(32).unwrap_err().to_string(),
        "direction v: degree 33: degrees from 1 to 32 are supported"
    );
    assert!(plane.elevated_u(usize::MAX).is_err());
    let flat = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)));
    assert_eq!(
        plane.transformed(&flat).unwrap_err().to_string(),
        "the transform's determinant is 0: it must be neither 0 nor infinite"
    );
    for number in [f64::NAN, f64::INFINITY] {
        let moved = DAffine3::from_translation(DVec3::new(number, 0.0, 0.0));
        let scaled = DAffine3::from_scale(DVec3::new(1.0, number, 1.0));
        for map in [moved, scaled] {
            assert_eq!(
                plane.transformed(&map).unwrap_err().to_string(),
                "the transform is not finite: all of its numbers must be"
            );
        }
    }
    let huge = DAffine3::from_scale(DVec3::splat(1e300));
    assert!(plane.transformed(&huge).is_err());
}

#[test]
fn control_points_are_named_by_both_indices() {
    let surface = NurbsSurface::new(knots(2, 9), knots(2, 9), net(9, 9), None).unwrap();
    assert_eq!((surface.point(8, 8), surface.weight(8, 8)), (Some(net(9, 9)[80]), Some(1.0)));
    for (i, j) in [(0, 10), (0, 9), (9, 0), (usize::MAX, usize::MAX)] {
        assert_eq!((surface.point(i, j), surface.weight(i, j)), (None, None), "({i}, {j})");
    }
}

/// A piece that is only a point cannot be a surface of its own.
#[test]
fn a_part_without_extent_cannot_be_split_off() {
    let knots_u = KnotVector::new(1, vec![0., 0., 1., 2., 2.]).unwrap();
    let points = vec![DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::X, DVec3::Y];
    let surface = NurbsSurface::new(knots_u, knots(1, 2), points, None).unwrap();
    assert!(matches!(surface.split_u(1.0), Err(SurfaceError::NoExtent { .. })));
    assert!(surface.split_u(1.5).is_ok());
}

#[test]
fn a_part_whose_domain_is_too_short_cannot_be_split_off() {
    let knots_u = KnotVector::new(1, vec![0., 0., 1e-80, 1., 1.]).unwrap();
    let points = (0..6).map(|k| DVec3::new((k / 2).into(), (k % 2).into(), 0.0)).collect();
    let surface = NurbsSurface::new(knots_u, knots(1, 2), points, None).unwrap();
    assert!(matches!(surface.split_u(1e-80), Err(SurfaceError::Domain { .. })));
    assert!(surface.split_u(0.5).is_ok());
}

/// Equal weights stay equal, flat stays flat, collapsed stays collapsed: bit for bit.
#[test]
fn what_is_exact_stays_exact() {
    let weights = Some(vec![1.0 / 3.0; 30]);
    let points = net(5, 6).iter().map(|p| p + 0.1).collect();
    let flat = NurbsSurface::new(KnotVector::uniform(3, 5).unwrap(), knots(2, 6), points, weights);
    let flat = flat.unwrap();
    assert!(!flat.is_rational());
    let steps = flat.insert_knot_u(3.3, 2).unwrap().elevated_u(2).unwrap().elevated_v(1).unwrap();
    let steps = steps.split_v(0.37).unwrap().0.bezier_form();
    assert!(!steps.is_rational());
    assert!(steps.control().iter().all(|p| p.z == flat.control()[0].z));

    let steps = shapes::sphere(1.0).unwrap().insert_knot_v(0.3, 2).unwrap();
    let steps = steps.elevated_v(3).unwrap().split_u(0.4).unwrap().0.elevated_u(2).unwrap();
    let [_, nv] = steps.size();
    assert!((0..nv).all(|j| steps.vertex(0, j) == DVec3::Z));
}

#[test]
fn domains_are_moved_with_their_knots() {
    let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.25, 1.0, 1.0, 1.0]).unwrap();
    let surface = NurbsSurface::new(u, knots(1, 3), net(4, 3), None).unwrap();
    let moved = surface.on_domain([[-2.0, 6.0], [10.0, 11.0]]).unwrap();
    assert_eq!(moved.domain(), [[-2.0, 6.0], [10.0, 11.0]]);
    assert_eq!(moved.control(), surface.control());
    for (u, v) in [(0.0, 0.0), (0.125, 0.5), (0.25, 0.75), (1.0, 1.0)] {
        assert_eq!(
            moved.point_at(DVec2::new(8.0 * u - 2.0, v + 10.0)),
            surface.point_at(DVec2::new(u, v))
        );
    }
    assert_eq!(surface.on_domain(surface.domain()), Ok(surface.clone()));
    let message = |domain| surface.on_domain(domain).unwrap_err().to_string();
    assert_eq!(
        message([[0.0, 1.0], [2.0, 1.0]]),
        "direction v: the domain goes from 2 to 1: its length must be positive and finite"
    );
    assert_eq!(
        message([[0.0, 1e80], [0.0, 1.0]]),
        "direction u: the domain runs from 0 to 1e80: lengths from 1e-70 to 1e70 are supported"
    );
}

#[test]
fn accessors_read_the_net_v_fastest() {
    let weights: Vec<f64> = (1..=12).map(f64::from).collect();
    let surface = NurbsSurface::new(knots(2, 3), knots(1, 4), net(3, 4), Some(weights)).unwrap();
    assert_eq!((surface.size(), surface.is_rational()), ([3, 4], true));
    assert_eq!(
        (surface.vertex(2, 1), surface.weight(2, 1)),
        (DVec3::new(2.0, 1.0, 0.0), Some(10.0))
    );
    assert_eq!(surface.control()[9], DVec4::new(20.0, 10.0, 0.0, 10.0));
    assert_eq!(surface.knots(Direction::U), surface.knots_u());
    assert_eq!(surface.knots(Direction::V), surface.knots_v());
    let swapped = surface.swapped();
    assert_eq!((swapped.point(1, 2), swapped.weight(1, 2)), (surface.point(2, 1), Some(10.0)));
    assert_eq!(swapped.swapped(), surface);
    assert_eq!(surface.reversed_u().point(0, 1), surface.point(2, 1));
    assert_eq!(surface.reversed_v().point(2, 2), surface.point(2, 1));
    assert_eq!(surface.reversed_u().reversed_u(), surface);
    assert_eq!(
        surface.reversed_v().point_at(DVec2::new(0.25, 0.125)),
        surface.point_at(DVec2::new(0.25, 0.875))
    );
}

/// `S = (u, v, 0) / (1 + u v)`, whose derivatives have closed forms, at every scale.
#[test]
fn rational_surfaces_follow_the_quotient_rule() {
    for scale in [1e-8, 1.0, 1e8] {
        let control = vec![
            DVec4::new(0.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, scale, 0.0, 1.0),
            DVec4::new(scale, 0.0, 0.0, 1.0),
            DVec4::new(scale, scale, 0.0, 2.0),
        ];
        let bezier = KnotVector::bezier(1).unwrap();
        let surface = NurbsSurface::from_homogeneous(bezier.clone(), bezier, control).unwrap();
        let surface = surface.elevated_u(2).unwrap().elevated_v(1).unwrap();
        for (u, v) in [(0.0, 0.0), (0.3, 0.8), (0.5, 0.5), (1.0, 0.2), (1.0, 1.0)] {
            let w: f64 = 1.0 + u * v;
            let s = surface.derivatives(DVec2::new(u, v));
            let near = |a: DVec3, x: f64, y: f64| {
                let off = (a / scale - DVec3::new(x, y, 0.0)).length();
                assert!(off < 4e-14, "({u}, {v}) at {scale}: {a} is not ({x}, {y})");
            };
            near(surface.point_at(DVec2::new(u, v)), u / w, v / w);
            near(s.point, u / w, v / w);
            near(s.du, 1.0 / w.powi(2), -v * v / w.powi(2));
            near(s.dv, -u * u / w.powi(2), 1.0 / w.powi(2));
            near(s.duu, -2.0 * v / w.powi(3), 2.0 * v.powi(3) / w.powi(3));
            near(s.duv, -2.0 * u / w.powi(3), -2.0 * v / w.powi(3));
            near(s.dvv, 2.0 * u.powi(3) / w.powi(3), -2.0 * u / w.powi(3));
        }
    }
}

/// A map that mirrors keeps the parameters, and so turns the normals to the other side.
#[test]
fn maps_move_points_and_normals() {
    let sphere = shapes::sphere(1.0).unwrap();
    let turn = DAffine3::from_rotation_z(0.7);
    let stretch = DAffine3::from_scale(DVec3::new(1.0, 2.0, 0.5));
    let map = DAffine3::from_translation(DVec3::new(3.0, -1.0, 2.0)) * turn * stretch;
    let moved = sphere.transformed(&map).unwrap();
    let cofactor = map.matrix3.inverse().transpose();
    let mirror = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let mirrored = sphere.transformed(&mirror).unwrap();
    for (u, v) in [(0.0, 0.2), (0.3, 0.4), (0.8, 0.9), (1.0, 1.0)] {
        let point = sphere.point_at(DVec2::new(u, v));
        assert!((moved.point_at(DVec2::new(u, v)) - map.transform_point3(point)).length() < 1e-14);
        let normal = (cofactor * point).normalize();
        assert!((moved.normal(DVec2::new(u, v)).unwrap() - normal).length() < 1e-13);
        let out = mirrored.point_at(DVec2::new(u, v));
        assert!((mirrored.normal(DVec2::new(u, v)).unwrap() + out).length() < 1e-13);
    }
}

/// At ends, at knots, off the domain, and at NaN.
#[test]
fn points_on_a_grid_are_the_points() {
    let points: Vec<_> = net(6, 5).iter().map(|p| p + DVec3::Z * (p.x * p.y).sin()).collect();
    let weights = (0..30).map(|k| 1.0 + f64::from(k % 7)).collect();
    let surface = NurbsSurface::new(knots(3, 6), knots(2, 5), points, Some(weights)).unwrap();
    let us = [0.0, 0.1, 1.0 / 3.0, 0.9, 1.0, 1.25, f64::NAN];
    let vs = [1.0, 2.0 / 3.0, 0.5, 0.0, -0.25];
    let bits = |point: DVec3| point.to_array().map(f64::to_bits);
    let grid: Vec<_> = surface.points_at(&us, &vs).into_iter().map(bits).collect();
    let one_by_one = us.iter().flat_map(|&u| vs.map(|v| bits(surface.point_at(DVec2::new(u, v)))));
    assert_eq!(grid, one_by_one.collect::<Vec<_>>());
    assert_eq!(surface.points_at(&us, &[]), []);
}
