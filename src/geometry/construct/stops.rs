//! Removes stops from paths.
//!
//! A control point repeated more often than the degree holds a spline in one place for a whole
//! span; at a cusp a curve stands still for a moment and goes on in another direction. Neither
//! changes the shape: spans that stand still are left out, and a cusp is a corner like any other.

use glam::Vec4Swizzles;

use super::ConstructError;
use super::slivers::{Part, without_slivers};
use crate::geometry::curve::{SAME_PLACE, add_extremes};
use crate::geometry::{KnotVector, NurbsCurve};
use crate::math::bernstein::restrict;

/// A curve stands still at a place if the neighbouring control points are no farther from it than
/// this fraction of the largest coordinate: the rounding error of a vanishing derivative at a
/// parameter that is itself rounded. A curve that does not stand still is moved by less than that.
const STANDING: f64 = 4096.0 * f64::EPSILON;

/// The same curve, on the same domain, without the spans in which it stands still: the preceding
/// span takes over the parameters of an omitted span, at the beginning the following one. So do
/// the neighbours of [slivers](without_slivers). Cusps become knots, on both sides of which the
/// curve has a [`direction`](super::path::direction). A curve that has none of them is returned
/// unchanged.
///
/// # Errors
/// When the curve stands still everywhere.
pub(crate) fn without_stops(curve: &NurbsCurve) -> Result<NurbsCurve, ConstructError> {
    let pieces = curve.bezier_pieces();
    let magnitude = curve.magnitude();
    let mut moving: Vec<Part> = Vec::new();
    for piece in &pieces {
        if !stands_still(piece) {
            moving.extend(between_cusps(piece, magnitude));
        }
    }
    let [start, end] = curve.domain();
    if moving.is_empty() {
        let point = pieces[0].point_at(start);
        return Err(ConstructError::StandsStill { path: "path", t: start, point });
    }
    let joined = moving.windows(2).all(|pair| {
        let [a, b] = [pair[0].control[pair[0].control.len() - 1], pair[1].control[0]];
        (a.xyz() / a.w).distance(b.xyz() / b.w) <= STANDING * magnitude
    });
    if !joined {
        return Ok(curve.clone());
    }
    let moving = without_slivers(moving, magnitude);
    if moving.len() == pieces.len() && moving.iter().zip(&pieces).all(is_whole) {
        return Ok(curve.clone());
    }

    let p = curve.knots().degree();
    let mut knots = vec![(start, p + 1)];
    let mut control = moving[0].control.clone();
    for next in &moving[1..] {
        knots.push((next.start, p));
        // The two pieces must have the same weight where they meet; a common factor of a piece's
        // weights changes nothing.
        let factor = control[control.len() - 1].w / next.control[0].w;
        control.extend(next.control[1..].iter().map(|&point| factor * point));
    }
    knots.push((end, p + 1));
    let of_path = ConstructError::of("path");
    KnotVector::with_multiplicities(p, &knots)
        .map_err(Into::into)
        .and_then(|knots| NurbsCurve::from_homogeneous(knots, control))
        .map_err(of_path)
}

/// Whether a part is the whole of a piece.
fn is_whole((part, piece): (&Part, &NurbsCurve)) -> bool {
    part.start == piece.domain()[0] && part.control == piece.control()
}

fn stands_still(piece: &NurbsCurve) -> bool {
    let near = SAME_PLACE * piece.magnitude();
    (1..piece.control().len()).all(|index| piece.vertex(index).distance(piece.vertex(0)) <= near)
}

/// A Bézier piece cut at the places within it where it stands still.
fn between_cusps(piece: &NurbsCurve, magnitude: f64) -> Vec<Part> {
    let [start, end] = piece.domain();
    let degree = piece.knots().degree();
    let part = |from: f64, to: f64| {
        let mut control = piece.control().to_vec();
        if (from, to) != (0.0, 1.0) {
            restrict(&mut control, from, to);
        }
        control
    };
    let stands = |t: &f64| {
        let after = part(*t, 1.0);
        let before = part(0.0, *t);
        let legs = [[after[0], after[1]], [before[degree], before[degree - 1]]];
        // Near an end of the piece every leg is short; scaled to the whole piece it need not be.
        let lengths = legs.map(|[a, b]| (a.xyz() / a.w).distance(b.xyz() / b.w));
        (lengths[0] / (1.0 - t)).max(lengths[1] / t) <= STANDING * magnitude
    };
    let mut cuts = Vec::new();
    if degree > 1 {
        let weights: Vec<f64> = piece.control().iter().map(|c| c.w).collect();
        let middle = piece.point_at(0.5 * (start + end));
        for axis in 0..3 {
            let coordinate: Vec<f64> = piece.control().iter().map(|c| c[axis]).collect();
            add_extremes(&coordinate, &weights, middle[axis], &mut cuts);
        }
        cuts.retain(stands);
        cuts.sort_by(f64::total_cmp);
        // Merge the slightly different parameters that the coordinates give for one place.
        cuts.dedup_by(|next, before| *next - *before <= SAME_CUSP);
    }
    let ends: Vec<f64> = [0.0].into_iter().chain(cuts).chain([1.0]).collect();
    let parts = ends.windows(2).map(|pair| {
        let mut control = part(pair[0], pair[1]);
        // The rounding error of a vanishing derivative has no direction: make the derivative
        // vanish.
        if pair[0] > 0.0 {
            control[1] = control[0] / control[0].w * control[1].w;
        }
        if pair[1] < 1.0 {
            control[degree - 1] = control[degree] / control[degree].w * control[degree - 1].w;
        }
        Part { start: start + pair[0] * (end - start), control }
    });
    parts.collect()
}

/// Places of a piece that are no farther apart than this fraction of it are one cusp.
const SAME_CUSP: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::super::path::{kinks, smooth_parts};
    use super::*;
    use glam::DVec3;

    fn curve(degree: usize, points: &[[f64; 2]]) -> NurbsCurve {
        let points: Vec<DVec3> = points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
        let knots = KnotVector::clamped_uniform(degree, points.len()).unwrap();
        NurbsCurve::new(knots, points, None).unwrap()
    }

    /// The least distance from a point to densely sampled points of a curve.
    fn off(point: DVec3, curve: &NurbsCurve) -> f64 {
        let [start, end] = curve.domain();
        let at = |k: i32| curve.point_at(start + (end - start) * f64::from(k) / 20_000.0);
        (0..=20_000).map(|k| at(k).distance(point)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_control_point_four_times_is_a_corner_of_a_cubic() {
        let (a, b) = (1.0, 2.0);
        let times = |k: usize| {
            let mut points = vec![[0.0, 0.0], [1.0, 2.0]];
            points.extend(vec![[a, b]; k]);
            points.extend([[3.0, 2.0], [4.0, 0.0]]);
            curve(3, &points)
        };
        for k in [4, 5, 7] {
            let stopped = times(k);
            let through = without_stops(&stopped).unwrap();
            assert_eq!(through.domain(), stopped.domain());
            let found = kinks(&through).unwrap();
            assert_eq!(found.len(), 1, "{k}: {found:?}");
            assert!((found[0].degrees - 2f64.atan().to_degrees()).abs() < 1e-9, "{found:?}");
            assert!(through.point_at(found[0].t).distance(DVec3::new(a, b, 0.0)) < 1e-15);
            for share in 0..=40 {
                let [start, end] = stopped.domain();
                let t = start + (end - start) * f64::from(share) / 40.0;
                assert!(off(through.point_at(t), &stopped) < 1e-3, "{k}, {t}");
                assert!(off(stopped.point_at(t), &through) < 1e-3, "{k}, {t}");
            }
        }
        // Going straight on is not a corner, and a curve that never stops is unchanged.
        let on = curve(
            3,
            &[
                [0.0, 0.0],
                [1.0, 1.0],
                [2.0, 2.0],
                [2.0, 2.0],
                [2.0, 2.0],
                [2.0, 2.0],
                [3.0, 3.0],
                [4.0, 4.0],
            ],
        );
        assert_eq!(kinks(&without_stops(&on).unwrap()).unwrap(), []);
        let smooth = times(1);
        assert_eq!(without_stops(&smooth).unwrap(), smooth);
        let still = curve(2, &[[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]]);
        assert_eq!(
            without_stops(&still).unwrap_err(),
            ConstructError::StandsStill { path: "path", t: 0.0, point: DVec3::new(1.0, 1.0, 0.0) }
        );
    }

    #[test]
    fn a_cusp_is_a_corner() {
        // In the middle, and at 0.3: y² = x³ with x = (t − 0.3)², by blossoms.
        let middle = curve(3, &[[0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]);
        let blossom = |m: usize, k: usize| -> f64 {
            let (x, y) = (0.7, -0.3);
            match (m, k) {
                (2, 0) => y * y,
                (2, 1) => (2.0 * x * y + y * y) / 3.0,
                (2, 2) => (x * x + 2.0 * x * y) / 3.0,
                (2, _) => x * x,
                (_, k) => f64::powi(x, k as i32) * f64::powi(y, 3 - k as i32),
            }
        };
        let aside = curve(3, &[0, 1, 2, 3].map(|k| [blossom(2, k), blossom(3, k)]));
        for (curve, t) in [(middle, 0.5), (aside, 0.3)] {
            let through = without_stops(&curve).unwrap();
            let found = kinks(&through).unwrap();
            assert_eq!(found.len(), 1);
            assert!((found[0].t - t).abs() < 1e-9 && (found[0].degrees - 180.0).abs() < 1e-3);
            let parts = smooth_parts(&through).unwrap();
            assert!(parts[0].point_at(0.2).distance(curve.point_at(0.2)) < 1e-12);
        }
    }
}
