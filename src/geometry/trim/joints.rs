//! Closes the gaps between the pieces of a loop, without bending a piece.

use glam::DVec2;

use super::loop_piece::LoopPiece;
use super::{JOINT_TOLERANCE, UvBox};

/// Two pieces meet at a joint if this is no farther from the gap than so many times its width; then
/// their directions differ by an eighth at least. A chord closes other gaps.
const NEAR: f64 = 8.0;

/// The smallest weight of an extended piece, relative to the largest, as of a
/// [`TrimCurve`](super::TrimCurve).
const SMALLEST_WEIGHT: f64 = 1e-9;

/// The most steps of Newton's method, which doubles the number of digits at each.
const MOST_STEPS: usize = 8;

/// The smallest step, 2⁻⁵², in which a piece is followed away from its beginning.
const FINEST_STEP: i32 = 52;

/// The halvings that find where a piece leaves the surroundings of a gap, roughly.
const HALVINGS: u32 = 24;

/// How gaps are measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gauge {
    /// The loop's extent in u and in v, neither of them zero.
    pub(super) size: DVec2,
    /// The widest gap that is closed, in u and in v.
    pub(super) tolerance: DVec2,
    /// Ends that differ by no more than this are equal to within rounding.
    pub(super) rounding: DVec2,
}

impl Gauge {
    /// For loops of this extent.
    pub(super) fn new(bounds: UvBox) -> Self {
        let rounding = 16.0 * f64::EPSILON * bounds.magnitude();
        let tolerance = JOINT_TOLERANCE * bounds.size() + rounding;
        let size = bounds.size();
        let size = DVec2::select(size.cmpgt(DVec2::ZERO), size, DVec2::splat(size.max_element()));
        Self { size, tolerance, rounding }
    }

    /// The larger of the components, each relative to the loop's extent.
    pub(super) fn length(&self, vector: DVec2) -> f64 {
        (vector / self.size).abs().max_element()
    }
}

/// Makes every piece end where the next one begins. Pieces that join already stay as they are.
///
/// Both pieces end where they cross, or would cross if they went on; so most corners stay sharp.
/// Where they do so too far from the gap or, being parallel, nowhere, both end as far from the gap
/// as it is wide, and a chord joins them. Nothing changes farther from the gap than
/// [`NEAR`] times its width: moving the end of a piece would bend all of it.
pub(super) fn close(pieces: &mut Vec<LoopPiece>, gauge: &Gauge) {
    let mut chords = Vec::new();
    for this in 0..pieces.len() {
        let next = (this + 1) % pieces.len();
        let (end, start) = (pieces[this].ends[1], pieces[next].ends[0]);
        if end == start {
            continue;
        }
        if let Some(Meeting { places: [s, t], point }) =
            meeting([&pieces[this], &pieces[next]], gauge)
        {
            keep(pieces, [this, next], [s, t]);
            pieces[this].move_end(1, point);
            pieces[next].move_end(0, point);
        } else {
            let width = gauge.length(start - end);
            let s = 1.0 - pieces[this].reversed().leaving(width, gauge);
            let t = pieces[next].leaving(width, gauge);
            keep(pieces, [this, next], [s, t]);
            let ends = [pieces[this].ends[1], pieces[next].ends[0]];
            chords.push((next, LoopPiece::line(ends)));
        }
    }
    // Those before the first piece close the loop.
    for (next, chord) in chords.into_iter().rev() {
        let place = if next == 0 { pieces.len() } else { next };
        pieces.insert(place, chord);
    }
}

/// Ends a piece at `s` and begins the next one, perhaps the same, at `t`.
fn keep(pieces: &mut [LoopPiece], [this, next]: [usize; 2], [s, t]: [f64; 2]) {
    if this == next {
        pieces[this] = pieces[this].restricted(t, s);
    } else {
        pieces[this] = pieces[this].restricted(0.0, s);
        pieces[next] = pieces[next].restricted(t, 1.0);
    }
}

/// Where two consecutive pieces meet.
struct Meeting {
    /// The parameters of the first and the second piece.
    places: [f64; 2],
    point: DVec2,
}

/// Where two consecutive pieces `A` and `B` cross near the gap between them, if need be when they
/// are extended.
///
/// Solves `A(s) = B(t)` by Newton's method from `s = 1, t = 0`. `None` if it does not converge, or
/// if what is cut off or added, which lies in the hull of its control points, is not near.
fn meeting(pair: [&LoopPiece; 2], gauge: &Gauge) -> Option<Meeting> {
    let [a, b] = pair;
    let (end, start) = (a.ends[1], b.ends[0]);
    let [mut s, mut t] = [1.0, 0.0];
    let mut step = 0;
    loop {
        let ([p, along_a], [q, along_b]) = (a.at(s), b.at(t));
        let apart = p - q;
        if apart.abs().cmple(gauge.rounding).all() {
            break;
        }
        let det = along_b.perp_dot(along_a);
        s -= along_b.perp_dot(apart) / det;
        t -= along_a.perp_dot(apart) / det;
        step += 1;
        let nearby = (s - 1.0).abs() < 0.5 && t.abs() < 0.5; // false for NaN
        if !nearby || step > MOST_STEPS {
            return None;
        }
    }

    let middle = 0.5 * end + 0.5 * start;
    let most = NEAR * gauge.length(start - end);
    let near = |point: DVec2| {
        let off = point - middle;
        gauge.length(off) <= most && off.abs().cmple(gauge.tolerance).all()
    };
    let is_near = |piece: &LoopPiece, [from, to]: [f64; 2]| {
        from == to || piece.restricted(from, to).hull().all(near)
    };
    let sound = |piece: &LoopPiece, from: f64, to: f64| {
        let weights = piece.restricted(from, to).control.into_iter().map(|c| c.z);
        let (least, most) = weights.fold((f64::INFINITY, 0.0f64), |(least, most), weight| {
            (least.min(weight), most.max(weight))
        });
        least >= SMALLEST_WEIGHT * most
    };
    let accepted = sound(a, 0.0, s)
        && sound(b, t, 1.0)
        && is_near(a, [s.min(1.0), s.max(1.0)])
        && is_near(b, [t.min(0.0), t.max(0.0)]);
    if !accepted {
        return None;
    }
    // Of an end that stays and one that is computed, the former.
    let mut point = if s == 1.0 && (!b.is_line() || a.is_line() || t != 0.0) {
        end
    } else if t == 0.0 {
        start
    } else {
        a.at(s)[0]
    };
    for piece in [b, a] {
        for k in 0..2 {
            point[k] = piece.constant(k).unwrap_or(point[k]);
        }
    }
    Some(Meeting { places: [s, t], point })
}

impl LoopPiece {
    /// A parameter, at most one half, at which the piece is as far as `width` from its beginning,
    /// though nowhere much farther before; 0 if there is none.
    fn leaving(&self, width: f64, gauge: &Gauge) -> f64 {
        let is_beyond = |t: f64| gauge.length(self.at(t)[0] - self.ends[0]) >= width;
        let steps = (1..=FINEST_STEP).rev();
        let Some(mut far) = steps.map(|k| 0.5f64.powi(k)).find(|&t| is_beyond(t)) else {
            return 0.0;
        };
        let mut near = 0.5 * far;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            *(if is_beyond(middle) { &mut far } else { &mut near }) = middle;
        }
        far
    }
}
