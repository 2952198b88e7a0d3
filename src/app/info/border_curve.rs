//! A border or a trim edge as a sampled curve, and the distances of points from it.

use std::sync::Arc;

use glam::DVec3;
use nurbray::geometry::{Chart, TrianglePatch, TriangleSide, TrimEdge, TrimmedSurface};
use nurbray::math::Aabb;

use super::super::border::Border;
use super::around::Around;
use super::chain::Chain;
use super::source::Source;

/// The least number of intervals a border is sampled in. Spans get equal numbers of intervals,
/// and long spans more.
pub(crate) const INTERVALS: usize = 32;

/// How often, at most, intervals that stand for too much of a curve are divided: each time into up
/// to [`INTERVALS`] parts, so that this is enough for weights that differ by a factor of 1e6 or so.
const ROUNDS: usize = 6;

/// The most Newton steps to a nearest point. They double the correct digits from a start within
/// one of 32 intervals, so six would do for a smooth piece; the rest are for corners.
const STEPS: usize = 16;

/// A point of a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) t: f64,
    pub(crate) point: DVec3,
    /// The part of the curve's length that the sample stands for: half of the way to the samples
    /// before and behind.
    pub(crate) length: f64,
    /// Whether the surface ends there; if not, trims have cut the point off.
    pub(crate) kept: bool,
}

/// A border, or a trim edge from corner to corner, as a curve in space, with points on it.
#[derive(Debug)]
pub(crate) struct BorderCurve<'a> {
    source: Source<'a>,
    domain: [f64; 2],
    /// From end to end.
    samples: Vec<Sample>,
    /// The intervals between them, in boxes that hold the curve.
    chain: Chain,
    bounds: Aabb,
    length: f64,
    /// The estimated largest distance of the curve from the polyline through its samples.
    sag: f64,
}

/// The point of a curve nearest to another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// Its parameter.
    pub(crate) t: f64,
    pub(crate) point: DVec3,
    /// How far away it is.
    pub(crate) distance: f64,
}

impl<'a> BorderCurve<'a> {
    /// Samples a border. Returns `None` if trims leave nothing of it.
    pub(crate) fn new(chart: &'a Chart<'_>, border: Border) -> Option<Self> {
        let (surface, kept) = (&*chart.surface, border.kept(chart));
        let row = border.curve(surface);
        let source = Source::Border { surface, border, kept, row };
        let curve = Self::sampled(source, border.knots(surface).domain());
        curve.samples.iter().any(|sample| sample.kept).then_some(curve)
    }

    /// Samples a side of a triangle.
    pub(crate) fn of_side(patch: &'a TrianglePatch, side: TriangleSide) -> Self {
        let curve = patch.side(side);
        let domain = curve.domain();
        Self::sampled(Source::Side { patch, side, curve }, domain)
    }

    /// Samples a trim edge, corner by corner. Leaves out parts that are points, to within
    /// `rounding`, as along a pole.
    pub(crate) fn of_edge(trimmed: &'a TrimmedSurface, edge: TrimEdge, rounding: f64) -> Vec<Self> {
        let [start, end] = edge.domain();
        let corners = corners(edge.spans(), |t| edge.tangent_at(t), rounding);
        let edge = Arc::new(edge);
        let stops: Vec<f64> = [start].into_iter().chain(corners).chain([end]).collect();
        let part = |pair: &[f64]| {
            Self::sampled(Source::Edge { trimmed, edge: Arc::clone(&edge) }, [pair[0], pair[1]])
        };
        stops.windows(2).map(part).filter(|part| part.length > rounding).collect()
    }

    fn sampled(source: Source<'a>, domain: [f64; 2]) -> Self {
        // An edge of many corners is sampled in as many parts, each by its own knots only.
        let spans = source.spans(domain);
        let per_span = INTERVALS.div_ceil(spans.len());
        let within = spans.iter().flat_map(|&[start, end]| divided([start, end], per_span));
        let mut points: Vec<(f64, DVec3)> =
            within.chain([domain[1]]).map(|t| (t, source.point(t))).collect();

        // Spans may be of very different lengths, and curves whose weights differ may run through
        // most of theirs near an end; but no interval may stand for much of the curve.
        let chord = |pair: &[(f64, DVec3)]| pair[0].1.distance(pair[1].1);
        let length_of = |points: &[(f64, DVec3)]| points.windows(2).map(chord).sum::<f64>();
        for _ in 0..ROUNDS {
            let most = length_of(&points) / INTERVALS as f64;
            let finer = points.windows(2).flat_map(|pair| {
                // One part for NaN, as of a curve that is a point.
                let parts = (chord(pair) / most).ceil().max(1.0).min(INTERVALS as f64) as usize;
                divided([pair[0].0, pair[1].0], parts)
            });
            points = finer.chain([domain[1]]).map(|t| (t, source.point(t))).collect();
            if points.windows(2).all(|pair| chord(pair) <= 2.0 * most) {
                break;
            }
        }

        let length = length_of(&points);
        // Over two intervals a curve bulges four times as far from its chord as over one; but not
        // out of its plane, so that those of a stack have boxes apart.
        let bulge = |w: &[(f64, DVec3)]| to_segment(w[1].1, [w[0].1, w[2].1]).0;
        let bulges = points.windows(3).map(bulge);
        let (sag, margin) = bulges.fold((0.0, DVec3::ZERO), |(sag, margin), bulge: DVec3| {
            (bulge.length().max(sag), bulge.abs().max(margin))
        });
        let places: Vec<DVec3> = points.iter().map(|point| point.1).collect();
        let around = Aabb::around(places.iter().copied());
        let bounds = Aabb { min: around.min - margin, max: around.max + margin };
        let chain = Chain::new(&places, margin);
        let ways: Vec<f64> = points.windows(2).map(chord).collect();
        let way = |k: usize| ways.get(k).copied().unwrap_or(0.0);
        let samples = points.iter().enumerate().map(|(k, &(t, point))| {
            let length = 0.5 * (if k > 0 { way(k - 1) } else { 0.0 } + way(k));
            Sample { t, point, length, kept: source.keeps(t) }
        });
        Self { samples: samples.collect(), chain, source, domain, bounds, length, sag }
    }

    /// Boxes that hold it part by part.
    pub(crate) fn boxes(&self) -> &[Aabb] {
        self.chain.boxes()
    }

    /// Its length, by the polyline through its samples.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// The samples that trims keep.
    fn kept(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(|sample| sample.kept)
    }

    /// The length of what trims keep of it: within some 1e-9 of it where the curve is smooth between
    /// its knots and does not stand still.
    pub(crate) fn kept_arc_length(&self) -> f64 {
        let intervals = self.samples.windows(2).map(|pair| [pair[0].t, pair[1].t]);
        let kept = intervals.flat_map(|interval| self.source.kept_within(interval));
        kept.map(|range| arc_length(range, |t| self.source.point(t))).sum()
    }

    /// The length of what trims keep of it, by the polyline through its samples.
    pub(crate) fn kept_polyline_length(&self) -> f64 {
        self.kept().map(|sample| sample.length).sum()
    }

    /// The middle one of the samples that trims keep, of which there is one at least.
    pub(crate) fn kept_middle(&self) -> DVec3 {
        let middle = self.kept().nth(self.kept().count() / 2);
        middle.map_or(DVec3::NAN, |sample| sample.point)
    }

    /// Points on it, from end to end.
    pub(crate) fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The numbers of those samples that may be within `near` of another curve, in order.
    pub(crate) fn samples_beside(&self, other: &Self, near: f64) -> Vec<usize> {
        let mut beside = self.chain.beside(&other.chain, near);
        // The samples at both ends of each interval.
        let ends: Vec<usize> = beside.iter().map(|k| k + 1).collect();
        beside.extend(ends);
        beside.sort_unstable();
        beside.dedup();
        beside
    }

    /// The point of the curve nearest to another; `None` if it is more than `near` away, if the
    /// other one lies beyond the end of the curve nearest to it, or if trims have cut it off.
    pub(crate) fn nearest(&self, point: DVec3, near: f64) -> Option<Foot> {
        let reach = near + self.sag;
        let grown = self.bounds.grown(near);
        if !(grown.min.cmple(point).all() && point.cmple(grown.max).all()) {
            return None;
        }

        // The search starts on the nearest interval of the polyline.
        let from = |k: usize| {
            let [a, b] = [&self.samples[k], &self.samples[k + 1]];
            let (way, share) = to_segment(point, [a.point, b.point]);
            (way.length(), a.t + share * (b.t - a.t))
        };
        let nearest = self.chain.nearest(point, reach, |k| from(k).0)?;
        let (foot, beyond) = self.refined(point, from(nearest).1);
        let there = foot.distance <= near && beyond <= foot.distance.max(near) * BEYOND;
        (there && self.source.keeps(foot.t)).then_some(foot)
    }

    /// Which way the curve runs around its surface at `t`; `None` where that cannot be told.
    pub(super) fn around(&self, t: f64) -> Option<Around> {
        self.source.around(t)
    }

    /// Searches from `t` on for the point of the curve nearest to `point`. Returns it, and how far
    /// `point` lies beyond an end, along the curve.
    ///
    /// Gauss–Newton: `C(t + δ) ≈ C + δ C'` is nearest for `δ = (point − C) · C' / |C'|²`. On
    /// curves that meet, the residual is 0 and convergence quadratic.
    fn refined(&self, point: DVec3, mut t: f64) -> (Foot, f64) {
        let [start, end] = self.domain;
        let mut best = (Foot { t, point, distance: f64::INFINITY }, 0.0);
        for _ in 0..STEPS {
            let (on_curve, speed) = self.source.tangent(t);
            let step = (point - on_curve).dot(speed) / speed.length_squared();
            let beyond = match (t + step).clamp(start, end) {
                clamped if clamped == t => (step * speed).length(),
                _ => 0.0,
            };
            let distance = point.distance(on_curve);
            if distance < best.0.distance {
                best = (Foot { t, point: on_curve, distance }, beyond);
            }
            let next = (t + step).clamp(start, end);
            if next == t || next.is_nan() {
                break;
            }
            t = next;
        }
        best
    }
}

/// The parameters where a curve of these pieces turns a corner, if its points are known to within
/// `rounding`: between pieces that are long enough to have a direction. `at` gives the curve's
/// point and its derivative, where two pieces meet that of the second.
fn corners(
    pieces: impl Iterator<Item = [f64; 2]>,
    at: impl Fn(f64) -> [DVec3; 2],
    rounding: f64,
) -> Vec<f64> {
    let length = |[start, end]: [f64; 2]| {
        let [a, b, c] = [start, 0.5 * (start + end), end].map(|t| at(t)[0]);
        a.distance(b) + b.distance(c)
    };
    let pieces: Vec<[f64; 2]> = pieces.filter(|&piece| length(piece) > SLIVER * rounding).collect();
    let turns = |pair: &&[[f64; 2]]| {
        let [before, behind] = [pair[0][1].next_down(), pair[1][0]].map(|t| at(t)[1]);
        let goes_on = before.angle_between(behind) <= CORNER; // false for NaN, as for derivative 0
        !goes_on
    };
    pieces.windows(2).filter(turns).map(|pair| pair[1][0]).collect()
}

/// Parameters that cut a range into equal parts, without the range's end.
fn divided([start, end]: [f64; 2], parts: usize) -> impl Iterator<Item = f64> {
    (0..parts).map(move |k| start + (end - start) * k as f64 / parts as f64)
}

/// The length of a short, smooth part of a curve: from chords over all of it, over halves and over
/// quarters, which are too short by even powers of the steps (Richardson's extrapolation, twice).
fn arc_length([from, to]: [f64; 2], point: impl Fn(f64) -> DVec3) -> f64 {
    let points = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| point(from + share * (to - from)));
    let chords = |step: usize| -> f64 {
        (step..points.len()).step_by(step).map(|k| points[k].distance(points[k - step])).sum()
    };
    let [whole, halves, quarters] = [4, 2, 1].map(chords);
    let [coarse, fine] = [[whole, halves], [halves, quarters]].map(|[a, b]| b + (b - a) / 3.0);
    fine + (fine - coarse) / 15.0
}

/// The turn of a trim edge, in radians, above which it has a corner: 12°, as in
/// [`SIDE_BY_SIDE`](super::neighbours::SIDE_BY_SIDE).
const CORNER: f64 = 0.21;

/// The direction of a piece that is no longer than so many error bounds of its points is not known
/// to within half of [`CORNER`]: such slivers are left where curves of CAD files end just beside
/// the surface's knots.
const SLIVER: f64 = 16.0;

/// A point that lies beyond the end of a curve by more than this share of what counts as near
/// is beside another part of the model.
const BEYOND: f64 = 1e-3;

/// The way to a point from the nearest one of a segment, and where on it (0 to 1) that is.
fn to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> (DVec3, f64) {
    let along = b - a;
    let share = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share }; // a segment that is a point
    (point - (a + share * along), share)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;
    use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
    use nurbray::geometry::{Charts, Direction, KnotVector, NurbsCurve, shapes};

    use super::*;

    #[test]
    fn distances_from_a_circle_are_exact() {
        let cylinder = shapes::cylinder(1.0, 2.0).unwrap();
        let whole = Chart::whole(&cylinder);
        let rim = Border::all(&cylinder)
            .into_iter()
            .filter_map(|border| BorderCurve::new(&whole, border))
            .find(|curve| (curve.length() - TAU).abs() < 0.05)
            .unwrap();
        let z = rim.samples()[0].point.z;
        for k in 0..50 {
            let (sin, cos) = (0.123 * f64::from(k)).sin_cos();
            for offset in [0.0, 1e-9, 1e-3] {
                let point = DVec3::new((1.0 + offset) * cos, (1.0 + offset) * sin, z);
                let distance = rim.nearest(point, 0.01).unwrap().distance;
                // Two evaluations round, and so does the point made here.
                assert!((distance - offset).abs() < 1e-15, "{k}: {distance} for {offset}");
            }
            assert!(rim.nearest(DVec3::new(0.9 * cos, 0.9 * sin, z), 0.01).is_none());
        }
    }

    /// A rim that trims leave whole, in one piece or in two. It is parametrised by four quarters of
    /// rational quadratics, so that these parts are arcs of no round angles: `angle` gives them.
    #[test]
    fn lengths_are_those_of_the_curves() {
        let cylinder = shapes::cylinder(1.0, 2.0).unwrap();
        let [from, to] = cylinder.knots(Direction::U).domain();
        let at = |share: f64| from + share * (to - from);
        let angle = |share: f64| {
            let point = cylinder.point_at(DVec2::new(at(share), 0.0));
            point.y.atan2(point.x).rem_euclid(TAU)
        };
        for parts in [&[[0.0, 0.5]][..], &[[0.1, 0.2]], &[[0.05, 0.3], [0.7, 0.71]]] {
            let corners = |&[a, b]: &[f64; 2]| {
                [(a, -1.0), (b, -1.0), (b, 0.5), (a, 0.5)].map(|(u, v)| DVec2::new(at(u), v))
            };
            let polygon = |part| TrimLoop::polygon(&corners(part)).unwrap();
            let loops: Vec<TrimLoop> = parts.iter().map(polygon).collect();
            let trims = Trims::new(TrimDomain::of(&cylinder).unwrap(), Kept::Odd, &loops).unwrap();
            let trimmed = TrimmedSurface::new(cylinder.clone(), trims).unwrap();
            let chart = &trimmed.charts()[0];
            let border = Border::all(&chart.surface).into_iter().find(|border| {
                border
                    .point(&cylinder, at(0.3))
                    .distance(cylinder.point_at(DVec2::new(at(0.3), 0.0)))
                    < 1e-12
            });
            let found = BorderCurve::new(chart, border.unwrap()).unwrap().kept_arc_length();
            let expected: f64 = parts.iter().map(|&[a, b]| angle(b) - angle(a)).sum();
            assert!((found - expected).abs() < 1e-9, "{parts:?}: {found}, not {expected}");
        }
    }

    /// Slivers no longer than rounding have no direction: they are no corners, and hide none.
    #[test]
    fn edges_have_corners_where_they_turn() {
        let tiny = 1e-15;
        let parts = |points: &[[f64; 2]]| {
            let count = points.len();
            let mut knots = vec![0.0];
            knots.extend((0..count).map(|k| k as f64));
            knots.push((count - 1) as f64);
            let points = points.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect();
            let edge = KnotVector::new(1, knots).unwrap();
            let curve = NurbsCurve::new(edge, points, None).unwrap();
            let pieces = curve.knots().spans().map(|span| [span.start, span.end]);
            let at = |t: f64| [curve.point_at(t), curve.derivatives(t).first];
            corners(pieces, at, tiny).len() + 1
        };
        assert_eq!(parts(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), 1);
        assert_eq!(parts(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), 2);
        assert_eq!(parts(&[[0.0, 0.0], [1.0, 0.0], [1.0, 2.0 * tiny], [2.0, 0.0]]), 1);
        assert_eq!(parts(&[[0.0, 0.0], [1.0, 0.0], [1.0 + tiny, tiny], [1.0, 1.0]]), 2);
        assert_eq!(parts(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1e-6], [2.0, 1e-6]]), 3);
    }

    #[test]
    fn points_beyond_an_end_are_not_beside_the_curve() {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let whole = Chart::whole(&plane);
        let curve = BorderCurve::new(&whole, Border::all(&plane)[0]).unwrap();
        let [first, .., last] = curve.samples() else { panic!("two points at least") };
        let (first, last) = (first.point, last.point);
        let along = (last - first).normalize();
        let distance = |from: DVec3| curve.nearest(from, 0.01).map(|foot| foot.distance);
        assert_eq!(distance(last), Some(0.0));
        assert_eq!(distance(last + 1e-3 * along), None);
        let beside = last + 1e-3 * along.cross(DVec3::Z);
        assert!((distance(beside).unwrap() - 1e-3).abs() < 1e-15);
    }
}
