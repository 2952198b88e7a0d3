//! Which surfaces that meet, or nearly, are found to be turned opposite ways.

use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DQuat, DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{
    Cage, CageParts, KnotVector, NurbsSurface, Surface, TrianglePatch, TriangleSide,
    TrimmedSurface, shapes,
};

use super::gaps::fit;
use super::turns::Turned;
use super::which::Which;

fn turned(surfaces: &[Surface]) -> Vec<Turned> {
    fit(surfaces, &[], &vec![4.0; surfaces.len()]).turns.opposite
}

/// The pairs of surfaces, in order.
fn pairs(surfaces: &[Surface]) -> Vec<[usize; 2]> {
    let mut pairs: Vec<_> =
        turned(surfaces).iter().map(|pair| pair.edges.map(|edge| edge.surface)).collect();
    pairs.sort_unstable();
    pairs
}

/// The surface of degree 1 between these lines, one for each u.
fn ruled(lines: &[[DVec3; 2]]) -> NurbsSurface {
    let mut knots: Vec<f64> = (0..lines.len()).map(|k| k as f64).collect();
    knots.insert(0, 0.0);
    knots.push((lines.len() - 1) as f64);
    let (u, v) = (KnotVector::new(1, knots).unwrap(), KnotVector::bezier(1).unwrap());
    NurbsSurface::new(u, v, lines.concat(), None).unwrap()
}

/// A quadrilateral with corners at (u, v) = (0, 0), (1, 0), (1, 1), (0, 1).
fn quad([a, b, c, d]: [DVec3; 4]) -> NurbsSurface {
    ruled(&[[a, d], [b, c]])
}

/// The eight ways in which the parameters of a surface may run, and whether they turn it over.
fn placed(surface: &NurbsSurface) -> Vec<(Surface, bool)> {
    let mut all = Vec::new();
    for k in 0..8 {
        let [swaps, runs_back_u, runs_back_v] = [1, 2, 4].map(|bit| k & bit != 0);
        let mut one = surface.clone();
        one = if swaps { one.swapped() } else { one };
        one = if runs_back_u { one.reversed_u() } else { one };
        one = if runs_back_v { one.reversed_v() } else { one };
        all.push((one.into(), swaps ^ runs_back_u ^ runs_back_v));
    }
    all
}

fn reversed_if(reversed: bool, surface: impl Into<Surface>) -> Surface {
    let surface = surface.into();
    if reversed { surface.reversed() } else { surface }
}

/// A square beside the y axis, at this angle from the x axis and scaled; for any angles two of them
/// are turned alike if one of them is reversed.
fn leaf(angle: f64, scale: f64) -> NurbsSurface {
    let out = DVec3::new(angle.cos(), 0.0, angle.sin());
    quad([DVec3::ZERO, out, out + DVec3::Y, DVec3::Y].map(|corner| scale * corner))
}

/// Edges of CAD files, each computed from its own face, do not meet to rounding.
#[test]
fn sheets_that_nearly_meet_are_judged() {
    for (apart, judged) in [(1e-9, 1), (1e-6, 1), (1e-3, 0)] {
        let moved = DAffine3::from_translation(DVec3::new(apart, 0.0, -apart));
        let other = leaf(0.3 + PI, 1.0).transformed(&moved).unwrap();
        for (reversed, opposite) in [(false, judged), (true, 0)] {
            let sheets = [leaf(0.3, 1.0).into(), reversed_if(reversed, other.clone())];
            let turns = fit(&sheets, &[], &[4.0; 2]).turns;
            assert_eq!((turns.judged, turns.opposite.len()), (judged, opposite), "{apart}");
        }
    }
}

/// A sheet beside another, both with many knots along their common border, which is short compared
/// with the model.
#[test]
fn short_borders_of_many_spans_are_judged() {
    let lines: Vec<[DVec3; 2]> =
        (0..=300).map(|k| [0.0, 0.01].map(|x| DVec3::new(x, 1e-4 * f64::from(k), 0.0))).collect();
    let beside = DAffine3::from_translation(DVec3::new(0.01, 0.0, 0.0));
    let other = ruled(&lines).transformed(&beside).unwrap();
    for reversed in [false, true] {
        let sheets = [ruled(&lines).into(), reversed_if(reversed, other.clone())];
        let turns = fit(&sheets, &[], &[40.0; 2]).turns;
        assert_eq!((turns.judged, turns.opposite.len()), (1, usize::from(reversed)));
    }
}

#[test]
fn two_sheets_in_all_positions_and_at_all_angles() {
    for degrees in [180.0, 0.1, 20.0, 90.0, 160.0, 200.0, 340.0_f64] {
        let leaves = [leaf(0.3, 1.0), leaf(0.3 + degrees.to_radians(), 1.0)];
        let [some, others] = leaves.map(|leaf| placed(&leaf));
        for (one, over) in &some {
            for (other, other_over) in &others {
                let found = pairs(&[one.clone(), other.clone()]);
                let expected: &[[usize; 2]] = if over == other_over { &[[0, 1]] } else { &[] };
                assert_eq!(found, expected, "{degrees}: {over}, {other_over}");
            }
        }
    }
}

#[test]
fn at_every_size_and_place() {
    for (scale, far) in [(1e-8, 0.0), (1.0, 1e6), (1e8, 1e9)] {
        let place = DAffine3::from_translation(DVec3::new(far, -0.7 * far, 0.3 * far));
        let leaf = |angle: f64| leaf(angle, scale).transformed(&place).unwrap();
        for reversed in [false, true] {
            let two = [leaf(0.2).into(), reversed_if(reversed, leaf(2.5))];
            let found = fit(&two, &[], &[2.0 * scale; 2]).turns.opposite;
            assert_eq!(found.len(), usize::from(!reversed), "{scale}, {far}");
        }
    }
}

#[test]
fn the_faces_of_a_cube() {
    let corner = |k: usize| DVec3::from([1, 2, 4].map(|bit| f64::from(u8::from(k & bit != 0))));
    // Each counterclockwise from outside.
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for (over, expected) in [(0b0, 0), (0b1, 4), (0b11, 8), (0b101, 6), (0b111111, 0)] {
        let face = |(k, face): (usize, [usize; 4])| {
            reversed_if(over & (1 << k) != 0, quad(face.map(corner)))
        };
        let cube: Vec<Surface> = faces.into_iter().enumerate().map(face).collect();
        let turns = |faces: &[Surface]| fit(faces, &[], &vec![2.0; faces.len()]).turns;
        let found = turns(&cube);
        assert_eq!((found.judged, found.opposite.len()), (12, expected), "{over:b}");
        // Twice the same cube: at each edge four faces meet.
        assert_eq!(turns(&[&cube[..], &cube].concat()).judged, 0);
    }
}

#[test]
fn surfaces_that_meet_themselves() {
    let closed = [
        shapes::sphere(1.0).unwrap(),
        shapes::torus(3.0, 1.0).unwrap(),
        shapes::cylinder(1.0, 2.0).unwrap(),
        shapes::cone(1.0, 2.0).unwrap(),
    ];
    for shape in &closed {
        for (shape, _) in placed(shape) {
            let turns = fit(&[shape], &[], &[8.0]).turns;
            assert!(turns.judged > 0 && turns.opposite.is_empty(), "{turns:?}");
        }
    }

    // A band with half twists: after an odd number its sides are exchanged.
    for half_twists in 0..4 {
        let line = |k: usize| {
            let share = k as f64 / 48.0;
            let (turn, tilt) = (TAU * share, f64::from(half_twists) * PI * share);
            let out = DVec3::new(turn.cos(), turn.sin(), 0.0);
            let across = 0.4 * (tilt.cos() * out + tilt.sin() * DVec3::Z);
            [2.0 * out - across, 2.0 * out + across]
        };
        let found = turned(&[ruled(&(0..=48).map(line).collect::<Vec<_>>()).into()]);
        assert_eq!(found.len(), half_twists as usize % 2, "{half_twists}");
        for pair in found {
            assert_eq!(pair.edges.map(|edge| edge.which.to_string()), ["u = 0", "u = 48"]);
        }
    }
}

#[test]
fn a_knot_where_a_surface_may_jump() {
    let line = |x: f64| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)];
    let (u, v) = ([0.0, 0.0, 1.0, 1.0, 2.0, 2.0], KnotVector::bezier(1).unwrap());
    let u = KnotVector::new(1, u.to_vec()).unwrap();
    let net = [line(0.0), line(1.0), line(1.0), line(2.0)].concat();
    let sheet = NurbsSurface::new(u, v, net, None).unwrap();
    for (sheet, _) in placed(&sheet) {
        let fit = fit(&[sheet], &[], &[4.0]);
        assert_eq!((fit.meeting, fit.turns.judged, fit.turns.opposite.len()), (2, 1, 0));
    }
}

/// Where more than two meet, no two of them belong together.
#[test]
fn three_and_more_sheets_in_one_edge() {
    let leaves: Vec<Surface> = [0.1, 1.0, 2.5, 4.0].map(|angle| leaf(angle, 1.0).into()).to_vec();
    for over in 0..16 {
        let leaf = |(k, leaf): (usize, &Surface)| reversed_if(over & (1 << k) != 0, leaf.clone());
        let leaves: Vec<Surface> = leaves.iter().enumerate().map(leaf).collect();
        assert!(turned(&leaves).is_empty() && turned(&leaves[..3]).is_empty(), "{over:b}");
    }
}

/// Nor are surfaces judged that lie on each other.
#[test]
fn copies_of_a_surface() {
    let sheet = leaf(0.4, 1.0);
    let finer = sheet.elevated_u(2).unwrap();
    for other in [sheet.clone(), finer, sheet.swapped()] {
        assert!(turned(&[sheet.clone().into(), other.into()]).is_empty());
    }
    let sphere = Surface::from(shapes::sphere(1.0).unwrap());
    assert!(turned(&[sphere.clone(), sphere]).is_empty());
}

/// Two short sheets beside a long one.
#[test]
fn borders_that_meet_in_part() {
    let long = leaf(0.0, 1.0);
    let (low, high) = leaf(PI, 1.0).reversed_u().split_v(0.3).unwrap();
    let all = |over: [bool; 2]| {
        let [low, high] = [&low, &high].map(|part| Surface::from(part.clone()));
        [long.clone().into(), reversed_if(over[0], low), reversed_if(over[1], high)]
    };
    assert!(pairs(&all([false, false])).is_empty());
    assert_eq!(pairs(&all([true, false])), [[0, 1], [1, 2]]);
    assert_eq!(pairs(&all([false, true])), [[0, 2], [1, 2]]);
    assert_eq!(pairs(&all([true, true])), [[0, 1], [0, 2]]);
}

/// Borders that cross or touch in a point, or are too far apart, are not judged.
#[test]
fn borders_that_do_not_meet() {
    let sheet = leaf(0.0, 1.0);
    let beside = |x: f64, angle: f64| {
        let map = DAffine3::from_rotation_translation(
            DQuat::from_rotation_z(angle),
            DVec3::new(x, 0.5, 0.0),
        );
        sheet.transformed(&map).unwrap()
    };
    for other in [beside(1.0 + 1e-3, 0.0), beside(1.0, -0.7), beside(0.5, 0.3)] {
        for reversed in [false, true] {
            let two = [sheet.clone().into(), reversed_if(reversed, other.clone())];
            assert!(turned(&two).is_empty());
        }
    }
}

#[test]
fn sides_of_triangles() {
    let corners = [DVec3::X, DVec3::Y, DVec3::ZERO]; // u = 1, v = 1, w = 1
    let patch = |[u, v, w]: [DVec3; 3]| TrianglePatch::new(1, vec![w, v, u], None).unwrap();
    let triangle = patch(corners);
    for (side, [from, to]) in
        [(TriangleSide::U, [2, 1]), (TriangleSide::V, [0, 2]), (TriangleSide::W, [1, 0])]
    {
        // Counterclockwise around the triangle, `to` comes before `from`.
        let [a, b] = [from, to].map(|k| corners[k]);
        let apex = a + b - corners[3 - from - to] + 0.3 * DVec3::Z;
        let third = patch([a, b, apex]);
        let fourth = quad([a, b, b + apex, a + apex]);
        for other in [Surface::from(third), fourth.into()] {
            for reversed in [false, true] {
                let two = [triangle.clone().into(), reversed_if(reversed, other.clone())];
                let found = turned(&two);
                assert_eq!(found.len(), usize::from(reversed), "{side}");
                assert!(found.iter().all(|pair| pair.edges[0].which == Which::Side(side)));
            }
        }
    }
}

/// The cage is a flat grid of nine squares, whose corners stay in place.
#[test]
fn subdivision_surfaces() {
    let positions = (0..16).map(|k| DVec3::new(f64::from(k / 4), f64::from(k % 4), 0.0));
    let face = |k: usize| {
        let first = 4 * (k / 3) + k % 3;
        vec![first, first + 4, first + 5, first + 1]
    };
    let faces = (0..9).map(face).collect();
    let parts = CageParts { positions: positions.collect(), faces, ..CageParts::default() };
    let grid = Surface::from(Cage::new(parts).unwrap().catmull_clark(1e-4).unwrap());
    let [near, far] = [(3.0, 0.0), (4.0, 1.0)].map(|(x, z)| DVec3::new(x, 0.0, z));
    for (sheet, is_sheet_over) in
        placed(&quad([near, far, far + 3.0 * DVec3::Y, near + 3.0 * DVec3::Y]))
    {
        for is_grid_over in [false, true] {
            let found = pairs(&[reversed_if(is_grid_over, grid.clone()), sheet.clone()]);
            let expected = if is_grid_over == is_sheet_over { 0 } else { 3 };
            assert_eq!(found, vec![[0, 1]; expected]);
        }
    }
}

/// A sheet with a hole, or the disc from it, and a pipe up or down from there.
#[test]
fn trim_edges_and_borders() {
    let plane = shapes::plane(4.0, 4.0).unwrap();
    let [[u0, u1], [v0, v1]] = plane.domain();
    let center = DVec2::new(0.5 * (u0 + u1), 0.5 * (v0 + v1));
    let circle = TrimLoop::circle(center, 0.25 * (u1 - u0)).unwrap();
    let domain = TrimDomain::of(&plane).unwrap();
    let cylinder = shapes::cylinder(1.0, 2.0).unwrap();
    let [[s0, _], [t0, t1]] = cylinder.domain();
    let bottom = [t0, t1]
        .map(|t| cylinder.point_at(DVec2::new(s0, t)).z)
        .into_iter()
        .fold(f64::MAX, f64::min);
    for k in 0..16 {
        let [is_disc, goes_down, is_plate_over, is_pipe_over] =
            [1, 2, 4, 8].map(|bit| k & bit != 0);
        let kept = if is_disc { Kept::Odd } else { Kept::Even };
        let trims = Trims::new(domain, kept, std::slice::from_ref(&circle)).unwrap();
        let plate = TrimmedSurface::new(plane.clone(), trims).unwrap();
        let from = if goes_down { bottom + 2.0 } else { bottom };
        let pipe = cylinder.transformed(&DAffine3::from_translation(-from * DVec3::Z)).unwrap();
        let found = turned(&[reversed_if(is_plate_over, plate), reversed_if(is_pipe_over, pipe)]);
        // The upper side of a sheet goes on as the outer side of a pipe up.
        let alike = !(is_disc ^ goes_down ^ is_plate_over ^ is_pipe_over);
        assert_eq!(found.is_empty(), alike, "{k:b}");
        for pair in found {
            let [plate, pipe] = pair.edges.map(|edge| edge.which);
            let is_trim = [plate, pipe].map(|which| matches!(which, Which::Trim(_)));
            assert_eq!(is_trim.iter().filter(|is| **is).count(), 1, "{plate} | {pipe}");
        }
    }
}

/// Parts cut from one surface by one loop, whose trim edges run through a seam or not.
#[test]
fn trim_edges_and_trim_edges() {
    let sphere = shapes::sphere(2.0).unwrap();
    let [[u0, u1], [v0, v1]] = sphere.domain();
    let domain = TrimDomain::with_seams_of(&sphere).unwrap();
    for share in [0.0, 0.4] {
        let center = DVec2::new(0.5 * (u0 + u1), v0 + share * (v1 - v0));
        let circle = TrimLoop::circle(center, 0.2).unwrap();
        let part = |kept| {
            let trims = Trims::new(domain, kept, std::slice::from_ref(&circle)).unwrap();
            TrimmedSurface::new(sphere.clone(), trims).unwrap()
        };
        for (over, other_over) in [(false, false), (false, true), (true, false), (true, true)] {
            let parts =
                [reversed_if(over, part(Kept::Odd)), reversed_if(other_over, part(Kept::Even))];
            let found = turned(&parts);
            assert_eq!(found.is_empty(), over == other_over, "{share}");
            for pair in found {
                assert_eq!(pair.edges.map(|edge| edge.surface), [0, 1]);
                assert!(pair.edges.iter().all(|edge| matches!(edge.which, Which::Trim(_))));
            }
        }
        // Copies of a part.
        assert!(turned(&[part(Kept::Odd).into(), part(Kept::Odd).into()]).is_empty());
    }
}

/// Tubes and joints of one drawing run into each other.
#[test]
fn parts_of_one_drawing_are_not_judged() {
    let two = [0.0, PI].map(|angle| Surface::from(leaf(angle, 1.0)));
    let count = |drawings: [Option<[usize; 2]>; 2]| fit(&two, &drawings, &[2.0; 2]).turns.judged;
    assert_eq!(count([None, None]), 1);
    assert_eq!(count([Some([3, 0]), Some([4, 0])]), 1);
    assert_eq!(count([Some([3, 0]); 2]), 0);
}
