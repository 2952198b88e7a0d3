//! Valid input that is close to invalid input: nothing is covered twice.

use glam::{DAffine3, DQuat, DVec2, DVec3};

use super::Axis;
use super::{
    Borders, ConstructError, RibbonStyle, SweepOptions, TubeStyle, coons, extrude, loft, revolve,
    ribbon, ruled, sweep, tube,
};
use crate::geometry::knots::unit_knots;
use crate::geometry::shapes::circle_arc;
use crate::geometry::{KnotVector, NurbsCurve};

/// Corners `(x, y, z)`.
fn polyline(points: &[[f64; 3]]) -> NurbsCurve {
    NurbsCurve::polyline(&points.iter().map(|&point| point.into()).collect::<Vec<_>>()).unwrap()
}

fn bezier(points: &[[f64; 3]]) -> NurbsCurve {
    NurbsCurve::bezier(&points.iter().map(|&point| point.into()).collect::<Vec<_>>()).unwrap()
}

fn weighted(points: &[[f64; 3]], weights: &[f64]) -> NurbsCurve {
    let points = points.iter().map(|&point| point.into()).collect();
    NurbsCurve::new(unit_knots(weights.len() - 1), points, Some(weights.to_vec())).unwrap()
}

fn arc(radius: f64, from: f64, degrees: f64) -> NurbsCurve {
    circle_arc(radius, from, degrees).unwrap()
}

/// The curve turned from the plane of x and y into that of x and z.
fn upright(curve: &NurbsCurve) -> NurbsCurve {
    moved(curve, DAffine3::from_rotation_x(90_f64.to_radians()))
}

fn moved(curve: &NurbsCurve, by: DAffine3) -> NurbsCurve {
    curve.transformed(&by).unwrap()
}

fn shifted(curve: &NurbsCurve, by: [f64; 3]) -> NurbsCurve {
    moved(curve, DAffine3::from_translation(by.into()))
}

/// Several positions, sizes and rotations.
fn placements() -> impl Iterator<Item = DAffine3> {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let placed = |(size, turn, aside): (f64, DQuat, f64)| {
        let at = aside * size * DVec3::new(0.3, -2.0, 1.0);
        DAffine3::from_scale_rotation_translation(DVec3::splat(size), turn, at)
    };
    let none = DQuat::IDENTITY;
    [(1.0, none, 0.0), (1e-8, turn, 1.0), (1e8, turn, 0.0), (1.0, turn, 100.0)]
        .into_iter()
        .map(placed)
}

fn all_taken(made: impl Iterator<Item = (String, Result<(), ConstructError>)>) {
    let refused: Vec<String> =
        made.filter_map(|(name, made)| Some(format!("{name}: {}", made.err()?))).collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

#[test]
fn revolutions() {
    let goblet = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 2.0],
        [1.0 - 1e-6, 0.0, 2.0],
        [1.0 - 1e-6, 0.0, 1e-6],
        [0.0, 0.0, 1e-6],
    ];
    let ring = |at: f64, tilt: f64| {
        shifted(&moved(&arc(1.0, 0.0, 360.0), DAffine3::from_rotation_x(tilt)), [at, 0.0, 0.0])
    };
    let cases = [
        ("disc", polyline(&[[0.0; 3], [1.0, 0.0, 0.0]]), 360.0),
        ("disc, from its rim", polyline(&[[0.0, -1.0, 0.5], [0.0, 0.0, 0.5]]), 360.0),
        ("sector", polyline(&[[0.0; 3], [1.0, 0.0, 0.0]]), 30.0),
        ("diameter", polyline(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), 180.0),
        ("diameter, backwards", polyline(&[[-1.0, 0.0, 0.0], [0.5, 0.0, 0.0]]), -180.0),
        ("annulus", polyline(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), 360.0),
        ("narrow annulus", polyline(&[[1.0, 0.0, 0.0], [1.0 + 1e-9, 0.0, 0.0]]), 360.0),
        ("spokes askew", polyline(&[[1.0, 0.0, 0.0], [1.0, 2.0, 0.0]]), 360.0),
        ("curved spoke", bezier(&[[0.0; 3], [1.0, 0.5, 0.0], [2.0, 0.0, 0.0]]), 360.0),
        ("cylinder", polyline(&[[1.0, 0.0, 0.0], [1.0, 0.0, 2.0]]), 360.0),
        ("narrow band", polyline(&[[1.0, 0.0, 0.0], [1.0, 0.0, 1e-9]]), 360.0),
        ("cone to the axis", polyline(&[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), 360.0),
        ("double cone", polyline(&[[1.0, 0.0, -1.0], [-1.0, 0.0, 1.0]]), 360.0),
        ("flat cone", polyline(&[[-1.0, 0.0, -1e-6], [1.0, 0.0, 1e-6]]), 360.0),
        ("hyperboloid", polyline(&[[1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]), 360.0),
        ("flat hyperboloid", polyline(&[[1.0, -1.0, -1e-6], [1.0, 1.0, 1e-6]]), 360.0),
        ("sphere", upright(&arc(1.0, -90.0, 180.0)), 360.0),
        ("sphere from a circle", upright(&arc(1.0, -90.0, 360.0)), 180.0),
        ("sphere from a circle", upright(&arc(1.0, 33.0, 360.0)), -180.0),
        ("torus", upright(&shifted(&arc(1.0, 0.0, 360.0), [3.0, 0.0, 0.0])), 360.0),
        ("horn torus", upright(&shifted(&arc(1.0, 0.0, 360.0), [1.0, 0.0, 0.0])), 360.0),
        ("spindle torus", upright(&shifted(&arc(1.0, 0.0, 360.0), [0.5, 0.0, 0.0])), 360.0),
        ("thin torus", upright(&shifted(&arc(1e-6, 0.0, 360.0), [1.0, 0.0, 0.0])), 180.0),
        ("tilted ring", ring(3.0, 0.1), 360.0),
        ("ring tilted a little", ring(3.0, 1e-6), 360.0),
        ("goblet", polyline(&goblet), 360.0),
        (
            "half a disc and its edge",
            {
                let bow = upright(&arc(1.0, -90.0, 180.0));
                let edge = polyline(&[[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
                joined(&[bow, edge])
            },
            360.0,
        ),
    ];
    let made = cases.iter().flat_map(|(name, profile, degrees)| {
        placements().map(move |place| {
            let axis = Axis::new(place.transform_point3(DVec3::ZERO), place.matrix3.z_axis);
            let made = revolve(&moved(profile, place), &axis.unwrap(), *degrees);
            (format!("{name}, {:e}", place.matrix3.z_axis.length()), made.map(|_| ()))
        })
    });
    all_taken(made);
}

/// Joins curves, each of which begins where the previous one ends.
fn joined(curves: &[NurbsCurve]) -> NurbsCurve {
    let degree = curves.iter().map(|curve| curve.knots().degree()).max().unwrap();
    let (mut knots, mut control) = (vec![(0.0, degree + 1)], Vec::new());
    for curve in curves {
        let curve = curve.elevated(degree - curve.knots().degree()).unwrap().bezier_form();
        let pieces = (curve.control().len() - 1) / degree;
        for _ in 0..pieces {
            let next = knots[knots.len() - 1].0 + 1.0;
            knots.push((next, degree));
        }
        control.extend(&curve.control()[usize::from(!control.is_empty())..]);
    }
    knots.last_mut().unwrap().1 = degree + 1;
    let knots = KnotVector::with_multiplicities(degree, &knots).unwrap();
    NurbsCurve::from_homogeneous(knots, control).unwrap()
}

#[test]
fn extrusions() {
    let cubic = bezier(&[[-1.0, -1.0, 0.0], [-0.3, 1.0, 0.0], [0.3, -1.0, 0.0], [1.0, 1.0, 0.0]]);
    // x = t³ for t in [-1, 1], y falling: moved along y, it halts for a moment.
    let halting = bezier(&[[-1.0, 1.0, 0.0], [1.0, 0.3, 0.0], [-1.0, -0.3, 0.0], [1.0, -1.0, 0.0]]);
    let stairs = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 2.0, 0.0]];
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
    let helix: Vec<[f64; 3]> = (0..40)
        .map(|k| {
            let at = DVec2::from_angle(f64::from(k) * 20_f64.to_radians());
            [at.x, at.y, 0.1 * f64::from(k)]
        })
        .collect();
    let circle = arc(1.0, 0.0, 360.0);
    let cases = [
        ("cylinder", circle.clone(), [0.0, 0.0, 2.0]),
        ("oblique cylinder", circle.clone(), [3.0, 1.0, 1.0]),
        ("very oblique cylinder", circle.clone(), [1.0, 0.0, 1e-4]),
        ("short cylinder", circle, [0.0, 0.0, 1e-9]),
        ("half a circle up", arc(1.0, 0.0, 180.0), [0.0, 1.0, 0.0]),
        ("quarter", arc(1.0, 0.0, 90.0), [1.0, 0.0, 0.0]),
        ("graph", cubic, [0.0, 5.0, 0.0]),
        ("halting", halting, [0.0, 5.0, 0.0]),
        ("stairs", polyline(&stairs), [1.0, -1.0, 0.0]),
        ("prism", polyline(&triangle), [0.2, 0.3, -1.0]),
        ("helix", polyline(&helix), [0.0, 0.0, 1.0]),
        ("helix aside", polyline(&helix), [0.3, 0.2, 1.0]),
        ("line", polyline(&[[0.0; 3], [1.0, 0.0, 0.0]]), [1.0, 1e-6, 0.0]),
    ];
    let made = cases.iter().flat_map(|(name, profile, by)| {
        placements().flat_map(move |place| {
            let (profile, by) = (moved(profile, place), place.transform_vector3((*by).into()));
            let to = moved(&profile, DAffine3::from_translation(by));
            let name = format!("{name}, {:e}", place.matrix3.z_axis.length());
            let extruded = extrude(&profile, by).map(|_| ());
            [(name.clone(), extruded), (format!("{name}, ruled"), ruled(&profile, &to).map(|_| ()))]
        })
    });
    all_taken(made);
}

#[test]
fn between_curves_that_are_nearly_the_same() {
    let points = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let (flat, round, sharp) = (
        weighted(&points, &[1.0, 0.5, 1.0]),
        arc(1.0, 0.0, 90.0),
        weighted(&points, &[1.0, 0.8, 1.0]),
    );
    let above = shifted(&round, [0.0, 0.0, 1.0]);
    let near = |off: f64| shifted(&round, [off, 0.0, 0.0]);
    let sections = |all: &[&NurbsCurve], degree: usize| {
        let all: Vec<NurbsCurve> = all.iter().map(|&one| one.clone()).collect();
        loft(&all, degree).map(|_| ())
    };
    let hairpin = polyline(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0; 3]]);
    let borders = |bow: f64| {
        let side = |z: f64| bezier(&[[0.0; 3], [0.0, 0.5, z], [0.0, 1.0, 0.0]]);
        let v1 = shifted(&hairpin, [0.0, 1.0, 0.0]);
        Borders { u0: side(0.0), u1: side(bow), v0: hairpin.clone(), v1 }
    };
    let mut made = vec![
        ("lens".to_owned(), ruled(&flat, &sharp).map(|_| ())),
        ("conics there and back".to_owned(), sections(&[&flat, &above, &sharp], 2)),
        ("conics, straight".to_owned(), sections(&[&flat, &above, &sharp], 1)),
        ("again and again".to_owned(), sections(&[&round, &above, &round, &above], 3)),
        ("a sleeve".to_owned(), coons(&borders(0.5)).map(|_| ())),
        ("a narrow sleeve".to_owned(), coons(&borders(1e-6)).map(|_| ())),
    ];
    for off in [0.1, 1e-6, 1e-12] {
        made.push((format!("between, {off:e}"), ruled(&round, &near(off)).map(|_| ())));
        for degree in [1, 2] {
            let name = format!("there and back, {off:e}, {degree}");
            made.push((name, sections(&[&round, &above, &near(off)], degree)));
        }
    }
    all_taken(made.into_iter());
    assert!(coons(&borders(0.0)).is_err(), "the sleeve pressed flat");
    let twice = |factor: f64| weighted(&points, &[1.0, 0.5, 1.0].map(|w| factor * w));
    assert!(ruled(&flat, &twice(3.0)).is_err(), "a common factor changes nothing");
    assert!(sections(&[&flat, &above, &twice(3.0)], 2).is_err());
}

#[test]
fn sweeps_and_tubes() {
    let uniform = |degree: usize, points: &[[f64; 3]]| {
        let knots = KnotVector::clamped_uniform(degree, points.len()).unwrap();
        let points = points.iter().map(|&point| point.into()).collect();
        NurbsCurve::new(knots, points, None).unwrap()
    };
    let (a, b, c) = ([0.0; 3], [2.0, 3.0, 1.0], [5.0, 0.0, 0.0]);
    let end = [8.0, 1.0, 0.0];
    let waves: Vec<DVec3> = (0..8)
        .map(|k| DVec2::from_angle(f64::from(k) * 45_f64.to_radians()).extend(f64::from(k % 2)))
        .map(|at| 3.0 * at)
        .collect();
    let mut closed = waves.clone();
    closed.extend(&waves[..3]);
    let closed = NurbsCurve::new(
        KnotVector::new(3, (0..15).map(f64::from).collect()).unwrap(),
        closed,
        None,
    );
    let paths = [
        ("straight", polyline(&[a, c]), true),
        ("circle", arc(3.0, 0.0, 360.0), true),
        ("arc", arc(3.0, 20.0, 200.0), true),
        ("closed", closed.unwrap(), true),
        ("four times at the start", uniform(3, &[a, a, a, a, b, c, end]), true),
        ("four times at the end", uniform(3, &[a, b, c, end, end, end, end]), true),
        ("four times in between", uniform(3, &[a, b, c, c, c, c, [7.0, 3.0, 0.0], end]), false),
        (
            "four times on a line",
            uniform(3, &[a, [1.0, 0.0, 0.0], c, c, c, c, [8.0, 0.0, 0.0]]),
            true,
        ),
        ("three times at the start", uniform(3, &[a, a, a, b, c, end]), true),
        ("two times in between", uniform(3, &[a, b, b, c, end]), true),
        ("a closed polygon", polyline(&[a, b, c, a]), false),
    ];
    let thin = TubeStyle { radius: 0.05, tolerance: Some(1e-3), ..TubeStyle::default() };
    let narrow = RibbonStyle { width: 0.1, tolerance: Some(1e-3), ..RibbonStyle::default() };
    let square = [[0.1, 0.1, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0], [0.1, -0.1, 0.0]];
    let square: Vec<[f64; 3]> = square.into_iter().chain([square[0]]).collect();
    let profiles = [arc(0.1, 0.0, 360.0), polyline(&square), arc(0.1, 0.0, 90.0)];
    let mut made = Vec::new();
    for (name, path, smooth) in &paths {
        made.push((format!("tube, {name}"), tube(path, &thin).map(|_| ())));
        made.push((format!("ribbon, {name}"), ribbon(path, &narrow).map(|_| ())));
        for (k, profile) in profiles.iter().enumerate().filter(|_| *smooth) {
            for (twist, scale) in [(0.0, vec![1.0]), (180.0, vec![1.0]), (0.0, vec![1.0, 0.5])] {
                let name = format!("sweep of {k}, {name}, {twist}, {scale:?}");
                let options =
                    SweepOptions { twist, scale, tolerance: Some(1e-3), ..SweepOptions::default() };
                made.push((name, sweep(profile, path, &options).map(|_| ())));
            }
        }
    }
    all_taken(made.into_iter());
    // Towards a cusp a curve bends ever more sharply: too sharply for any tube.
    let cusp = bezier(&[[0.0; 3], [9.0, 9.0, 0.0], [0.0, 9.0, 0.0], [9.0, 0.0, 0.0]]);
    assert!(matches!(tube(&cusp, &thin), Err(ConstructError::Fold { what: "tube", .. })));
}

/// Curves of so many points that the surface would be too large are refused before anything else is
/// looked at, and before anything is allocated.
#[test]
fn surfaces_of_too_many_points() {
    let limit = 1 << 24;
    let still = |count: usize| {
        let knots = KnotVector::clamped_uniform(1, count).unwrap();
        NurbsCurve::from_homogeneous(knots, vec![DVec3::X.extend(1.0); count]).unwrap()
    };
    let (around, along) = (limit / 9 + 1, limit / 2 + 1);
    let refused = |nu, nv| ConstructError::TooLarge { nu, nv, limit };
    assert_eq!(revolve(&still(around), &Axis::Z, 360.0).unwrap_err(), refused(9, around));
    assert_eq!(extrude(&still(along), DVec3::Y).unwrap_err(), refused(along, 2));
}
