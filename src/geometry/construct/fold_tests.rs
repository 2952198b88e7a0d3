//! What folds, and what only looks like it.

use glam::{DAffine3, DQuat, DVec3};

use super::Axis;
use super::fold::*;
use super::{Borders, ConstructError, coons, extrude, loft, ruled};
use crate::geometry::curve::{Course, Fold};
use crate::geometry::shapes::{circle_arc, circle_cubic};
use crate::geometry::{KnotVector, NurbsCurve, NurbsSurface};
use crate::math::bernstein::binomial;

fn plane(points: &[[f64; 2]]) -> Vec<DVec3> {
    points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
}

fn polyline(points: &[[f64; 2]]) -> NurbsCurve {
    NurbsCurve::polyline(&plane(points)).unwrap()
}

fn bezier(points: &[[f64; 2]]) -> NurbsCurve {
    NurbsCurve::bezier(&plane(points)).unwrap()
}

fn fold(curve: &NurbsCurve) -> Option<Fold> {
    Course::in_space(curve).fold()
}

/// The curve at several positions, sizes and rotations.
fn everywhere(curve: &NurbsCurve) -> Vec<NurbsCurve> {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let maps = [1e-8, 1.0, 1e8].map(|size| {
        let at = DVec3::new(0.3, -2.0, 1.0) * size;
        DAffine3::from_scale_rotation_translation(DVec3::splat(size), turn, at)
    });
    let placed = maps.iter().map(|map| curve.transformed(map).unwrap());
    placed.chain([curve.clone()]).collect()
}

#[test]
fn curves_that_run_back_over_themselves() {
    let arc = circle_arc(1.0, 20.0, 130.0).unwrap();
    let there_and_back = {
        let (there, back) = (arc.bezier_form(), arc.bezier_form().reversed());
        let mut control = there.control().to_vec();
        control.extend(&back.control()[1..]);
        let breaks: Vec<(f64, usize)> = (0..=4).map(|k| (f64::from(k), 2)).collect();
        let mut breaks = breaks;
        (breaks[0].1, breaks[4].1) = (3, 3);
        let knots = KnotVector::with_multiplicities(2, &breaks).unwrap();
        NurbsCurve::from_homogeneous(knots, control).unwrap()
    };
    // The parabola y = x² with x = (t − 0.3)², run through down to its vertex and back. The
    // coefficients of (t − c)ᵐ are its blossoms: means of products of m of four factors.
    let blossom = |m: usize, k: usize| -> f64 {
        let factors = [k, 4 - k].map(|count| (0..=count).map(move |i| binomial(count, i)));
        let [above, below] = factors.map(Iterator::collect::<Vec<f64>>);
        let of = |i: usize| 0.7_f64.powi(i as i32) * (-0.3_f64).powi((m - i) as i32);
        let chosen = |i: usize| above.get(i).unwrap_or(&0.0) * below.get(m - i).unwrap_or(&0.0);
        (0..=m).map(|i| chosen(i) * of(i)).sum::<f64>() / binomial(4, m)
    };
    let folded_parabola =
        NurbsCurve::bezier(&[0, 1, 2, 3, 4].map(|k| DVec3::new(blossom(2, k), blossom(4, k), 0.0)))
            .unwrap();
    let spike = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
    let cases = [
        ("line", polyline(&[[0.0, 0.0], [3.0, 0.0], [1.0, 0.0]]), 3.0),
        ("slanted", polyline(&[[0.0, 0.0], [0.3, 0.1], [0.6, 0.2], [0.15, 0.05]]), 0.4_f64.sqrt()),
        // x = 6t(1−t) + t²: turns at 3/5.
        ("bezier", bezier(&[[0.0, 0.0], [3.0, 3.0], [1.0, 1.0]]), 0.6),
        ("arc", there_and_back, 2.0),
        ("parabola", folded_parabola, 0.3),
        (
            "at the seam",
            polyline(&[[3.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 0.0], [3.0, 0.0]]),
            0.0,
        ),
    ];
    for (name, curve, t) in cases {
        for (k, placed) in everywhere(&curve).iter().enumerate() {
            let found = fold(placed).unwrap_or_else(|| panic!("{name}, {k}"));
            // Even where polylines have been moved, their parameter has not.
            assert!((found.t - t).abs() < 1e-7, "{name}, {k}: {found:?}");
            let [a, b] = found.twice.map(|t| placed.point_at(t));
            assert!(a.distance(b) < 1e-11 * placed.magnitude(), "{name}, {k}");
        }
    }
    assert!(fold(&polyline(&spike)).is_none(), "no spike at all");
}

#[test]
fn corners_cusps_and_touches_are_no_folds() {
    let needle = |width: f64| polyline(&[[0.0, 0.0], [1.0, 0.0], [0.0, width]]);
    let cases = [
        ("needle", needle(1e-6)),
        ("finer needle", needle(1e-10)),
        ("cusp", bezier(&[[0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]])),
        // y² = x³ through its cusp.
        ("semicubical", bezier(&[[1.0, -1.0], [-1.0 / 3.0, 1.0], [-1.0 / 3.0, -1.0], [1.0, 1.0]])),
        // Two circles that touch at the point of a crescent.
        ("crescent", {
            let outer = circle_arc(1.0, 0.0, 90.0).unwrap();
            let mut control = outer.control().to_vec();
            let inner = [[0.0, 1.0], [0.5, 1.0], [0.5, 0.5]].map(|[x, y]| DVec3::new(x, y, 0.0));
            let weights = [1.0, 0.5_f64.sqrt(), 1.0];
            let inner = inner.iter().zip(weights).skip(1);
            control.extend(inner.map(|(&p, w)| (p * w).extend(w)));
            let breaks = [(0.0, 3), (1.0, 2), (2.0, 3)];
            let knots = KnotVector::with_multiplicities(2, &breaks).unwrap();
            NurbsCurve::from_homogeneous(knots, control).unwrap()
        }),
        ("eight", polyline(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])),
        ("circle", circle_arc(2.0, 10.0, 360.0).unwrap()),
        ("full circle", circle_cubic()),
        // A point of the outline twice, and a bridge that is crossed both ways.
        (
            "touching",
            polyline(&[
                [0.0, 0.0],
                [2.0, 0.0],
                [1.0, 1.0],
                [2.0, 2.0],
                [0.0, 2.0],
                [1.0, 1.0],
                [0.0, 0.0],
            ]),
        ),
        ("repeated points", bezier(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0]])),
        ("straight on", polyline(&[[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]])),
    ];
    for (name, curve) in cases {
        for (k, placed) in everywhere(&curve).iter().enumerate() {
            assert_eq!(fold(placed), None, "{name}, {k}");
        }
    }
}

#[test]
fn a_profile_and_its_mirror_image_about_the_axis() {
    let y = Axis::new(DVec3::ZERO, DVec3::Y).unwrap();
    let found = |profile: &NurbsCurve, degrees: f64| {
        check_turned(profile, &y, degrees).map_err(|error| error.to_string())
    };
    let error = "profile: turned by 360° about the axis it covers itself: its two parts at \
                 t = 0.5, (0, -1, 0), are 180° apart and each other's image, as at t = ";
    for start in [90.0, 0.0, 33.0, -100.0] {
        let circle = circle_arc(1.0, start, 360.0).unwrap();
        assert_eq!(found(&circle, 180.0), Ok(()), "{start}");
        assert_eq!(found(&circle, -180.0), Ok(()), "{start}");
        let refused = found(&circle, 360.0).unwrap_err();
        if start == 90.0 {
            assert!(refused.starts_with(error), "{refused}");
        }
        assert!(found(&circle, 200.0).is_err(), "{start}");
        // Allowed: half of the circle, and a circle whose centre is not on the axis.
        assert_eq!(found(&circle_arc(1.0, -90.0, 180.0).unwrap(), 360.0), Ok(()));
        let aside = circle.transformed(&DAffine3::from_translation(0.5 * DVec3::X)).unwrap();
        assert_eq!(found(&aside, 360.0), Ok(()), "{start}");
    }
    // A disk twice; a double cone once.
    assert!(found(&polyline(&[[-1.0, 0.0], [2.0, 0.0]]), 270.0).is_err());
    assert_eq!(found(&polyline(&[[-1.0, -1.0], [2.0, 2.0]]), 360.0), Ok(()));
    // A triangle about its height, corner by corner.
    let triangle = polyline(&[[0.0, 2.0], [-1.0, 0.0], [1.0, 0.0], [0.0, 2.0]]);
    assert!(found(&triangle, 360.0).is_err());
    assert_eq!(found(&polyline(&[[0.0, 2.0], [-1.0, 0.0], [0.0, 0.0]]), 360.0), Ok(()));
}

/// A profile may cross the axis and go on as its own mirror image, if it is turned by no more than
/// half a turn; what comes before or after that counts all the same.
#[test]
fn a_profile_and_its_reverse_get_the_same_verdict() {
    let space = |points: &[[f64; 3]]| {
        NurbsCurve::polyline(&points.iter().copied().map(DVec3::from).collect::<Vec<_>>()).unwrap()
    };
    // Through the axis, up, and along a line that is nearest to the axis in its middle.
    let crossing = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.0, -1.0, 2.0], [1.0, 1.0, 2.0]];
    // Twice through the axis.
    let zigzag = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0]];
    // Half as far on the other side, where it turns round off the axis.
    let hook = [[2.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-0.5, 0.5, 0.0], [-3.0, 0.5, 0.0]];
    let cases: [(&[[f64; 3]], f64, bool); 7] = [
        (&crossing, 180.0, false),
        (&crossing[..2], 180.0, true),
        (&crossing[2..], 180.0, false),
        (&crossing[..3], 180.0, true),
        (&zigzag, 180.0, true),
        (&zigzag, 181.0, false),
        (&hook, 90.0, false),
    ];
    for (points, degrees, allowed) in cases {
        let profile = space(points);
        for placed in [profile.clone(), profile.reversed()] {
            let made = check_turned(&placed, &Axis::Z, degrees);
            assert_eq!(made.is_ok(), allowed, "{points:?}, {degrees}: {made:?}");
        }
    }
}

#[test]
fn a_profile_turned_within_a_plane_across_the_axis() {
    let found = |profile: &NurbsCurve, degrees: f64| {
        check_turned(profile, &Axis::Z, degrees).map_err(|error| error.to_string())
    };
    for size in [1e-8, 1.0, 1e8] {
        let sized = |curve: NurbsCurve| {
            curve.transformed(&DAffine3::from_scale(DVec3::splat(size))).unwrap()
        };
        // Turned about its own centre, a circle stays where it is.
        for start in [0.0, 33.0] {
            let circle = sized(circle_arc(1.0, start, 360.0).unwrap());
            let refused = found(&circle, 10.0).unwrap_err();
            assert!(refused.ends_with("turned about it, it remains a circle"), "{refused}");
        }
        // Beside the axis it passes over a ring twice, and over a part of it at any angle, however
        // small.
        let aside = DAffine3::from_translation(3.0 * DVec3::X);
        let aside = sized(circle_arc(1.0, 0.0, 360.0).unwrap().transformed(&aside).unwrap());
        for degrees in [360.0, 30.0, -1.0] {
            let refused = found(&aside, degrees).unwrap_err();
            assert!(refused.starts_with("profile: turned about the axis it covers itself: at t ="));
        }
        // A line that is nearest to the axis in its interior; the part up to that point makes a
        // ring.
        let line = |to: f64| sized(polyline(&[[1.0, -1.0], [1.0, to]]));
        assert!(found(&line(1.0), 20.0).is_err());
        assert_eq!(found(&line(0.0), 360.0), Ok(()));
        // A circle that is tilted rises and falls at the same distance.
        let tilt = DAffine3::from_rotation_x(0.5);
        let tilted = sized(circle_arc(1.0, 0.0, 360.0).unwrap().transformed(&tilt).unwrap());
        assert!(found(&tilted, 20.0).is_err());
    }
    let aside = polyline(&[[1.0, -1.0], [1.0, 1.0]]);
    let error = check_turned(&aside, &Axis::Z, 360.0).unwrap_err().to_string();
    assert_eq!(
        error,
        "profile: turned about the axis it covers itself: at t = 1, (1, 0, 0), it turns round as \
         seen from the axis, and its two sides, as at t = 0.292893 and 1.70711, are at the same \
         distance and the same height; leave out one of the two"
    );
}

#[test]
fn a_profile_moved_within_its_own_plane() {
    for size in [1e-8, 1.0, 1e8] {
        let sized = |curve: NurbsCurve| {
            curve.transformed(&DAffine3::from_scale(DVec3::splat(size))).unwrap()
        };
        let circle = sized(circle_arc(1.0, 0.0, 360.0).unwrap());
        for flat in [DVec3::Y, DVec3::new(-1e-3, 2e-3, 0.0), 1e9 * DVec3::X] {
            let error = check_moved(&circle, flat, "profile").unwrap_err();
            assert!(matches!(error, ConstructError::FoldsFlat { .. }), "{error}");
        }
        for out in [DVec3::Z, DVec3::new(1.0, 0.0, 1e-3)] {
            assert_eq!(check_moved(&circle, out, "profile"), Ok(()));
        }
        let graph = sized(bezier(&[[0.0, 0.0], [1.0, 2.0], [2.0, -1.0]]));
        assert_eq!(check_moved(&graph, DVec3::Y, "profile"), Ok(()), "a sheet, once");
        assert!(check_moved(&graph, DVec3::X, "profile").is_err());
    }
    let line = polyline(&[[0.0, 0.0], [2.0, 1.0]]);
    assert_eq!(
        check_moved(&line, DVec3::new(-4.0, -2.0, 0.0), "profile").unwrap_err().to_string(),
        "profile: moved along (-4, -2, 0) it remains a line: it runs straight in that direction"
    );
    let roof = polyline(&[[0.0, 0.0], [3.0, 4.0], [0.0, 8.0]]);
    assert_eq!(
        check_moved(&roof, DVec3::Y, "profile").unwrap_err().to_string(),
        "profile: moved along (0, 1, 0) it covers itself: at t = 5, (3, 4, 0), it turns round as \
         seen in that direction, and its two sides, as at t = 2.5 and 7.5, pass over the same \
         places; move it in another direction, or leave out one of the two"
    );
}

#[test]
fn surfaces_between_curves_that_are_the_same() {
    let roof = polyline(&[[0.0, 0.0], [3.0, 4.0], [6.0, 0.0]]);
    let message =
        |made: Result<_, ConstructError>| made.map(|_: NurbsSurface| ()).unwrap_err().to_string();
    assert_eq!(
        message(ruled(&roof, &roof)),
        "curves `from` and `to` are the same to within rounding: nothing lies between them"
    );
    assert_eq!(
        message(extrude(&roof, DVec3::splat(1e-20))),
        "the profile and itself moved by (1e-20, 1e-20, 1e-20) are the same to within rounding: \
         nothing lies between them"
    );
    let aside = roof.transformed(&DAffine3::from_translation(DVec3::X)).unwrap();
    assert!(
        message(ruled(&roof, &aside)).starts_with("curve `from`: moved along (1, 0, 0) it covers")
    );
    let above = roof.transformed(&DAffine3::from_translation(DVec3::Y)).unwrap();
    assert!(ruled(&roof, &above).is_ok());
    let lofted = |degree| {
        message(loft(&[roof.clone(), above.clone(), roof.clone()], degree).map(|l| l.surface))
    };
    for degree in [1, 2] {
        assert_eq!(
            lofted(degree),
            "sections 0 and 2 coincide: the surface would turn round at section 1 and cover itself \
             on the way back"
        );
    }
    let back = |y: f64| polyline(&[[0.0, y], [2.0, y], [0.0, y]]);
    let side = polyline(&[[0.0, 0.0], [0.0, 1.0]]);
    let borders = Borders { u0: side.clone(), u1: side, v0: back(0.0), v1: back(1.0) };
    assert!(message(coons(&borders)).starts_with("border v0: it folds at control point 1"));
}
