//! Gaps between the curves of a loop.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::tests::{Random, trims};
use super::{Kept, Side, TrimCurve, TrimDomain, TrimLoop, TrimLoopError, Trims};
use crate::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};

fn points(list: &[(f64, f64)]) -> Vec<DVec2> {
    list.iter().map(|&point| point.into()).collect()
}

fn bezier(list: &[DVec2]) -> TrimCurve {
    TrimCurve::bezier(list, None).unwrap()
}

/// Curves as CAD files have them, whose ends are slightly off: gaps and overlaps are closed up to
/// the tolerance, wider ones are not.
#[test]
fn gaps_are_closed_up_to_the_tolerance() {
    let arc = |from, via, to| TrimCurve::bezier(&[from, via, to], None).unwrap();
    let lens = |gap: f64| {
        let (left, right) = (DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0));
        let off = DVec2::new(gap, 0.0);
        let below = arc(left, DVec2::new(0.0, -1.0), right);
        let above = arc(right + off, DVec2::new(0.0, 1.0), left + off);
        TrimLoop::new(&[below, above])
    };
    for gap in [0.0, 1e-9, 1.9e-4, -1.9e-4, 1.9e-3, -1.9e-3] {
        let closed = lens(gap).unwrap();
        // The loop is about two wide.
        assert!((closed.widest_gap() - 0.5 * gap.abs()).abs() <= gap * gap + 1e-15, "{gap}");
        let widest = closed.widest_gap();
        let trims = trims(&[closed]);
        assert_eq!(trims.widest_gap(), widest);
        // The curves run at 45° there, and one is extended until it meets the other.
        for end in [-1.0, 1.0] {
            let tip = DVec2::new(end + 0.5 * gap, 0.5 * end * gap);
            let side = trims.side_within(tip, DVec2::splat(gap.abs().powi(2)));
            assert!(matches!(side, Side::Edge { .. }), "{gap} at {end}");
            let way = DVec2::new(end * (1e-6 + 4.0 * gap * gap), 0.0);
            assert_eq!(trims.side_of(tip - way), Side::Inside, "{gap} at {end}");
            assert_eq!(trims.side_of(tip + way), Side::Outside, "{gap} at {end}");
        }
    }
    assert!(matches!(lens(2.1e-3), Err(TrimLoopError::Open { curve: 0, next: 1, .. })));
}

/// Lines that overshoot a corner or fall short of it are not tilted: they end where they meet.
#[test]
fn lines_stay_where_they_are() {
    let line = |a: (f64, f64), b: (f64, f64)| TrimCurve::line(a.into(), b.into()).unwrap();
    for off in [5e-5, -5e-5] {
        let (low, high) = (-off, 1.0 + off);
        let sides = [
            line((low, 0.0), (high, 0.0)),
            line((1.0, low), (1.0, high)),
            line((high, 1.0), (low, 1.0)),
            line((0.0, high), (0.0, low)),
        ];
        let square = TrimLoop::new(&sides).unwrap();
        let bounds = square.bounds();
        assert_eq!((bounds.min, bounds.max), (DVec2::ZERO, DVec2::ONE), "{off}");
        let square = trims(&[square]);
        for (u, v) in points(&[(0.0, 0.0), (1.0, 0.3), (0.7, 1.0)]).into_iter().map(Into::into) {
            assert!(matches!(square.side_of(DVec2::new(u, v)), Side::Edge { .. }), "{u}, {v}");
        }
        assert_eq!(square.side_of(DVec2::new(1e-9, 1e-9)), Side::Inside);
        assert_eq!(square.side_of(DVec2::new(0.5, -1e-9)), Side::Outside);
    }
}

/// Whether the loops pass through a point, and the answers on the two sides of it are certain and
/// differ.
fn is_edge_at(trims: &Trims, point: DVec2, normal: DVec2) -> bool {
    let sides = [1e-9, -1e-9].map(|off| trims.side_of(point + off * normal));
    matches!(trims.side_of(point), Side::Edge { .. })
        && sides.contains(&Side::Inside)
        && sides.contains(&Side::Outside)
}

/// The corner (1, 1) of a square of parabolas has a gap: the side u = 1 stays where it is, and so
/// does the other, in the middle of which the gap makes no difference.
#[test]
fn a_gap_at_a_corner_bends_no_side() {
    for gap in [(-8e-5, 0.0), (8e-5, 0.0), (0.0, 8e-5), (0.0, -8e-5), (5e-5, -5e-5), (3e-9, 0.0)] {
        let gap = DVec2::from(gap);
        let corners = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        let side = |from: DVec2, to: DVec2| bezier(&[from, 0.5 * (from + to), to]);
        let sides = [
            side(corners[0], corners[1]),
            side(corners[1], corners[2]),
            side(corners[2] + gap, corners[3]),
            side(corners[3], corners[0]),
        ];
        let there = TrimLoop::new(&sides).unwrap();
        for one in [there.reversed(), there] {
            let square = trims(&[one]);
            for k in 1..1000 {
                let along = f64::from(k) * 1e-3 - 5e-4;
                assert!(is_edge_at(&square, DVec2::new(1.0, along), DVec2::X), "{gap}: {along}");
                let top = (corners[2] + gap).lerp(corners[3], along);
                assert!(is_edge_at(&square, top, DVec2::Y), "{gap}: {top}");
                assert!(is_edge_at(&square, DVec2::new(along, 0.0), DVec2::Y), "{gap}: {along}");
            }
        }
    }
}

/// Two half circles whose ends are side by side, in front of each other, or both: a chord joins
/// them, and all that is not beside it keeps its distance from its own centre.
#[test]
fn a_gap_in_a_smooth_curve_bends_nothing() {
    for gap in [(3e-5, 0.0), (-3e-5, 0.0), (0.0, 3e-5), (0.0, -3e-5), (2e-5, 3e-5), (1e-11, 0.0)] {
        let gap = DVec2::from(gap);
        let halves = [
            TrimCurve::arc(DVec2::ZERO, 1.0, 0.0, PI).unwrap(),
            TrimCurve::arc(gap, 1.0, PI, TAU).unwrap(),
        ];
        let round = trims(&[TrimLoop::new(&halves).unwrap()]);
        for k in 0..2000 {
            let angle = TAU * (f64::from(k) + 0.5) / 2000.0;
            let normal = DVec2::from_angle(angle);
            let center = if angle < PI { DVec2::ZERO } else { gap };
            assert!(is_edge_at(&round, center + normal, normal), "{gap}: {angle}");
        }
        // Beside the chords nothing leaks.
        for side in [-1.0, 1.0] {
            for k in -100..=100 {
                let v = 2e-6 * f64::from(k);
                let [inner, outer] = [1.0 - 1e-4, 1.0 + 1e-4].map(|u| DVec2::new(side * u, v));
                assert_eq!(round.side_of(inner), Side::Inside, "{gap}: {v}");
                assert_eq!(round.side_of(outer), Side::Outside, "{gap}: {v}");
            }
        }
    }
}

/// Crescents, whose curves are tangent at the tip, with a gap there.
#[test]
fn a_gap_at_a_cusp_bends_nothing() {
    for gap in [2e-5, 1e-9, -1e-9, -5e-7] {
        let radii = [0.4, 0.2];
        let centers = [DVec2::new(0.5, 0.5), DVec2::new(0.7 - gap, 0.5)];
        let circles = [
            TrimCurve::arc(centers[0], radii[0], 0.0, TAU).unwrap(),
            TrimCurve::arc(centers[1], radii[1], TAU, 0.0).unwrap(),
        ];
        let crescent = trims(&[TrimLoop::new(&circles).unwrap()]);
        for (center, radius) in centers.into_iter().zip(radii) {
            for k in 20..1980 {
                let normal = DVec2::from_angle(TAU * f64::from(k) / 2000.0);
                let at = center + radius * normal;
                assert!(is_edge_at(&crescent, at, normal), "{gap}: {at}");
            }
        }
    }
}

/// A single curve, u = 3t(1 − t)(1 − 2t) and v = 3t(1 − t) but for a gap between its ends.
#[test]
fn the_two_ends_of_one_curve_may_have_a_gap() {
    for gap in [0.0, 5e-5, -5e-5] {
        let end = DVec2::new(gap, 0.0);
        let control = [DVec2::ZERO, DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), end];
        let drop = trims(&[TrimLoop::new(&[bezier(&control)]).unwrap()]);
        for k in 1..500 {
            let t = f64::from(k) / 500.0;
            let s = 1.0 - t;
            let at = 3.0 * t * s * DVec2::new(s - t, 1.0) + t * t * t * end;
            let along = DVec2::new(1.0 - 6.0 * t + 6.0 * t * t, 1.0 - 2.0 * t) + t * t * end;
            assert!(is_edge_at(&drop, at, along.perp().normalize()), "{gap}: {at}");
        }
    }
}

/// Stars of cubics with gaps of all directions and widths at all corners: the curves stay as they
/// are written, but for what lies within ten gaps of their ends.
#[test]
fn curves_stay_as_they_are_written() {
    let mut random = Random::new(31);
    for round in 0..200 {
        let count = 3 + round % 5;
        let mut corner = |k: usize| {
            let radius = 0.8 + 0.4 * random.next();
            radius * DVec2::from_angle(TAU * (k as f64 + 0.3 * random.next()) / count as f64)
        };
        let corners: Vec<DVec2> = (0..count).map(&mut corner).collect();
        let width = 1e-3 * 10f64.powf(-9.0 * random.next());
        let mut off = || width * (DVec2::new(random.next(), random.next()) - 0.5);
        let mut controls = Vec::new();
        for k in 0..count {
            let (from, to) = (corners[k] + off(), corners[(k + 1) % count] + off());
            let bulge = 1e3 * off() / width * 1e-4;
            let [third, two_thirds] = [1.0 / 3.0, 2.0 / 3.0].map(|t| from.lerp(to, t) + bulge);
            controls.push([from, third, two_thirds, to]);
        }
        let curves: Vec<TrimCurve> = controls.iter().map(|control| bezier(control)).collect();
        let star = trims(&[TrimLoop::new(&curves).unwrap()]);
        for control in &controls {
            for k in 0..200 {
                let t = (f64::from(k) + 0.5) / 200.0;
                let [a, b, c] = [0, 1, 2].map(|i| control[i].lerp(control[i + 1], t));
                let (from, to) = (a.lerp(b, t), b.lerp(c, t));
                let at = from.lerp(to, t);
                let away = at.distance(control[0]).min(at.distance(control[3]));
                if away > 10.0 * width + 1e-6 {
                    let normal = (to - from).perp().normalize();
                    assert!(is_edge_at(&star, at, normal), "{round}, {width:e}: {at}");
                }
            }
        }
    }
}

/// Pieces shorter than the gap, before and after it.
#[test]
fn pieces_may_be_shorter_than_gaps() {
    for gap in [1e-5, -1e-5, 5e-5, -5e-5] {
        for short in [1e-6, 1e-7] {
            let first = points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0 - short), (1.0, 1.0)]);
            let second = points(&[(1.0, 1.0), (1.0 - short, 1.0), (0.0, 1.0), (0.0, 0.0)]);
            for off in [DVec2::X, DVec2::Y, DVec2::ONE] {
                let second: Vec<DVec2> =
                    second.iter().map(|&at| at + gap * at.x * at.y * off).collect();
                let curves = [&first, &second].map(|list| TrimCurve::polyline(list).unwrap());
                let square = trims(&[TrimLoop::new(&curves).unwrap()]);
                for k in 0..1000 {
                    let v = f64::from(k) * 1e-3 + 5e-4;
                    assert!(is_edge_at(&square, DVec2::new(1.0, v), DVec2::X), "{gap}: {v}");
                }
            }
        }
    }
}

/// Curves that run up a cone to its tip at u = 0.7 and down from it at u = 0.2, as fractions of the
/// domain; `off` is how far from the tip they end.
fn up_and_down(cone: &NurbsSurface, off: f64) -> [TrimCurve; 3] {
    let [[u0, u1], [v0, v1]] = cone.domain();
    let at = |(u, v)| DVec2::new(u0 + u * (u1 - u0), v0 + v * (v1 - v0));
    let line = |from, to| TrimCurve::line(at(from), at(to)).unwrap();
    [
        line((0.2, 0.1), (0.7, 0.1)),
        line((0.7, 0.1), (0.7, 1.0 - off)),
        line((0.2, 1.0 + off), (0.2, 0.1)),
    ]
}

/// A loop may go from one place of a pole to any other, as the pole is a point.
#[test]
fn a_gap_along_a_pole_is_none() {
    let cone = shapes::cone(1.0, 2.0).unwrap();
    let [[u0, u1], [v0, v1]] = cone.domain();
    let domain = TrimDomain::with_seams_of(&cone).unwrap();
    for off in [0.0, 1e-15, 1e-7, 5e-5, -5e-5] {
        let curves = up_and_down(&cone, off);
        assert!(matches!(TrimLoop::new(&curves), Err(TrimLoopError::Open { curve: 1, .. })));
        let one = TrimLoop::on(&domain, &curves).unwrap();
        // The loop is 0.9 high.
        assert!((one.widest_gap() - off.abs() / 0.9).abs() < 1e-8, "{off:e}");
        for one in [one.reversed(), one] {
            let trims = Trims::new(domain, Kept::Odd, &[one]).unwrap();
            for k in 1..1000 {
                let place = |u: f64| {
                    let v = 0.1 + 0.9 * (1.0 - 0.98f64.powi(k));
                    trims.side_of(DVec2::new(u0 + u * (u1 - u0), v0 + v * (v1 - v0)))
                };
                assert_eq!([0.21, 0.69].map(place), [Side::Inside; 2], "{off:e}: {k}");
                assert_eq!([0.19, 0.71].map(place), [Side::Outside; 2], "{off:e}: {k}");
            }
        }
    }
    // A narrow gap: what is kept reaches to the tip.
    let at = |(u, v)| DVec2::new(u0 + u * (u1 - u0), v0 + v * (v1 - v0));
    let line = |from, to| TrimCurve::line(at(from), at(to)).unwrap();
    let (left, right) = ((0.45, 1.0), (0.4501, 1.0));
    let sides = [line((0.2, 0.1), (0.7, 0.1)), line((0.7, 0.1), right), line(left, (0.2, 0.1))];
    let narrow = TrimLoop::on(&domain, &sides).unwrap();
    assert_eq!(narrow.widest_gap(), 0.0);
    let narrow = Trims::new(domain, Kept::Odd, &[narrow]).unwrap();
    for below in [1e-3, 1e-6, 1e-9, 1e-12] {
        assert_eq!(narrow.side_of(at((0.45005, 1.0 - below))), Side::Inside, "{below:e}");
    }

    // Too far from the tip; without a tip; and at the other end, which is a circle.
    assert!(TrimLoop::on(&domain, &up_and_down(&cone, 0.01)).is_err());
    let without = TrimDomain::of(&cone).unwrap();
    assert!(TrimLoop::on(&without, &up_and_down(&cone, 0.0)).is_err());
    let upside_down = TrimDomain::with_seams_of(&cone.reversed_v()).unwrap();
    assert!(TrimLoop::on(&upside_down, &up_and_down(&cone, 0.0)).is_err());
}

/// Where two sides are one point, a loop may go from one of them to the other.
#[test]
fn a_gap_around_the_corner_of_two_poles_is_none() {
    let (o, x, y) = (DVec3::ZERO, DVec3::X, DVec3::Y);
    let points = vec![o, o, o, o, x, DVec3::ONE, o, y, x + y];
    let knots = || KnotVector::bezier(2).unwrap();
    let leaf = NurbsSurface::new(knots(), knots(), points, None).unwrap();
    let (reversed_u, reversed_v) = (leaf.reversed_u(), leaf.reversed_v());
    let corners = [
        (leaf.clone(), DVec2::ZERO),
        (reversed_u.clone(), DVec2::X),
        (reversed_v, DVec2::Y),
        (reversed_u.reversed_v(), DVec2::ONE),
    ];
    for (leaf, corner) in corners {
        two_poles_at(&leaf, corner);
    }
}

/// Curves around a corner of the unit square, whose two sides are one point.
fn two_poles_at(leaf: &NurbsSurface, corner: DVec2) {
    let domain = TrimDomain::with_seams_of(leaf).unwrap();
    let at = |(u, v): (f64, f64)| (corner - DVec2::new(u, v)).abs();
    let line = |from, to| TrimCurve::line(at(from), at(to)).unwrap();
    let there = [line((0.0, 0.9), (0.8, 0.9)), line((0.8, 0.9), (0.8, 0.0))];
    let back = [line((0.8, 0.0), (0.8, 0.9)), line((0.8, 0.9), (0.0, 0.9))];
    let without = TrimDomain::of(leaf).unwrap();
    for curves in [there, back] {
        assert!(TrimLoop::on(&without, &curves).is_err());
        let one = TrimLoop::on(&domain, &curves).unwrap();
        assert_eq!(one.widest_gap(), 0.0);
        let trims = Trims::new(domain, Kept::Odd, &[one]).unwrap();
        for inside in [(1e-9, 1e-9), (0.01, 0.89), (0.79, 0.01), (0.4, 0.4)] {
            assert_eq!(trims.side_of(at(inside)), Side::Inside, "{inside:?} at {corner}");
        }
        for outside in [(0.81, 0.4), (0.4, 0.91), (0.01, 0.91)] {
            assert_eq!(trims.side_of(at(outside)), Side::Outside, "{outside:?} at {corner}");
        }
    }
}

/// Surfaces run backwards have their poles at the other ends.
#[test]
fn poles_are_turned_around_with_the_surface() {
    for surface in [shapes::disk(1.0), shapes::cone(1.0, 1.0), shapes::sphere_biquadratic(1.0)] {
        let surface = surface.unwrap();
        let domain = TrimDomain::with_seams_of(&surface).unwrap();
        let bounds = domain.bounds();
        let hole = TrimLoop::circle(bounds.center(), 0.2 * bounds.size().min_element()).unwrap();
        let trims = Trims::new(domain, Kept::Even, &[hole]).unwrap();
        let backwards = TrimmedSurface::new(surface, trims).unwrap().reversed_u();
        let domain = TrimDomain::with_seams_of(backwards.surface()).unwrap();
        assert_eq!(backwards.trims().domain(), domain);
    }
}
