//! Sides of loops along the seam of a periodic domain.

use glam::DVec2;

use super::{Kept, Side, TrimCurve, TrimDomain, TrimError, TrimLoop, Trims};
use crate::geometry::Direction;

/// A band around a cylinder whose two sides on the seam are off by up to this much.
fn band(wobble: f64) -> Result<Trims, TrimError> {
    let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap().periodic_in(Direction::U);
    let line = |points: &[(f64, f64)]| {
        TrimCurve::polyline(&points.iter().map(|&p| p.into()).collect::<Vec<DVec2>>()).unwrap()
    };
    let side = |points: [(f64, f64); 4]| TrimCurve::bezier(&points.map(DVec2::from), None).unwrap();
    let curves = [
        line(&[(0.0, 0.3), (1.0, 0.3)]),
        side([(1.0, 0.3), (1.0 - wobble, 0.4), (1.0 + wobble, 0.5), (1.0, 0.6)]),
        line(&[(1.0, 0.6), (0.0, 0.6)]),
        side([(0.0, 0.6), (-wobble, 0.5), (0.5 * wobble, 0.4), (0.0, 0.3)]),
    ];
    Trims::new(domain, Kept::Odd, &[TrimLoop::new(&curves).unwrap()])
}

#[test]
fn sides_along_a_seam_that_are_not_quite_straight_lie_on_it() {
    for wobble in [0.0, 1e-14, 1e-12, 1e-11, 1e-9, 9e-9] {
        let trims = band(wobble).unwrap();
        assert!((trims.widest_gap() - wobble).abs() <= wobble, "{wobble}");
        for v in [0.35, 0.41, 0.45, 0.5, 0.55] {
            for u in [0.0, 0.5 * wobble, 1e-9, 1e-3, 0.5, 1.0 - 1e-9, 1.0 - 0.5 * wobble, 1.0] {
                assert_ne!(trims.side_of(DVec2::new(u, v)), Side::Outside, "{wobble}: {u}, {v}");
            }
            assert_eq!(trims.side_of(DVec2::new(0.5, v)), Side::Inside);
        }
        assert_eq!(trims.side_of(DVec2::new(0.0, 0.7)), Side::Outside);
    }
    let error = band(1e-3).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(
        error.starts_with("loop 0 overlaps itself where the surface closes: it crosses its copy"),
        "{error}"
    );
}

/// The places of lines along v that are tested: the seam, and another one to and fro along which a
/// loop runs.
const SEAM: f64 = 0.0;
const INNER: f64 = 0.25;

/// A band on a cylinder between two lines around it, cut at `u = at`: its sides there begin at
/// v = 0.3 and end at v = `left` and `right`. The left one has corners in between.
fn slanted(at: f64, [left, right]: [f64; 2]) -> Trims {
    let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap().periodic_in(Direction::U);
    let corners = [(0.0, 0.3), (1.0, 0.3), (1.0, right), (0.0, left), (0.0, 0.5), (0.0, 0.4)];
    let outline = TrimLoop::polygon(&corners.map(|(u, v)| DVec2::new(at + u, v))).unwrap();
    Trims::new(domain, Kept::Odd, &[outline]).unwrap()
}

/// Whether these ranges of v, in order, are those of the pieces of edges that lie on `u = at`.
fn are_edges_on(at: f64, trims: &Trims, expected: &[[f64; 2]]) -> bool {
    let off = |a: f64, b: f64| (a - b).abs();
    let mut found = Vec::new();
    for piece in trims.edge_chains([&[], &[0.45]]).concat() {
        let [a, b] = [piece.control[0], piece.control[piece.control.len() - 1]];
        if off(a.x, b.x) < 1e-15 && off(a.x - at, (a.x - at).round()) < 1e-15 {
            found.push([a.y.min(b.y), a.y.max(b.y)]);
        }
    }
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let pairs = || found.as_flattened().iter().zip(expected.as_flattened());
    found.len() == expected.len() && pairs().all(|(a, b)| off(*a, *b) < 1e-15)
}

#[test]
fn what_is_kept_on_both_sides_is_no_edge_though_its_sides_end_beside_each_other() {
    // The domain's border cuts the loop and its copy, if it does not lie on them.
    for (at, chains) in [(SEAM, 2), (INNER, 4)] {
        for off in [0.0, 1e-16, 1e-15, 1e-12, 1e-10, 9e-9] {
            for ends in [[0.6, 0.6 + off], [0.6 + off, 0.6]] {
                let trims = slanted(at, ends);
                assert!(are_edges_on(at, &trims, &[]), "{at}: {ends:?}");
                assert_eq!(trims.edge_chains([&[], &[]]).len(), chains, "{at}: {ends:?}");
            }
        }
        // Beyond that, the rest of the longer side is an edge, together with the slanted line, but
        // not on the seam: that is a border.
        for off in [1e-7, 1e-3, 0.1] {
            for ends in [[0.6, 0.6 + off], [0.6 + off, 0.6]] {
                let trims = slanted(at, ends);
                let rest = if at == INNER { vec![[0.6, 0.6 + off]] } else { Vec::new() };
                assert!(are_edges_on(at, &trims, &rest), "{at}: {ends:?}");
                assert_eq!(trims.edge_chains([&[], &[]]).len(), chains, "{at}: {ends:?}");
            }
        }
    }
}

/// Three parts of a cylinder that lie beside each other at a line, along v from 0.2 to 0.8 on one
/// side, and from 0.1 to 0.4 and from 0.6 to 0.7 on the other.
#[test]
fn of_a_line_kept_on_one_side_that_part_is_an_edge_but_not_on_the_border() {
    let unit = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    let made = |domain: TrimDomain, at: f64| {
        let part = |u: [f64; 2], v: [f64; 2]| {
            TrimLoop::rectangle(super::UvBox::new(u.map(|u| at + u), v)).unwrap()
        };
        let left = [0.0, 0.25];
        let loops = [part([0.75, 1.0], [0.2, 0.8]), part(left, [0.1, 0.4]), part(left, [0.6, 0.7])];
        Trims::new(domain, Kept::Odd, &loops).unwrap()
    };
    let closed = unit.periodic_in(Direction::U);
    let one_sided = [[0.1, 0.2], [0.4, 0.45], [0.45, 0.6], [0.7, 0.8]];
    assert!(are_edges_on(INNER, &made(closed, INNER), &one_sided));
    for domain in [closed, unit] {
        assert!(are_edges_on(SEAM, &made(domain, SEAM), &[]));
    }
}

/// Circles whose copies, moved by a period, are less round than they were written.
#[test]
fn small_circles_on_a_seam_do_not_cross_themselves() {
    let unit = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    let domain = unit.periodic_in(Direction::U).periodic_in(Direction::V);
    let mut wrong = Vec::new();
    for k in 0..120 {
        let radius = if k == 0 { 1e-4 } else { 10f64.powf(-1.0 - 0.05 * f64::from(k)) };
        let u = [0.5, 0.0, 1.0, 0.01 * f64::from(k % 97)][k as usize % 4];
        let corner = DVec2::new(u, f64::from(u8::from(k / 4 % 2 == 0)));
        let circle = TrimLoop::circle(corner, radius).unwrap();
        if let Err(error) = Trims::new(domain, Kept::Odd, &[circle]) {
            wrong.push(format!("{corner} {radius}: {error}"));
        }
    }
    assert!(wrong.is_empty(), "{} wrong: {:#?}", wrong.len(), &wrong[..10.min(wrong.len())]);
}
