//! Things drawn together: equal parts become one, others do not.

use glam::{DAffine3, DVec2, DVec3};

use super::{
    Caps, Component, ComponentKind, ControlNet, Drawing, NetStyle, TubeStyle, control_net, tube,
};
use crate::geometry::shapes::{self, circle_arc};
use crate::geometry::{KnotVector, NurbsCurve, NurbsSurface};

fn counts(pieces: &[Component]) -> [usize; 3] {
    let kinds = [ComponentKind::Tube, ComponentKind::Joint, ComponentKind::Cap];
    kinds.map(|kind| pieces.iter().filter(|p| p.kind == kind).count())
}

fn flat(points: &[[f64; 2]], size: f64) -> Vec<DVec3> {
    points.iter().map(|&[x, y]| size * DVec3::new(x, y, 0.0)).collect()
}

/// Tubes around all of some curves.
fn drawn(curves: &[NurbsCurve], caps: Caps, size: f64) -> Vec<Component> {
    let style = TubeStyle { radius: 0.05 * size, caps, tolerance: None };
    let mut drawing = Drawing::among([DVec3::splat(2.0 * size)], style);
    for curve in curves {
        drawing.tube(curve).unwrap();
    }
    let most = drawing.point_count();
    let pieces = drawing.pieces().unwrap();
    let points = pieces.iter().map(|piece| piece.surface.control().len()).sum::<usize>();
    assert!(points <= most);
    pieces
}

/// The four sides of a square, each from a different corner: two tubes end at every corner.
#[test]
fn ends_that_meet_become_one_ball() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let side = |a: usize, b: usize, size| {
        NurbsCurve::polyline(&flat(&[corners[a], corners[b]], size)).unwrap()
    };
    for size in [1e-8, 1.0, 1e8] {
        let sides = [side(0, 1, size), side(2, 1, size), side(2, 3, size), side(0, 3, size)];
        let pieces = drawn(&sides, Caps::Round, size);
        assert_eq!(counts(&pieces), [4, 4, 0]);
        for corner in flat(&corners, size) {
            let around = |piece: &&Component| {
                let on = piece.surface.point_at(DVec2::new(0.3, 0.4)).distance(corner) / size;
                piece.kind == ComponentKind::Joint && (on - 0.05).abs() < 1e-12
            };
            assert_eq!(pieces.iter().filter(around).count(), 1, "{corner}");
        }
        // A tube alone has half balls; disks at an angle to each other stay two.
        assert_eq!(counts(&drawn(&sides[..1], Caps::Round, size)), [1, 0, 2]);
        assert_eq!(counts(&drawn(&sides, Caps::Flat, size)), [4, 0, 8]);
        // Disks in one plane become one, on whichever side the tubes are.
        let on = NurbsCurve::polyline(&flat(&[[1.0, 0.0], [2.0, 0.0]], size)).unwrap();
        assert_eq!(counts(&drawn(&[side(0, 1, size), on], Caps::Flat, size)), [2, 0, 3]);
    }
}

#[test]
fn a_corner_passed_twice_has_one_ball() {
    let way = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [0.0, 1.0]];
    let curve = NurbsCurve::polyline(&flat(&way, 1.0)).unwrap();
    let style = TubeStyle { radius: 0.1, ..TubeStyle::default() };
    // Balls at the three corners, half a one at the end.
    assert_eq!(counts(&tube(&curve, &style).unwrap()), [4, 3, 1]);
}

#[test]
fn tubes_are_made_once_whichever_way_they_run() {
    let points = [[0.0, 0.0, 0.0], [0.5, 1.0, 0.3], [1.0, -1.0, 0.0], [2.0, 0.0, 1.0]];
    let wave = NurbsCurve::bezier(&points.map(DVec3::from)).unwrap();
    let arc = circle_arc(1.0, 20.0, 130.0).unwrap();
    let line = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::new(1.0, 0.3, 0.2)]).unwrap();
    for curve in [&wave, &arc, &line] {
        let moved = curve.on_domain(3.0, 5.0).unwrap();
        let finer = curve.elevated(1).unwrap().insert_knot(curve.domain()[1] * 0.3, 1).unwrap();
        let all = [curve.clone(), curve.reversed(), moved, finer.reversed(), finer];
        assert_eq!(counts(&drawn(&all, Caps::Open, 1.0)), [1, 0, 0]);
    }
    // Curves with the same ends and middle, but otherwise different.
    let through = |y: f64| {
        let points = [[0.0, 0.0], [0.5, y], [1.0, 0.0], [1.5, -y], [2.0, 0.0]];
        NurbsCurve::bezier(&flat(&points, 1.0)).unwrap()
    };
    assert_eq!(counts(&drawn(&[through(0.5), through(0.6)], Caps::Open, 1.0)), [2, 0, 0]);
}

/// Adjacent patches have a row of control points in common, which each computes with different
/// rounding.
#[test]
fn rows_that_nets_share_are_drawn_once() {
    for (size, noise) in [(1e-8, 0.0), (1.0, 3e-16), (1e8, 3e-16)] {
        let patch = |offset: f64| {
            let knots = KnotVector::clamped_uniform(2, 3).unwrap();
            let points = (0..9).map(|k| {
                let (i, j) = (f64::from(k / 3), f64::from(k % 3));
                size * (1.0 + noise * offset) * DVec3::new(i + offset, j, i * j / 7.0 - i * offset)
            });
            NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap()
        };
        let [left, mut right] = [patch(0.0), patch(2.0)].map(|s| ControlNet::from(&s));
        // Their common row.
        for j in 0..3 {
            right.points[j] = left.points[6 + j] * (1.0 + noise);
        }
        let mut net = Drawing::among(left.points.iter().copied().chain(right.points.clone()), {
            NetStyle { radius: 0.01 * size, joints: 0.02 * size }.lines()
        });
        net.net(&left, 0.02 * size).unwrap();
        net.net(&right, 0.02 * size).unwrap();
        let pieces = net.pieces().unwrap();
        let count = |kind| pieces.iter().filter(|piece| piece.kind == kind).count();
        assert_eq!((count(ComponentKind::Line), count(ComponentKind::Point)), (12 + 12 - 2, 15));
    }
}

/// On one line: two that overlap, one within them, one that goes on from their end; and another
/// line beside them, and across.
#[test]
fn lines_that_overlap_are_joined() {
    let along = DVec3::new(0.3, -0.7, 0.2);
    let aside = DVec3::new(0.0, 0.1, 0.0);
    let at = |place: f64| DVec3::new(0.1, 0.2, 0.3) + place * along;
    let segments = [
        [at(0.0), at(2.0)],
        [at(3.0), at(1.0)],
        [at(1.5), at(1.7)],
        [at(3.0), at(4.0)],
        [at(0.5) + aside, at(2.5) + aside],
        [at(0.5) + aside, at(2.5) - aside],
    ];
    let net = ControlNet {
        points: segments.iter().flatten().copied().collect(),
        lines: (0..segments.len()).map(|k| [2 * k, 2 * k + 1]).collect(),
    };
    let pieces = control_net(&net, &NetStyle { radius: 0.01, joints: 0.02 }).unwrap();
    let lines: Vec<&Component> =
        pieces.iter().filter(|piece| piece.kind == ComponentKind::Line).collect();
    assert_eq!(lines.len(), 4);
    // The joined line spans the whole length.
    let [_, [c, d]] = lines[0].surface.domain();
    let length = lines[0]
        .surface
        .point_at(DVec2::new(0.0, c))
        .distance(lines[0].surface.point_at(DVec2::new(0.0, d)));
    assert!((length - 3.0 * along.length()).abs() < 1e-14, "{length}");
}

/// The net of a tube with corners has rods of its balls within those of its cylinders.
#[test]
fn nets_of_tubes_with_corners_have_no_rods_within_others() {
    let way = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
    let way = NurbsCurve::polyline(&flat(&way, 1.0)).unwrap();
    let surfaces = tube(&way, &TubeStyle { radius: 0.1, ..TubeStyle::default() }).unwrap();
    let style = TubeStyle { radius: 0.02, caps: Caps::Open, tolerance: None };
    let mut drawing = Drawing::among([DVec3::splat(1.1)], style);
    for piece in &surfaces {
        drawing.net(&ControlNet::from(&piece.surface), 0.04).unwrap();
    }
    let rods: Vec<[DVec3; 2]> = (drawing.pieces().unwrap().iter())
        .filter(|piece| piece.kind == ComponentKind::Line)
        .map(|piece| {
            // The middles of the circles at both ends.
            let surface = &piece.surface;
            let [[a, b], [c, d]] = surface.domain();
            let middle = |v| {
                0.5 * (surface.point_at(DVec2::new(a, v))
                    + surface.point_at(DVec2::new(0.5 * (a + b), v)))
            };
            [middle(c), middle(d)]
        })
        .collect();
    for (index, &[a, b]) in rods.iter().enumerate() {
        let along = (b - a).normalize();
        for &[p, q] in rods.iter().skip(index + 1) {
            let off = |point: DVec3| (point - a).reject_from_normalized(along).length();
            let [s, t] = [p, q].map(|point| (point - a).dot(along));
            let common = s.max(t).min(a.distance(b)) - s.min(t).max(0.0);
            let overlap = off(p) < 1e-9 && off(q) < 1e-9 && common > 1e-9;
            assert!(!overlap, "{a} {b}, {p} {q}");
        }
    }
    // Nothing is lost: each line of each net lies on one of the rods.
    for piece in &surfaces {
        let net = ControlNet::from(&piece.surface);
        for [a, b] in net.lines.iter().map(|&ends| ends.map(|end| net.points[end])) {
            let covered = rods.iter().any(|&[p, q]| {
                [a, b].iter().all(|point| {
                    (point.distance(p) + point.distance(q) - p.distance(q)).abs() < 1e-12
                })
            });
            assert!(covered || a.distance(b) < 1e-12, "{a} {b}");
        }
    }
}

/// Many lines that meet at two poles and lie side by side take little time.
#[test]
fn many_lines_are_drawn_in_no_time() {
    let half = circle_arc(1.0, -90.0, 180.0).unwrap();
    let meridians = (0..2000).map(|k| {
        let turn = DAffine3::from_rotation_y(f64::from(k) / 2000.0 * std::f64::consts::TAU);
        half.transformed(&turn).unwrap()
    });
    let style = TubeStyle { radius: 1e-4, caps: Caps::Open, tolerance: None };
    let mut curved = Drawing::among([DVec3::ONE], style);
    let mut straight = Drawing::among([DVec3::ONE], style);
    for curve in meridians {
        curved.tube(&curve).unwrap();
        let middle = curve.point_at(0.5 * (curve.domain()[0] + curve.domain()[1]));
        let line = NurbsCurve::polyline(&[middle, middle + 0.3 * DVec3::Y]).unwrap();
        straight.tube(&line).unwrap();
    }
    assert_eq!(curved.pieces().unwrap().len(), 2000);
    assert_eq!(straight.pieces().unwrap().len(), 2000);
}

fn of_net(pieces: &[Component]) -> [usize; 2] {
    let kinds = [ComponentKind::Line, ComponentKind::Point];
    kinds.map(|kind| pieces.iter().filter(|p| p.kind == kind).count())
}

#[test]
fn poles_and_seams_are_drawn_once() {
    for size in [1e-8, 1.0, 1e8] {
        let style = NetStyle { radius: 0.02 * size, joints: 0.05 * size };
        let hemisphere = shapes::hemisphere(size).unwrap();
        // Two poles, 8 points; rows of 3 lines twice, columns of 3 lines four times.
        assert_eq!(
            of_net(&control_net(&ControlNet::from(&hemisphere), &style).unwrap()),
            [6 + 12, 10]
        );
        // The sphere's net closes: 6 columns, of which one begins and ends the rows.
        let sphere = shapes::sphere(size).unwrap();
        assert_eq!(
            of_net(&control_net(&ControlNet::from(&sphere), &style).unwrap()),
            [12 + 18, 14]
        );
    }
    let polygon = ControlNet::from(&shapes::circle_cubic());
    let polygon = control_net(&polygon, &NetStyle { radius: 0.1, joints: 0.2 });
    assert_eq!(of_net(&polygon.unwrap()), [6, 6]);
    // A quartic triangle: 15 points, and the sides of 10 small triangles.
    let octant = ControlNet::from(&shapes::octant_quartic(1.0).unwrap());
    let octant = control_net(&octant, &NetStyle { radius: 0.01, joints: 0.02 });
    assert_eq!(of_net(&octant.unwrap()), [30, 15]);
}

#[test]
fn radii_must_be_lengths() {
    let plane = ControlNet::from(&shapes::plane(1.0, 1.0).unwrap());
    let message =
        |radius, joints| control_net(&plane, &NetStyle { radius, joints }).unwrap_err().to_string();
    assert_eq!(message(-1.0, 1.0), "tube: radius -1: it must be positive and finite");
    let knots = KnotVector::uniform(1, 300).unwrap();
    let points = (0..90_000).map(|k| DVec3::new(f64::from(k % 300), f64::from(k / 300), 0.0));
    let large = NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap();
    assert_eq!(
        control_net(&ControlNet::from(&large), &NetStyle { radius: 0.1, joints: 0.2 })
            .unwrap_err()
            .to_string(),
        "90000 control points: nets of up to 65536 can be drawn"
    );
    let nowhere = ControlNet { points: vec![DVec3::ZERO, DVec3::NAN], lines: Vec::new() };
    assert_eq!(
        control_net(&nowhere, &NetStyle { radius: 0.1, joints: 0.2 }).unwrap_err().to_string(),
        "control point 1 of the net is (NaN, NaN, NaN): coordinates must be finite (up to 1e70)"
    );
    assert_eq!(message(1.0, 0.0), "joint radius 0: it must be positive and finite");
}

#[test]
fn lines_must_end_at_vertices() {
    let style = NetStyle { radius: 0.1, joints: 0.2 };
    let message = |lines: &[[usize; 2]]| {
        let net = ControlNet { points: vec![DVec3::ZERO, DVec3::X], lines: lines.to_vec() };
        control_net(&net, &style).unwrap_err().to_string()
    };
    let counted = "but the net has 2 control points; lines and vertices count from 0";
    assert_eq!(message(&[[0, 1], [0, 7]]), format!("line 1 ends at vertex 7, {counted}"));
    assert_eq!(message(&[[2, 0]]), format!("line 0 ends at vertex 2, {counted}"));
}
