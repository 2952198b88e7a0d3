//! Sweeps against what they should be: along lines, circles, and all other paths.

use glam::{DAffine3, DQuat, DVec2, DVec3};

use super::*;
use crate::geometry::NurbsCurve;
use crate::geometry::construct::frames::Frame;
use crate::geometry::shapes::{circle_arc, circle_cubic};

fn circle(radius: f64) -> NurbsCurve {
    circle_arc(radius, 0.0, 360.0).unwrap()
}

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=24).flat_map(|i| (0..=24).map(move |j| (f64::from(i) / 24.0, f64::from(j) / 24.0)))
}

/// The surface's point at shares of its domain.
fn at(sweep: &Sweep, (u, v): (f64, f64)) -> DVec3 {
    let [[a, b], [c, d]] = sweep.surface.domain();
    sweep.surface.point_at(DVec2::new(a + u * (b - a), c + v * (d - c)))
}

#[test]
fn along_a_line_a_circle_makes_a_cylinder_a_cone_or_a_trumpet() {
    for size in [1e-8, 1.0, 1e8] {
        let path = NurbsCurve::polyline(&[DVec3::Z * size, DVec3::Z * 4.0 * size]).unwrap();
        let scales = [vec![1.0], vec![1.0, 0.5], vec![1.0, 0.25, 0.0]];
        for scale in scales {
            let options = SweepOptions { scale: scale.clone(), ..SweepOptions::default() };
            let made = sweep(&circle(2.0 * size), &path, &options).unwrap();
            assert_eq!(made.deviation, 0.0);
            for (u, v) in grid() {
                let p = at(&made, (u, v)) / size;
                let radius = match scale.len() {
                    1 => 2.0,
                    2 => 2.0 - v,
                    _ => 2.0 * ((1.0 - v).powi(2) + 0.5 * v * (1.0 - v)),
                };
                assert!((p.truncate().length() - radius).abs() < 2e-15, "({u}, {v}): {p}");
                assert!((p.z - 1.0 - 3.0 * v).abs() < 2e-15);
            }
            let normal = made.surface.normal(DVec2::new(0.0, made.surface.domain()[1][0])).unwrap();
            assert!(normal.x > 0.4, "outward");
        }
    }
}

#[test]
fn along_circles_of_any_degree_a_circle_makes_an_exact_torus() {
    let place = DAffine3::from_rotation_translation(
        DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.1),
        DVec3::new(2.0, 1.0, -1.0),
    );
    for path in [circle_arc(3.0, 20.0, 300.0).unwrap(), circle_cubic()] {
        let path = path.transformed(&place).unwrap();
        let major = path.point_at(0.0).distance(place.transform_point3(DVec3::ZERO));
        let made = sweep(&circle(0.25), &path, &SweepOptions::default()).unwrap();
        assert_eq!(made.deviation, 0.0);
        let back = place.inverse();
        for (u, v) in grid() {
            let p = back.transform_point3(at(&made, (u, v)));
            let off = (p.truncate().length() - major).hypot(p.z) - 0.25;
            assert!(off.abs() < 1e-14, "({u}, {v}): off by {off:e}");
            // The profile is at the path's point of the same parameter.
            let along = path.point_at(path.domain()[0] + v * (path.domain()[1] - path.domain()[0]));
            assert!((at(&made, (u, v)).distance(along) - 0.25).abs() < 1e-14);
        }
    }
}

/// A helix as a spline, and a tube around it.
fn helix() -> NurbsCurve {
    let point = |k: i32| {
        let angle = f64::from(k) / 10.0;
        DVec3::new(angle.cos(), angle.sin(), 0.2 * angle)
    };
    NurbsCurve::through(&(0..=80).map(point).collect::<Vec<_>>(), 3).unwrap()
}

#[test]
fn what_is_not_rational_stays_within_its_tolerance() {
    let path = helix();
    let mut deviations = Vec::new();
    for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
        let options = SweepOptions { tolerance: Some(tolerance), ..SweepOptions::default() };
        let made = sweep(&circle(0.1), &path, &options).unwrap();
        assert!(made.deviation > 0.0 && made.deviation <= tolerance);
        // A tube: each point is 0.1 from the path's point of the same parameter, in the plane
        // across the path. Checked between the places at which the deviation was measured.
        let mut worst: f64 = 0.0;
        for (u, v) in (0..4000).map(|k| (f64::from(k % 7) / 7.0, (f64::from(k) + 0.5) / 4000.0)) {
            let t = v * path.domain()[1];
            let here = path.derivatives(t);
            let offset = at(&made, (u, v)) - here.point;
            let along = offset.dot(here.first.normalize());
            worst = worst.max((offset.length() - 0.1).hypot(along));
        }
        let rounding = 1e-14;
        assert!(worst <= made.deviation + rounding, "{worst:e} of {tolerance:e}");
        deviations.push(made.surface.size()[1]);
    }
    assert!(deviations.windows(2).all(|pair| pair[0] <= pair[1]), "{deviations:?}");
}

/// The default tolerance and all quantities compared with it scale with the size, also at a place a
/// thousand sizes away.
#[test]
fn sizes_and_places_do_not_matter() {
    for (size, away) in [(1e-8, 0.0), (1.0, 0.0), (1e8, 0.0), (1.0, 1e3)] {
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::splat(size),
            DQuat::IDENTITY,
            DVec3::new(away, -away, away) * size,
        );
        let path = helix().transformed(&place).unwrap();
        let made = sweep(&circle(0.1 * size), &path, &SweepOptions::default()).unwrap();
        // The default tolerance is a millionth of the documented size.
        let whole = sweep_size(&circle(0.1 * size), &path, &SweepOptions::default());
        let points = path.points();
        let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let diagonal = (high - low).length();
        assert!((whole / (diagonal + 0.1 * 2.0_f64.sqrt() * size) - 1.0).abs() < 1e-12);
        assert!(made.deviation <= 1e-6 * whole, "size {size}: {:e}", made.deviation);
        let relative = made.deviation / size;
        assert!(relative > 1e-8 && relative < 1e-5, "size {size}: {relative:e}");
        for (u, v) in grid() {
            let off = at(&made, (u, v)).distance(path.point_at(v * path.domain()[1])) / size - 0.1;
            assert!(off.abs() <= relative + 1e-12, "size {size}, ({u}, {v}): {off:e}");
        }
    }
}

#[test]
fn a_path_may_begin_and_end_at_rest() {
    // Triple end points: a uniform spline has zero speed at its ends.
    let points = [[2.0, 1.0], [5.0, 2.0], [6.0, 5.0], [8.0, 6.0], [5.0, 9.0]];
    let points = points.map(|[x, y]| DVec3::new(x, y, 0.0));
    let path = crate::geometry::with_repeated_ends(&points, [3, 3]).unwrap();
    let path = NurbsCurve::uniform_bspline(3, &path).unwrap();
    let made = sweep(&circle(0.1), &path, &SweepOptions::default()).unwrap();
    let off = |(u, v): (f64, f64)| {
        let t = path.domain()[0] + v * (path.domain()[1] - path.domain()[0]);
        (at(&made, (u, v)).distance(path.point_at(t)) - 0.1).abs()
    };
    let worst = grid().map(off).fold(0.0, f64::max);
    assert!(worst <= made.deviation && made.deviation < 2e-5, "{worst:e}, {:e}", made.deviation);
}

#[test]
fn twist_and_scale_do_what_they_say_along_a_line() {
    // A point of the profile becomes a helix on a cone.
    let profile = NurbsCurve::polyline(&[DVec3::X, DVec3::X * 2.0]).unwrap();
    let path = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::Z * 4.0]).unwrap();
    let options = SweepOptions {
        twist: 540.0,
        scale: vec![1.0, 0.5],
        tolerance: Some(1e-9),
        ..SweepOptions::default()
    };
    let made = sweep(&profile, &path, &options).unwrap();
    for (u, v) in grid() {
        let angle = 3.0 * std::f64::consts::PI * v;
        let radius = (1.0 + u) * (1.0 - 0.5 * v);
        let expected = DVec3::new(radius * angle.cos(), radius * angle.sin(), 4.0 * v);
        let off = at(&made, (u, v)).distance(expected);
        assert!(off <= made.deviation + 1e-14, "({u}, {v}): off by {off:e}");
    }
}

/// Frames computed independently: `r′ = −(r·t′) t` integrated by the classical Runge–Kutta method
/// in small steps. The whole sweep of a square, not only its distance from the path, is within the
/// reported deviation at many places of each piece.
#[test]
fn reported_deviations_hold_everywhere() {
    let wild =
        [[0.0, 0.0, 0.0], [3.0, 0.0, 1.0], [3.0, 3.0, -1.0], [0.0, 3.0, 2.0], [0.0, 0.0, 4.0]];
    let wild = NurbsCurve::bezier(&wild.map(DVec3::from)).unwrap();
    let square = [[0.2, 0.1], [-0.1, 0.2], [-0.2, -0.1], [0.1, -0.2], [0.2, 0.1]];
    let square = NurbsCurve::polyline(&square.map(|[x, y]| DVec3::new(x, y, 0.0))).unwrap();
    for (path, twist) in [(wild.clone(), 0.0), (wild, 200.0), (helix(), 0.0)] {
        for tolerance in [None, Some(1e-2), Some(1e-3), Some(1e-4), Some(1e-5)] {
            let options = SweepOptions { twist, tolerance, ..SweepOptions::default() };
            let made = sweep(&square, &path, &options).unwrap();
            let [start, end] = path.domain();
            let turn = |t: f64, r: DVec3| {
                let at = path.derivatives(t);
                let along = at.first.normalize();
                let bend = (at.second - at.second.dot(along) * along) / at.first.length();
                -r.dot(bend) * along
            };
            let steps = 20_000;
            let h = (end - start) / f64::from(steps);
            let mut r = Frame::first(&path, None).unwrap().normal;
            let mut worst: f64 = 0.0;
            for k in 0..steps {
                let t = start + h * f64::from(k);
                let share = (t - start) / (end - start);
                if k % 7 == 0 {
                    let at = path.derivatives(t);
                    let (sin, cos) = (twist.to_radians() * share).sin_cos();
                    let s = at.first.normalize().cross(r);
                    let (x, y) = (cos * r + sin * s, cos * s - sin * r);
                    for corner in 0..4 {
                        let p = square.vertex(corner);
                        let expected = at.point + p.x * x + p.y * y;
                        let [u, _] = square.domain();
                        let ours = made
                            .surface
                            .point_at(DVec2::new(u + corner as f64 * square_side(&square), t));
                        worst = worst.max(ours.distance(expected));
                    }
                }
                let k1 = turn(t, r);
                let k2 = turn(t + 0.5 * h, r + 0.5 * h * k1);
                let k3 = turn(t + 0.5 * h, r + 0.5 * h * k2);
                let k4 = turn((t + h).min(end), r + h * k3);
                r += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            }
            assert!(
                worst <= made.deviation + 1e-9,
                "{tolerance:?}: {worst:e}, {:e}",
                made.deviation
            );
            assert!(
                worst >= 0.5 * made.deviation,
                "{tolerance:?}: {worst:e}, {:e}",
                made.deviation
            );
        }
    }
}

/// The length of a square's side, which is also the length of its parameter interval in a polyline.
fn square_side(square: &NurbsCurve) -> f64 {
    square.vertex(0).distance(square.vertex(1))
}

#[test]
fn a_closed_path_closes_the_sweep() {
    // A closed space curve whose frame comes back turned.
    let point = |k: i32| {
        let angle = f64::from(k) * std::f64::consts::TAU / 24.0;
        DVec3::new(3.0 * angle.cos(), 2.0 * angle.sin(), (2.0 * angle).sin() + 0.5 * angle.cos())
    };
    let around: Vec<DVec3> = (0..27).map(|k| point(k % 24)).collect();
    let knots = crate::geometry::KnotVector::uniform(3, 27).unwrap();
    let path = NurbsCurve::new(knots, around, None).unwrap();
    let square = [[0.3, 0.0], [0.0, 0.3], [-0.3, 0.0], [0.0, -0.3], [0.3, 0.0]];
    let square = square.map(|[x, y]| DVec3::new(x, y, 0.0));
    let profile = NurbsCurve::polyline(&square).unwrap();
    let made = sweep(&profile, &path, &SweepOptions::default()).unwrap();
    let [nu, nv] = made.surface.size();
    for i in 0..nu {
        assert_eq!(made.surface.vertex(i, 0), made.surface.vertex(i, nv - 1));
    }
    assert!(made.deviation < 1e-5, "{}", made.deviation);
}

#[test]
fn what_cannot_be_swept() {
    let message = |profile: &NurbsCurve, path: &NurbsCurve, options: &SweepOptions| {
        sweep(profile, path, options).unwrap_err().to_string()
    };
    let plain = SweepOptions::default();
    let corner = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
    let polygon = NurbsCurve::polyline(&corner).unwrap();
    assert_eq!(
        message(&circle(0.1), &polygon, &plain),
        "the path has a kink of 90° at t = 1, (1, 0, 0): it must be smooth; split it there"
    );
    // An arc of radius 2 up to rounding.
    let folded = message(&circle(3.0), &circle(2.0), &plain);
    assert!(folded.starts_with(
        "the sweep folds, most of all at t = 0 of the path, (2, 0, 0): the path bends with radius 2"
    ));
    assert!(folded.ends_with("there, and the profile reaches 3 towards the centre"), "{folded}");
    let parabola = NurbsCurve::bezier(&[DVec3::ZERO, DVec3::X, DVec3::new(2.0, 0.0, 2.0)]).unwrap();
    // Tightest at its end, which is sampled slightly inside.
    let folded = message(&circle(4.0), &parabola, &plain);
    assert!(folded.starts_with("the sweep folds, most of all at t = 0.000976562 of"), "{folded}");
    // Four equal control points in a row: the path stands still for a span, and has a corner there.
    let still = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X, DVec3::X, DVec3::X, DVec3::ONE];
    let still = NurbsCurve::uniform_bspline(3, &still).unwrap();
    assert_eq!(
        message(&circle(0.1), &still, &plain),
        "the path has a kink of 120° at t = 6, (1, 0, 0): it must be smooth; split it there"
    );
    let nowhere = NurbsCurve::bezier(&[DVec3::X; 3]).unwrap();
    assert_eq!(
        message(&circle(0.1), &nowhere, &plain),
        "the path stands still at t = 0, (1, 0, 0): it has no direction there"
    );
    // Profiles that leave their plane, along a straight path.
    let upright = |points: &[[f64; 2]]| {
        let points: Vec<DVec3> = points.iter().map(|&[x, z]| DVec3::new(x, 0.0, z)).collect();
        NurbsCurve::polyline(&points).unwrap()
    };
    let straight = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::Y]).unwrap();
    let folded = message(&upright(&[[1.0, 0.0], [2.0, 1.0], [1.0, 2.0]]), &straight, &plain);
    assert!(folded.starts_with("profile: moved along (0, 0, 1) it covers itself"), "{folded}");
    // A beginning of unlimited curvature.
    let hook = NurbsCurve::bezier(&[DVec3::ZERO, DVec3::ZERO, DVec3::X, DVec3::ONE]).unwrap();
    assert!(message(&circle(0.1), &hook, &plain).contains("most of all at t = 0.0009"));
    let scaled = |scale: &[f64]| SweepOptions { scale: scale.to_vec(), ..plain.clone() };
    assert_eq!(
        message(&circle(0.1), &parabola, &scaled(&[1.0, -1.0])),
        "scale 1 is -1: it must be finite, and not negative"
    );
    assert_eq!(
        message(&circle(0.1), &parabola, &scaled(&[0.0, 0.0])),
        "the scale is 0 all along the path: one at least must be positive"
    );
    assert_eq!(
        message(&circle(0.1), &parabola, &scaled(&[])),
        "0 scales: there can be 1 to 33, as many as a curve of the largest degree has points"
    );
    assert!(sweep(&circle(0.1), &parabola, &scaled(&[1.0; MAX_SCALES])).is_ok());
    assert_eq!(
        message(&circle(0.1), &parabola, &scaled(&[1.0; MAX_SCALES + 1])),
        "34 scales: there can be 1 to 33, as many as a curve of the largest degree has points"
    );
    let fine = SweepOptions { tolerance: Some(1e-30), ..plain.clone() };
    assert!(message(&circle(0.1), &parabola, &fine).starts_with("the tolerance 1e-"));
    let none = SweepOptions { tolerance: Some(0.0), ..plain };
    assert_eq!(
        message(&circle(0.1), &parabola, &none),
        "tolerance 0: it must be positive and finite"
    );
}
