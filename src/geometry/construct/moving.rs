//! The frame that carries a profile, turned and scaled, and its approximation by splines.

use glam::DVec3;

use super::ConstructError;
use super::frames::{Frame, PieceFrames};
use super::net_size::net_size;
use super::path::{SAME_DIRECTION, angle};
use super::sweep_options::{FOLD_SAMPLES, Sweep, SweepOptions};
use crate::geometry::{KnotVector, NurbsCurve, NurbsSurface, Span, bernstein};

/// An affine frame, which carries `(x, y, z)` of the profile to
/// `origin + x axes[0] + y axes[1] + z axes[2]`; or the derivative of one.
#[derive(Clone, Copy, Debug)]
struct Carrier {
    origin: DVec3,
    axes: [DVec3; 3],
}

impl Carrier {
    fn carried(&self, p: DVec3) -> DVec3 {
        self.origin + p.x * self.axes[0] + p.y * self.axes[1] + p.z * self.axes[2]
    }

    /// Combines this carrier with another one, vector by vector.
    fn combined(&self, other: &Self, f: impl Fn(DVec3, DVec3) -> DVec3) -> Self {
        let axes = [0, 1, 2].map(|k| f(self.axes[k], other.axes[k]));
        Self { origin: f(self.origin, other.origin), axes }
    }
}

/// The true frames along a smooth path.
#[derive(Debug)]
pub(crate) struct MovingFrames {
    pieces: Vec<PieceFrames>,
    domain: [f64; 2],
    /// The whole turn about the path, in radians: the twist plus the turn that closes the sweep.
    turn: f64,
    scale: Vec<f64>,
    /// Whether the last frame equals the first.
    closes: bool,
}

impl MovingFrames {
    pub(crate) fn new(
        path: &NurbsCurve,
        first: Frame,
        options: &SweepOptions,
    ) -> Result<Self, ConstructError> {
        let mut frame = first;
        let mut done = Vec::new();
        for piece in path.bezier_pieces() {
            let frames = PieceFrames::new(piece, frame)?;
            frame = frames.last();
            done.push(frames);
        }
        let smooth_seam = angle(frame.tangent, first.tangent) <= SAME_DIRECTION;
        let mut turn = options.twist.to_radians();
        let closed = path.is_closed() && smooth_seam;
        if closed {
            // The frame comes back turned about the tangent by this angle: undo the turn.
            turn -= frame.normal.dot(first.side()).atan2(frame.normal.dot(first.normal));
        }
        let scale = options.scale.clone();
        let turns = options.twist / 360.0;
        let closes = closed && turns.fract() == 0.0 && scale[0] == scale[scale.len() - 1];
        Ok(Self { pieces: done, domain: path.domain(), turn, scale, closes })
    }

    /// The scale at a fraction of the domain, and its derivative with respect to that fraction.
    fn factor(&self, share: f64) -> (f64, f64) {
        let n = self.scale.len() - 1;
        let sum = |degree: usize, values: &mut dyn Iterator<Item = f64>| {
            bernstein(degree, share).map_or(f64::NAN, |basis| {
                values.zip(basis).map(|(value, function)| value * function).sum()
            })
        };
        let value = sum(n, &mut self.scale.iter().copied());
        if n == 0 {
            return (value, 0.0);
        }
        let steps = self.scale.windows(2).map(|pair| n as f64 * (pair[1] - pair[0]));
        (value, sum(n - 1, &mut { steps }))
    }

    /// The carrier at a parameter of one piece, and its derivative.
    ///
    /// The rotation-minimising frame moves by `r′ = −(r·t′) t`, `s′ = −(s·t′) t`; twist and
    /// scale follow by the product rule.
    fn at(&self, piece: &PieceFrames, t: f64) -> Result<(Carrier, Carrier), ConstructError> {
        let frame = piece.at(t)?;
        let path = piece.curve.derivatives(t);
        let (r, s, along) = (frame.normal, frame.side(), frame.tangent);
        let turning = (path.second - path.second.dot(along) * along) / path.first.length();
        // Not finite where the path stands still at an end. Any value will do there: the deviation
        // is measured afterwards.
        let turning = if turning.is_finite() { turning } else { DVec3::ZERO };
        let (r1, s1) = (-r.dot(turning) * along, -s.dot(turning) * along);

        let length = self.domain[1] - self.domain[0];
        let share = (t - self.domain[0]) / length;
        let (sin, cos) = (self.turn * share).sin_cos();
        let speed = self.turn / length;
        let (x, y) = (cos * r + sin * s, cos * s - sin * r);
        let (x1, y1) = (cos * r1 + sin * s1 + speed * y, cos * s1 - sin * r1 - speed * x);

        let (factor, growth) = self.factor(share);
        let growth = growth / length;
        let axes = [x, y, along].map(|axis| factor * axis);
        let moved = [(x, x1), (y, y1), (along, turning)];
        let moved = moved.map(|(axis, axis1)| growth * axis + factor * axis1);
        Ok((Carrier { origin: path.point, axes }, Carrier { origin: path.first, axes: moved }))
    }

    /// Refuses a sweep whose profile reaches beyond the centre of curvature, where it would run
    /// backwards. Ends of pieces, where a path may stand still, are sampled slightly inside.
    ///
    /// The error names the place where the profile reaches farthest relative to the radius of
    /// curvature. Between the samples, that place is searched for around those that are the
    /// farthest among their neighbours.
    pub(crate) fn check_folds(&self, profile: &NurbsCurve) -> Result<(), ConstructError> {
        let points = sampled(profile);
        let mut looked_at = Vec::with_capacity(self.pieces.len());
        for piece in &self.pieces {
            let bends = (0..=FOLD_SAMPLES).map(|k| self.bend(piece, k as f64, &points));
            looked_at.push(bends.collect::<Result<Vec<Bend>, _>>()?);
        }
        let mut worst = Bend::STRAIGHT;
        for bend in looked_at.iter().flatten() {
            worst = worst.or(*bend);
        }
        if worst.most >= NEAR_WORST {
            let enough = NEAR_WORST * worst.most;
            for (piece, bends) in self.pieces.iter().zip(&looked_at) {
                for k in (0..=FOLD_SAMPLES).filter(|&k| bends[k].most >= enough) {
                    let around = [k.saturating_sub(1), (k + 1).min(FOLD_SAMPLES)];
                    if around.iter().all(|&beside| bends[beside].most <= bends[k].most) {
                        worst = worst.or(self.worst_between(piece, around, &points)?);
                    }
                }
            }
        }
        let Bend { most, t, point, radius } = worst;
        if most >= 1.0 {
            let (what, path) = ("sweep", "path");
            let reach = most * radius;
            return Err(ConstructError::Fold { what, path, t, point, radius, reach });
        }
        Ok(())
    }

    /// The bend of a piece at a place, from 0 to [`FOLD_SAMPLES`] along the piece, and how far the
    /// points of a profile reach. Only as much of the bend counts as is not rounding: on a piece
    /// that is very short, the curvature that its control points seem to have may be nothing else.
    fn bend(
        &self,
        piece: &PieceFrames,
        place: f64,
        points: &[DVec3],
    ) -> Result<Bend, ConstructError> {
        let [start, end] = piece.curve.domain();
        let share = (place / FOLD_SAMPLES as f64).clamp(INSIDE, 1.0 - INSIDE);
        let t = start + (end - start) * share;
        let (carrier, _) = self.at(piece, t)?;
        let path = piece.curve.derivatives(t);
        let speed = path.first.length();
        let along = path.first / speed;
        let bend = (path.second - path.second.dot(along) * along) / (speed * speed);
        let reach = |p: &DVec3| bend.dot(p.x * carrier.axes[0] + p.y * carrier.axes[1]);
        let sure = (1.0 - piece.curve.curvature_error(t) / bend.length()).max(0.0); // 0 for NaN
        let most = sure * points.iter().map(reach).fold(0.0, f64::max);
        Ok(Bend { most, t, point: path.point, radius: 1.0 / bend.length() })
    }

    /// The worst place between two places that have a worse one between them, by golden sections.
    fn worst_between(
        &self,
        piece: &PieceFrames,
        [low, high]: [usize; 2],
        points: &[DVec3],
    ) -> Result<Bend, ConstructError> {
        let (mut low, mut high) = (low as f64, high as f64);
        let inner =
            |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let [mut a, mut b] = inner(low, high);
        let mut bends = [self.bend(piece, a, points)?, self.bend(piece, b, points)?];
        for _ in 0..SECTIONS {
            if bends[0].most >= bends[1].most {
                high = b;
                b = a;
                a = inner(low, high)[0];
                bends = [self.bend(piece, a, points)?, bends[0]];
            } else {
                low = a;
                a = b;
                b = inner(low, high)[1];
                bends = [bends[1], self.bend(piece, b, points)?];
            }
        }
        Ok(bends[0].or(bends[1]))
    }
}

/// Points all along a profile, some of them in every span, however short it is.
pub(super) fn sampled(profile: &NurbsCurve) -> Vec<DVec3> {
    let spans: Vec<Span> = profile.knots().spans().collect();
    let each = FOLD_SAMPLES.div_ceil(spans.len()).max(LEAST_IN_SPAN);
    let shares = (0..each).map(|k| k as f64 / each as f64);
    let inside = spans.iter().flat_map(|span| {
        shares.clone().map(move |share| span.start + share * (span.end - span.start))
    });
    inside.chain([profile.domain()[1]]).map(|t| profile.point_at(t)).collect()
}

/// How a path bends at a place.
#[derive(Clone, Copy, Debug)]
struct Bend {
    /// How far the profile reaches towards the centre of curvature, in radii of curvature.
    most: f64,
    t: f64,
    point: DVec3,
    radius: f64,
}

impl Bend {
    const STRAIGHT: Self = Self { most: 0.0, t: 0.0, point: DVec3::ZERO, radius: f64::INFINITY };

    /// The worse of two bends; `self` if they are equally bad.
    fn or(self, other: Self) -> Self {
        if other.most > self.most { other } else { self }
    }
}

/// If the worst sampled bend reaches this fraction of the way to the centre, the worst of all is
/// searched for around those samples that reach this fraction of the worst. Except where a path
/// almost has a corner, no bend doubles between two samples.
const NEAR_WORST: f64 = 0.5;

/// The golden ratio less 1.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The number of golden sections: these shorten the interval between two samples a million times,
/// which at a maximum leaves an error of a millionth of a millionth of its height.
const SECTIONS: usize = 29;

/// How far inside a piece, as a fraction of it, curvature is measured at its ends: if the path
/// stands still at an end, the first derivative there is only rounding error.
const INSIDE: f64 = 1.0 / 1024.0;

/// The most cubic pieces along a path, in addition to the pieces it has. Each halving divides the
/// error by sixteen: for a path of sixteen pieces, eight halvings reduce it from the size of the
/// objects to rounding error.
const MAX_PIECES: usize = 4096;

/// The least number of places inside each piece at which the deviation is measured. There are more
/// if the path and the scale have high degrees: their polynomials cannot vanish at all of them.
const PLACES: usize = 7;

/// An estimate of the largest distance along a piece, as a multiple of the largest at those places.
/// The error of Hermite's cubic is `t² (1 − t)²` times a nearly constant factor, and largest in the
/// middle of the piece; if the factor changes sign there, the largest error is 1.02 times that at
/// the places. It is no proved bound, as the factor may change more often.
const BETWEEN: f64 = 1.125;

/// The least number of points sampled in each span of a profile.
const LEAST_IN_SPAN: usize = 8;

/// The sweep approximated by cubic pieces that have the true frames and derivatives at their ends
/// (Hermite), halved until they are near enough.
pub(crate) fn approximate(
    profile: &NurbsCurve,
    frames: &MovingFrames,
    tolerance: f64,
) -> Result<Sweep, ConstructError> {
    let points: Vec<DVec3> = profile.points().collect();
    let mut columns: Vec<Carrier> = Vec::new();
    let mut breaks = vec![frames.domain[0]];
    let mut deviation: f64 = 0.0;
    for piece in &frames.pieces {
        // The remaining intervals, the first one last.
        let mut waiting = vec![piece.curve.domain()];
        while let Some([a, b]) = waiting.pop() {
            let (cubic, mut off) = hermite(frames, piece, [a, b], &points)?;
            if let Some(last) = columns.last() {
                // Where two pieces of the path meet, their directions may differ a little.
                off += farthest(points.iter().map(|&p| [last, &cubic[0]].map(|c| c.carried(p))));
            }
            if off <= tolerance {
                deviation = deviation.max(off);
                let shared = usize::from(!columns.is_empty());
                columns.extend(&cubic[shared..]);
                breaks.push(b);
                continue;
            }
            let middle = 0.5 * (a + b);
            let exhausted = breaks.len() + waiting.len() > MAX_PIECES + frames.pieces.len()
                || middle <= a
                || middle >= b;
            if exhausted {
                let (path, deviation, t, point) = ("path", off, a, piece.curve.point_at(a));
                return Err(ConstructError::NotHeld { path, tolerance, deviation, t, point });
            }
            waiting.extend([[middle, b], [a, middle]]);
        }
    }
    if frames.closes {
        let last = columns.len() - 1;
        columns[last] = columns[0];
    }

    let mut knots = vec![(breaks[0], 4)];
    knots.extend(breaks[1..breaks.len() - 1].iter().map(|&t| (t, 3)));
    knots.push((breaks[breaks.len() - 1], 4));
    let knots = KnotVector::with_multiplicities(3, &knots)
        .map_err(|error| ConstructError::Curve { which: "path".to_owned(), error: error.into() })?;
    let mut net = Vec::with_capacity(net_size(points.len(), columns.len())?);
    for (i, &point) in points.iter().enumerate() {
        let weight = profile.control()[i].w;
        net.extend(columns.iter().map(|column| (weight * column.carried(point)).extend(weight)));
    }
    let surface = NurbsSurface::from_homogeneous(profile.knots().clone(), knots, net)?;
    Ok(Sweep { surface, deviation })
}

/// The cubic between two parameters of a piece, as Bézier columns, and a measured estimate of its
/// largest distance from the true sweep.
fn hermite(
    frames: &MovingFrames,
    piece: &PieceFrames,
    [a, b]: [f64; 2],
    points: &[DVec3],
) -> Result<([Carrier; 4], f64), ConstructError> {
    let third = (b - a) / 3.0;
    let (first, speed) = frames.at(piece, a)?;
    let (last, arrival) = frames.at(piece, b)?;
    let cubic = [
        first,
        first.combined(&speed, |at, by| at + third * by),
        last.combined(&arrival, |at, by| at - third * by),
        last,
    ];
    let mut off: f64 = 0.0;
    let degrees = piece.curve.degree() + frames.scale.len() - 1;
    let places = PLACES.max(2 * degrees + 1);
    for k in 1..=places {
        let share = k as f64 / (places + 1) as f64;
        let (true_one, _) = frames.at(piece, a + share * (b - a))?;
        let basis = bernstein(3, share).unwrap_or([f64::NAN; crate::geometry::MAX_DEGREE + 1]);
        let ours = points.iter().map(|&p| {
            let carried = cubic.iter().zip(basis).map(|(c, function)| function * c.carried(p));
            [carried.sum::<DVec3>(), true_one.carried(p)]
        });
        off = off.max(farthest(ours));
    }
    Ok((cubic, BETWEEN * off))
}

/// The largest distance between two points of a pair; infinite if one is NaN.
fn farthest(pairs: impl Iterator<Item = [DVec3; 2]>) -> f64 {
    let known = |distance: f64| if distance.is_nan() { f64::INFINITY } else { distance };
    pairs.map(|[a, b]| known(a.distance(b))).fold(0.0, f64::max)
}
