//! Paths with two knots that were meant to be one.

use glam::{DAffine3, DQuat, DVec2, DVec3};

use super::path::kinks;
use super::stops::without_stops;
use super::{ComponentKind, ConstructError, SweepOptions, TubeStyle, sweep, tube};
use crate::geometry::shapes::circle_arc;
use crate::geometry::{KnotVector, NurbsCurve};

const WAVE: [[f64; 2]; 6] =
    [[0.0, 0.0], [1.0, 1.0], [2.0, 1.5], [3.0, 1.0], [4.0, 0.0], [5.0, 1.0]];

/// A cubic with two knots in the middle of its domain this far apart.
fn wave(gap: f64) -> NurbsCurve {
    let points = WAVE.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.5, 0.5 + gap, 1.0, 1.0, 1.0, 1.0];
    NurbsCurve::new(KnotVector::new(3, knots).unwrap(), points, None).unwrap()
}

/// Gaps from one spacing of numbers at 0.5 up to where nothing is short.
fn gaps() -> impl Iterator<Item = f64> {
    (2..=16).flat_map(|power| [1.0, 1.7, 3.1, 6.2].map(|k| k * 10_f64.powi(-power)))
}

fn thin() -> TubeStyle {
    TubeStyle { radius: 0.05, ..TubeStyle::default() }
}

#[test]
fn no_bends_and_no_kinks_between_knots_that_nearly_agree() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let profile = circle_arc(0.05, 0.0, 360.0).unwrap();
    let same = sweep(&profile, &wave(0.0), &SweepOptions::default()).unwrap().surface;
    for gap in gaps() {
        let path = wave(gap);
        let made = sweep(&profile, &path, &SweepOptions::default());
        let made = made.unwrap_or_else(|error| panic!("{gap:e}: {error}"));
        for (u, v) in (0..=12).flat_map(|i| (0..=24).map(move |j| (i, j))) {
            let (u, v) = (f64::from(u) / 12.0, f64::from(v) / 24.0);
            let off =
                made.surface.point_at(DVec2::new(u, v)).distance(same.point_at(DVec2::new(u, v)));
            // The curve itself moves by less than its speed, about 10, times the gap.
            assert!(off < 2.0 * made.deviation + 10.0 * gap, "{gap:e}: {off:e} at ({u}, {v})");
        }
        for at in [DVec3::ZERO, DVec3::new(30.0, -200.0, 100.0)] {
            let placed = path.transformed(&DAffine3::from_rotation_translation(turn, at)).unwrap();
            let pieces = tube(&placed, &thin()).unwrap_or_else(|error| panic!("{gap:e}: {error}"));
            let kinds: Vec<ComponentKind> = pieces.iter().map(|piece| piece.kind).collect();
            assert_eq!(kinds, [ComponentKind::Tube, ComponentKind::Cap, ComponentKind::Cap]);
        }
    }
}

/// Where a parabola and a line meet with one tangent, the curvature jumps, and the two knots make
/// a piece of one of them. A run of slivers is taken over as a whole, at the ends as well.
#[test]
fn a_neighbour_takes_the_place_of_slivers() {
    let parabola = NurbsCurve::bezier(&[DVec3::ZERO, DVec3::X, DVec3::new(2.0, 2.0, 0.0)]).unwrap();
    let [start, end] = parabola.domain();
    let cut = |at: &[f64]| {
        let refined = at.iter().fold(parabola.clone(), |c, &t| c.insert_knot(t, 2).unwrap());
        without_stops(&refined).unwrap()
    };
    let t = 0.3;
    for gap in [1e-7, 1e-9, 1e-11, 1e-13] {
        let inside = [t, t + gap, t + 2.0 * gap, t + 3.5 * gap];
        for (at, spans) in [(&inside[..2], 2), (&inside, 2), (&[gap], 1), (&[1.0 - gap], 1)] {
            let through = cut(at);
            assert_eq!(through.knots().spans().count(), spans, "{at:?}");
            assert_eq!(through.domain(), [start, end]);
            assert_eq!(kinks(&through), Ok(vec![]), "{at:?}");
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let [a, b] = [&through, &parabola].map(|curve| curve.derivatives(t));
                assert!(a.point.distance(b.point) < 1e-14, "{at:?}, {t}");
                assert!(a.second.distance(b.second) < 1e-6, "{at:?}, {t}");
            }
        }
    }
    // A piece that is long enough is left alone.
    assert_eq!(cut(&[t, t + 1e-4]).knots().spans().count(), 3);
}

/// Two lines joined by a quarter of a circle of radius r: they fold a tube that is thicker, however
/// small the arc; once it is rounding, they meet at a corner.
#[test]
fn bends_that_are_tight_are_still_refused() {
    let rounded = |r: f64| {
        let points = [[-1.0, 0.0], [-0.5, 0.0], [0.0, 0.0], [r, 0.0], [r, r], [r, 0.5], [r, 1.0]];
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let weights = vec![1.0, 1.0, 1.0, 0.5_f64.sqrt(), 1.0, 1.0, 1.0];
        let knots = [(0.0, 3), (1.0, 2), (1.0 + r, 2), (2.0, 3)];
        let knots = KnotVector::with_multiplicities(2, &knots).unwrap();
        NurbsCurve::new(knots, points, Some(weights)).unwrap()
    };
    for r in [1e-2, 1e-4, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
        let ConstructError::Fold { radius, .. } = tube(&rounded(r), &thin()).unwrap_err() else {
            panic!("{r}")
        };
        assert!((radius / r - 1.0).abs() < 1e-3, "{r}: {radius}");
    }
    let corner = tube(&rounded(1e-14), &thin()).unwrap();
    assert_eq!(corner.iter().filter(|piece| piece.kind == ComponentKind::Joint).count(), 1);
    let kink = kinks(&without_stops(&rounded(1e-14)).unwrap()).unwrap()[0];
    assert!((kink.degrees - 90.0).abs() < 1e-9, "{kink:?}");
}
