//! Cuts Bézier pieces where they turn around in u or in v, and then until they are flat.

use glam::{DVec2, DVec3};

use super::UvBox;
use super::curve::euclidean;
use super::loop_piece::LoopPiece;
use super::segment::Segment;
use crate::geometry::curve::{FINEST_INTERVAL, add_extremes};
use crate::math::bernstein::restrict;
use crate::math::rounding::UNIT_ROUNDOFF;

/// The most halvings of a monotone stretch: a cusp never becomes flat.
const MOST_HALVINGS: u32 = 6;

/// A coordinate that goes back by no more than this times the largest of its control points does
/// not turn around: four roundings, which the error bound of a [`Segment`] has to spare. Control
/// points of straight sides are off by one or two.
const WIGGLE: f64 = 4.0 * UNIT_ROUNDOFF;

/// Appends the segments of a piece of a loop, monotone and flat ([`Segment::is_flat`]), in order.
/// Neighbours share their ends bit for bit, and the outer ends are the piece's own.
///
/// A stretch whose derivative does not exceed rounding error counts as monotone, and so does one
/// that goes back by no more than a [`WIGGLE`]: between the cuts the piece leaves the rectangle of
/// its ends by no more than that error, and [`Segment::at`] clamps to this rectangle.
pub(super) fn segments(piece: &LoopPiece, found: &mut Vec<Segment>) {
    // A piece of two control points is the line between its ends, whatever the weights.
    if piece.control.len() == 2 {
        found.extend(Segment::line(piece.ends));
        return;
    }

    // Both directions use the same cuts at the same numbers, so that a loop run backwards cuts the
    // same.
    let backwards = piece.control.iter().rev().map(as_key).lt(piece.control.iter().map(as_key));
    let mut control = piece.control.clone();
    let mut ends = piece.ends;
    if backwards {
        control.reverse();
        ends.reverse();
    }
    let mut cuts = vec![0.0];
    cuts.extend(turns(&control));
    cuts.push(1.0);

    let magnitude = hull(&control).magnitude();
    let first = found.len();
    let mut from = ends[0];
    for range in cuts.windows(2) {
        let last = (range[1] == 1.0).then_some(ends[1]);
        let range = [range[0], range[1]];
        let part = Part { control: &control, magnitude, range, halvings: 0 };
        from = part.add_flat(from, last, found);
    }
    if backwards {
        found[first..].reverse();
        for segment in &mut found[first..] {
            segment.turn_around();
        }
    }
}

/// A monotone stretch of a curve.
struct Part<'a> {
    /// The control points of the whole piece.
    control: &'a [DVec3],
    /// Their largest |u| and |v|.
    magnitude: DVec2,
    range: [f64; 2],
    halvings: u32,
}

impl Part<'_> {
    /// Adds the flat segments of this stretch from `from` to `last` or, without `last`, to the
    /// curve's own end of the stretch; returns the end.
    fn add_flat(&self, from: DVec2, last: Option<DVec2>, found: &mut Vec<Segment>) -> DVec2 {
        let degree = self.control.len() - 1;
        let mut part = self.control.to_vec();
        restrict(&mut part, self.range[0], self.range[1]);
        let to = last.unwrap_or_else(|| euclidean(part[degree]));
        let segment = Segment::new([from, to], &part, self.magnitude);
        let flat = segment.as_ref().is_none_or(Segment::is_flat);
        if flat || self.halvings == MOST_HALVINGS {
            found.extend(segment);
            return to;
        }
        let middle = 0.5 * (self.range[0] + self.range[1]);
        let half = |range| Self { range, halvings: self.halvings + 1, ..*self };
        let between = half([self.range[0], middle]).add_flat(from, None, found);
        half([middle, self.range[1]]).add_flat(between, Some(to), found)
    }
}

fn as_key(control: &DVec3) -> [f64; 3] {
    control.to_array()
}

fn hull(control: &[DVec3]) -> UvBox {
    UvBox::around(control.iter().map(|&c| euclidean(c)))
}

/// The parameters inside (0, 1) where u or v turns around, in order.
fn turns(control: &[DVec3]) -> Vec<f64> {
    let (center, wiggle) = (hull(control).center(), WIGGLE * hull(control).magnitude());
    let point = |t: f64| {
        let mut rest = control.to_vec();
        restrict(&mut rest, t, 1.0);
        euclidean(rest[0])
    };
    let mut turns = Vec::new();
    let weights: Vec<f64> = control.iter().map(|c| c.z).collect();
    for axis in 0..2 {
        let coordinate: Vec<f64> = control.iter().map(|c| c[axis]).collect();
        let mut extremes = Vec::new();
        add_extremes(&coordinate, &weights, center[axis], &mut extremes);
        turns.extend(without_wiggles(extremes, |t| point(t)[axis], wiggle[axis]));
    }
    turns.sort_by(f64::total_cmp);
    turns.dedup_by(|a, b| *a - *b <= FINEST_INTERVAL);
    turns.retain(|t| FINEST_INTERVAL < *t && *t < 1.0 - FINEST_INTERVAL);

    // Of turns in u and in v that are one point to within rounding, one is enough.
    let (mut before, end) = (point(0.0), point(1.0));
    turns.retain(|&t| {
        let here = point(t);
        let is_apart = |other: DVec2| (here - other).abs().cmpgt(wiggle).any();
        let is_turn = is_apart(before) && is_apart(end);
        if is_turn {
            before = here;
        }
        is_turn
    });
    turns
}

/// Those extremes of a coordinate between which it runs through more than `wiggle`, in order; from
/// one to the next, or to an end of the curve, it goes back by no more than that.
///
/// Of a zigzag, the smallest step is taken away until all are large enough: both its ends or, at an
/// end of the curve, the other one. The steps beside it are larger, so what is left is a zigzag.
fn without_wiggles(
    mut extremes: Vec<f64>,
    coordinate: impl Fn(f64) -> f64,
    wiggle: f64,
) -> Vec<f64> {
    extremes.sort_by(f64::total_cmp);
    let mut zigzag: Vec<(f64, f64)> = vec![(0.0, coordinate(0.0))];
    for t in extremes.into_iter().chain([1.0]) {
        let (here, count) = ((t, coordinate(t)), zigzag.len());
        // Where it goes on in one direction, there is no turn.
        let goes_on = |a: f64, b: f64, c: f64| a == b || b == c || (a < b) == (b < c);
        if count > 1 && goes_on(zigzag[count - 2].1, zigzag[count - 1].1, here.1) {
            zigzag.pop();
        }
        zigzag.push(here);
    }
    loop {
        let steps = zigzag.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).enumerate();
        let least = steps.min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((k, _)) = least.filter(|(_, step)| *step <= wiggle) else { break };
        let last = zigzag.len() - 1;
        zigzag.drain(k.max(1)..(k + 2).min(last));
        if last == 1 {
            break;
        }
    }
    zigzag[1..zigzag.len() - 1].iter().map(|&(t, _)| t).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns_of(points: &[(f64, f64, f64)]) -> Vec<f64> {
        let control: Vec<DVec3> =
            points.iter().map(|&(u, v, w)| DVec3::new(u * w, v * w, w)).collect();
        turns(&control)
    }

    #[test]
    fn turns_are_where_calculus_puts_them() {
        // u = t, v = 3t(1 − t)² + …: the cubic with v-values 0, 1, −1, 0 turns where
        // v′ = 3 (1 − 6t + 6t²) = 0.
        let third = 1.0 / 3.0;
        let s = turns_of(&[
            (0.0, 0.0, 1.0),
            (third, 1.0, 1.0),
            (2.0 * third, -1.0, 1.0),
            (1.0, 0.0, 1.0),
        ]);
        let root = 0.5 - 3f64.sqrt() / 6.0;
        assert_eq!(s.len(), 2, "{s:?}");
        assert!((s[0] - root).abs() < 1e-15 && (s[1] - (1.0 - root)).abs() < 1e-15, "{s:?}");

        // A parabola turns at exactly one half: the first cut is the root.
        assert_eq!(turns_of(&[(0.0, 0.0, 1.0), (0.5, 1.0, 1.0), (1.0, 0.0, 1.0)]), [0.5]);

        // The half circle x = 2t(1−t)/w, y = (1−2t)/w with w = 2t² − 2t + 1 turns in x only.
        let third = 1.0 / 3.0;
        let half = [(0.0, 1.0, 1.0), (2.0, 1.0, third), (2.0, -1.0, third), (0.0, -1.0, 1.0)];
        let cut = turns_of(&half);
        assert_eq!(cut.len(), 1, "{cut:?}");
        assert!((cut[0] - 0.5).abs() < 1e-15);
    }

    #[test]
    fn straight_and_doubly_touching_coordinates_are_left_whole() {
        // v = t³ stands still at 0 without turning around; u is constant.
        assert!(
            turns_of(&[(2.0, 0.0, 1.0), (2.0, 0.0, 0.5), (2.0, 0.0, 1.0), (2.0, 1.0, 1.0)])
                .is_empty()
        );
        // v = (2t − 1)³ stands still in the middle: a cut there does no harm, more would.
        let still = [(0.0, -1.0, 1.0), (1.0, 1.0, 1.0), (2.0, -1.0, 1.0), (3.0, 1.0, 1.0)];
        assert!(turns_of(&still).len() <= 1);
    }

    /// With the v-values 0, h, −1, 0 times a fifth, v turns at 2/3 for small h, and before that at
    /// about t = h / 2, where it has gone up by about 0.15 h².
    #[test]
    fn what_goes_back_by_rounding_only_does_not_turn() {
        let lifted = |h: f64| {
            let v = [0.3, 0.3 + 0.2 * h, 0.1, 0.3];
            turns_of(&[(0.1, v[0], 1.0), (0.3, v[1], 1.0), (0.6, v[2], 1.0), (0.9, v[3], 1.0)])
        };
        for h in [8e-16, 1e-14, 1e-12, 1e-10, 1e-9] {
            let s = lifted(h);
            assert_eq!(s.len(), 1, "{h}: {s:?}");
            assert!((s[0] - 2.0 / 3.0).abs() < 1e-9, "{h}: {s:?}");
        }
        for h in [1e-6, 1e-3] {
            let s = lifted(h);
            assert_eq!(s.len(), 2, "{h}: {s:?}");
            assert!((s[0] / (0.5 * h) - 1.0).abs() < 2.0 * h, "{h}: {s:?}");
        }
        // A line of degree 3 whose points are off by a rounding has no turns at all.
        let up = 0.7f64.next_up();
        assert!(
            turns_of(&[(0.0, 0.7, 1.0), (0.3, up, 1.0), (0.6, 0.7, 1.0), (1.0, up, 1.0)])
                .is_empty()
        );
        // Where u and v turn at one point, one cut is enough: u at 1/2, v at 1 / (2 − h).
        let fold = |h: f64| turns_of(&[(0.0, 0.0, 1.0), (1.0, 1.0, 1.0), (0.0, h, 1.0)]).len();
        assert_eq!([fold(1e-15), fold(1e-9), fold(1e-3)], [1, 1, 2]);
    }

    #[test]
    fn small_steps_are_taken_out_of_a_zigzag() {
        let heights = [0.0, 1.0, 0.9, 1.1, 1.0, 1.0, 0.2, 0.3, 0.0, 0.5];
        let last = heights.len() - 1;
        let t = |k: usize| k as f64 / last as f64;
        let height = |t: f64| heights[(t * last as f64).round() as usize];
        let left = |wiggle: f64| -> Vec<f64> {
            without_wiggles((1..last).map(t).collect(), height, wiggle)
                .into_iter()
                .map(height)
                .collect()
        };
        assert_eq!(left(0.0), [1.0, 0.9, 1.1, 0.2, 0.3, 0.0]);
        assert_eq!(left(0.12), [1.1, 0.0]);
        assert_eq!(left(0.6), [1.1]);
        assert!(left(2.0).is_empty());
    }

    #[test]
    fn turns_do_not_depend_on_where_the_curve_lies() {
        let curve = |du: f64, size: f64| {
            turns_of(&[
                (du, 0.0, 1.0),
                (du + size, 2.0 * size, 0.5),
                (du + 0.25 * size, 2.0 * size, 2.0),
                (du + 0.5 * size, 0.0, 1.0),
            ])
        };
        let here = curve(0.0, 1.0);
        assert!(here.len() >= 2, "{here:?}");
        for (du, size, tolerance) in [(1024.0, 1.0, 1e-9), (0.0, 1e-8, 1e-14), (0.0, 1e8, 1e-14)] {
            let there = curve(du, size);
            assert_eq!(here.len(), there.len());
            for (a, b) in here.iter().zip(there) {
                assert!((a - b).abs() < tolerance, "{du} {size}: {a} {b}");
            }
        }
    }

    #[test]
    fn segments_are_monotone_and_share_their_ends() {
        for degree in 2..=12 {
            let value = |k: usize, f: f64| ((k * k) as f64 * f).sin();
            let control: Vec<DVec3> = (0..=degree)
                .map(|k| {
                    let w = 1.0 + 0.9 * value(k, 0.7);
                    DVec3::new(w * value(k, 1.3), w * value(k, 2.1), w)
                })
                .collect();
            let ends = [euclidean(control[0]), euclidean(control[degree])];
            let mut found = Vec::new();
            segments(&LoopPiece { ends, control }, &mut found);
            let mut at = ends[0];
            for segment in &found {
                let [from, to] = segment.directed_ends();
                assert_eq!(from, at, "degree {degree}");
                at = to;
                let mut before = segment.ends()[0];
                let sense = segment.ends()[1] - segment.ends()[0];
                for k in 1..=64 {
                    let here = segment.free_at(f64::from(k) / 64.0);
                    let step = (here - before) * sense.signum();
                    assert!(step.min_element() > -1e-14, "degree {degree}: {step}");
                    before = here;
                }
            }
            assert_eq!(at, ends[1]);
        }
    }
}
