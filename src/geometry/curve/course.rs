//! Curves that run back over themselves.
//!
//! A curve *folds* where it turns round (by 180°) and runs back over a stretch that it has just run
//! through, like a polyline that returns along one of its own sides, or a Bézier curve whose
//! control points lie on a line out of order. A surface made from it would cover itself twice. The
//! following are not folds: corners, however sharp; cusps whose two sides part from each other;
//! curves that touch or cross themselves; curves that run through a stretch again after they have
//! been elsewhere.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::{NurbsCurve, add_extremes};

/// Stretches no longer than this count as rounding: relative to the curve's extent, because several
/// coordinates may turn round at one place that each locates slightly differently (a triple root is
/// known to a third of the digits); and relative to its largest coordinate, because control points
/// are themselves rounded.
const ROUNDING: (f64, f64) = (16384.0 * f64::EPSILON, 16.0 * f64::EPSILON);

/// Points no farther apart than this many such lengths are the same: the two stretches may each
/// have lost one or two such lengths at their beginning.
const SAME_POINT: f64 = 4.0;

/// A stretch that is run through again is longer than this many such lengths: narrower features
/// cannot be told from a fold.
const LONGER: f64 = 64.0;

/// The number of places at which a stretch and the way back are compared. Two different curves of
/// degree p meet at no more than p² of them; corners and cusps part at the first one.
const PLACES: usize = 32;

/// The halvings of `[0, 1]` after which no number is left between the two ends.
const HALVINGS: usize = 60;

/// Where a curve folds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fold {
    /// The parameter where the curve turns round.
    pub(crate) t: f64,
    /// The two parameters, before and after `t`, of a place that the curve passes twice: halfway
    /// along.
    pub(crate) twice: [f64; 2],
    /// The parameter until which the curve runs back.
    pub(crate) until: f64,
}

/// A path to search for folds: a chain of rational Bézier pieces.
pub(crate) struct Course {
    pieces: Vec<CoursePiece>,
    closed: bool,
    /// The size of the box around its control points, and their largest coordinate.
    extent: f64,
    magnitude: f64,
    /// The length up to which stretches count as rounding.
    slack: f64,
}

/// A piece of a course, of any degree.
struct CoursePiece {
    domain: [f64; 2],
    control: Vec<DVec4>,
}

impl CoursePiece {
    /// The point at a share of the piece, by de Casteljau's algorithm.
    fn at(&self, share: f64) -> DVec3 {
        let mut d = self.control.clone();
        for last in (1..d.len()).rev() {
            for j in 0..last {
                d[j] = (1.0 - share) * d[j] + share * d[j + 1];
            }
        }
        d[0].xyz() / d[0].w
    }

    fn parameter(&self, share: f64) -> f64 {
        let [start, end] = self.domain;
        if share == 1.0 { end } else { start + share * (end - start) }
    }

    /// The shares at which a coordinate may turn around, with 0 and 1.
    fn cuts(&self) -> Vec<f64> {
        let mut cuts = vec![0.0, 1.0];
        if self.control.len() > 2 {
            let weights: Vec<f64> = self.control.iter().map(|point| point.w).collect();
            let middle = self.at(0.5);
            for axis in 0..3 {
                let coordinate: Vec<f64> = self.control.iter().map(|point| point[axis]).collect();
                add_extremes(&coordinate, &weights, middle[axis], &mut cuts);
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }
}

/// A part of a course along which no coordinate turns around.
#[derive(Clone, Copy)]
struct Stretch<'a> {
    piece: &'a CoursePiece,
    shares: [f64; 2],
    ends: [DVec3; 2],
}

impl Stretch<'_> {
    /// The same stretch in the other direction.
    fn back(self) -> Self {
        let ([a, b], [p, q]) = (self.shares, self.ends);
        Self { shares: [b, a], ends: [q, p], ..self }
    }

    fn run(&self) -> DVec3 {
        self.ends[1] - self.ends[0]
    }

    /// The share and the point at a distance from the beginning; the distance is the sum of the
    /// coordinate differences, which grows all along the stretch.
    fn at_distance(&self, distance: f64) -> (f64, DVec3) {
        let [mut near, mut far] = self.shares;
        if distance >= length(self.run()) {
            return (far, self.ends[1]);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            if length(self.piece.at(middle) - self.ends[0]) < distance {
                near = middle;
            } else {
                far = middle;
            }
        }
        (far, self.piece.at(far))
    }
}

fn length(vector: DVec3) -> f64 {
    vector.abs().element_sum()
}

impl Course {
    /// The course of a curve.
    pub(crate) fn in_space(curve: &NurbsCurve) -> Self {
        Self::mapped(curve, |piece| piece.control().to_vec())
    }

    /// The course of a curve's image: each of its Bézier pieces becomes one with these homogeneous
    /// control points, of any degree.
    pub(crate) fn mapped(curve: &NurbsCurve, image: impl Fn(&NurbsCurve) -> Vec<DVec4>) -> Self {
        let piece =
            |piece: NurbsCurve| CoursePiece { domain: piece.domain(), control: image(&piece) };
        let pieces = curve.bezier_pieces().into_iter().map(piece).collect();
        Self::new(pieces, curve.is_closed(), curve.magnitude())
    }

    /// A closed chain of Bézier pieces, given by their homogeneous control points; piece `k` spans
    /// the parameters from `k` to `k + 1`.
    pub(crate) fn closed(pieces: impl Iterator<Item = Vec<DVec4>>) -> Self {
        let piece = |(k, control)| CoursePiece { domain: [k as f64, (k + 1) as f64], control };
        let pieces: Vec<_> = pieces.enumerate().map(piece).collect();
        let points = pieces.iter().flat_map(|piece| &piece.control).map(|c| c.xyz() / c.w);
        let magnitude = points.map(|point| point.abs().max_element()).fold(0.0, f64::max);
        Self::new(pieces, true, magnitude)
    }

    /// The point at a parameter.
    pub(crate) fn point_at(&self, t: f64) -> DVec3 {
        let last = self.pieces.len() - 1;
        let piece =
            &self.pieces[self.pieces.partition_point(|piece| piece.domain[1] <= t).min(last)];
        let [start, end] = piece.domain;
        piece.at((t - start) / (end - start))
    }

    /// Whether the course stays in one place, up to rounding.
    pub(crate) fn is_point(&self) -> bool {
        self.extent <= 4.0 * ROUNDING.1 * self.magnitude
    }

    fn new(pieces: Vec<CoursePiece>, closed: bool, magnitude: f64) -> Self {
        let points = pieces.iter().flat_map(|piece| &piece.control).map(|c| c.xyz() / c.w);
        let (low, high) =
            points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        let extent = (high - low).max_element();
        let slack = ROUNDING.0 * extent + ROUNDING.1 * magnitude;
        Self { pieces, closed, extent, magnitude, slack }
    }

    /// The first place where the course turns round and runs back.
    pub(crate) fn fold(&self) -> Option<Fold> {
        self.folds().into_iter().next()
    }

    /// The places where the course turns round and runs back, in order.
    pub(crate) fn folds(&self) -> Vec<Fold> {
        let mut folds = Vec::new();
        let mut first: Option<Stretch<'_>> = None;
        let mut before: Option<Stretch<'_>> = None;
        for piece in &self.pieces {
            for shares in piece.cuts().windows(2) {
                let shares = [shares[0], shares[1]];
                let stretch = Stretch { piece, shares, ends: shares.map(|share| piece.at(share)) };
                // Where the course stands still, the stretches on both sides meet.
                if length(stretch.run()) <= self.slack {
                    continue;
                }
                folds.extend(before.and_then(|before| self.fold_between(before, stretch)));
                first = first.or(Some(stretch));
                before = Some(stretch);
            }
        }
        let seam = before.zip(first).filter(|_| self.closed);
        folds.extend(seam.and_then(|(last, first)| self.fold_between(last, first)));
        folds
    }

    /// The fold between two consecutive stretches, if the second runs back over the first.
    fn fold_between(&self, before: Stretch<'_>, after: Stretch<'_>) -> Option<Fold> {
        let back = before.back();
        let runs = [back.run(), after.run()];
        let parts = (0..3).any(|k| {
            let [a, b] = runs.map(|run| run[k]);
            a.abs().min(b.abs()) > self.slack && (a > 0.0) != (b > 0.0)
        });
        let common = length(runs[0]).min(length(runs[1]));
        if parts || common <= LONGER * self.slack {
            return None;
        }
        let meeting = |place: usize| {
            let distance = common * place as f64 / PLACES as f64;
            let [(s, p), (t, q)] = [back, after].map(|stretch| stretch.at_distance(distance));
            let together = p.distance(q) <= SAME_POINT * self.slack; // false for NaN
            together.then(|| [before.piece.parameter(s), after.piece.parameter(t)])
        };
        let both: Vec<[f64; 2]> = (1..=PLACES).map_while(meeting).collect();
        let until = both.get(PLACES - 1)?[1];
        Some(Fold { t: after.piece.parameter(after.shares[0]), twice: both[PLACES / 2 - 1], until })
    }
}
