//! Curves joined into a closed loop.

use glam::{DVec2, DVec3, DVec4};

use super::curve::euclidean;
use super::joints::{self, Gauge};
use super::lobes::LOBE_TOLERANCE;
use super::loop_piece::LoopPiece;
use super::{TrimCurve, TrimDomain, TrimLoopError, UvBox};
use crate::geometry::Direction;
use crate::geometry::curve::Course;

/// Sides of loops along the seam of a periodic domain are taken to lie on the seam if they are this
/// close to it, relative to the period, and no farther from it than a ten-thousandth of the loop's
/// extent.
///
/// A loop that runs once around a cylinder and back again has two sides on the seam, which CAD
/// files fit separately: those of a face of a ball were seen to be 3·10⁻¹⁰ off, to both sides. As
/// written, they would cross or leave a slit.
pub const SEAM_TOLERANCE: f64 = 1e-8;

/// Sides this close to a seam, relative to the loop's extent, may lie on it: a tenth of a pixel of
/// a loop drawn a thousand pixels wide.
pub(super) const NEAR_SEAM: f64 = 1e-4;

/// A side runs along a seam if it strays by no more than this fraction of its length, each relative
/// to the loop's extent.
const ALONG: f64 = 1e-3;

/// A closed loop in the (u, v) plane: a chain of curves, each beginning where the previous one
/// ends, the first where the last one ends.
///
/// # Invariants, checked once on construction
/// - the ends meet to within [`JOINT_TOLERANCE`](super::JOINT_TOLERANCE) times the loop's extent
///   (in u and v separately) plus a few rounding errors of its magnitude, and are then made equal:
///   the curves end where they meet near the gap, if need be extended, or are joined there by a
///   short straight line;
/// - the loop is not a point.
///
/// Crossings of the loop with itself are found together with those of other loops, in
/// [`Trims::new`](super::Trims::new).
#[derive(Clone, Debug, PartialEq)]
pub struct TrimLoop {
    pieces: Vec<LoopPiece>,
    widest_gap: f64,
}

impl TrimLoop {
    /// The loop of these curves.
    ///
    /// # Errors
    /// When there is no curve, one does not begin where the one before it ends, or all are
    /// one point.
    pub fn new(curves: &[TrimCurve]) -> Result<Self, TrimLoopError> {
        Self::closed(curves, None)
    }

    /// The loop of these curves on a domain: where one of them ends at a pole, the next one may
    /// begin at any other place of it, as these are one point in space. The loop then goes there
    /// along the pole; or along two of them that share a corner. (CAD files leave out this edge,
    /// which has no length, or end and begin on either side of it.)
    ///
    /// # Errors
    /// As [`TrimLoop::new`].
    pub fn on(domain: &TrimDomain, curves: &[TrimCurve]) -> Result<Self, TrimLoopError> {
        Self::closed(curves, Some(domain))
    }

    fn closed(curves: &[TrimCurve], domain: Option<&TrimDomain>) -> Result<Self, TrimLoopError> {
        let mut pieces: Vec<LoopPiece> = Vec::new();
        let mut owners = Vec::new();
        for (index, curve) in curves.iter().enumerate() {
            for control in curve.pieces() {
                let (first, last) = (control[0], control[control.len() - 1]);
                let ends = [euclidean(first), euclidean(last)];
                pieces.push(LoopPiece { ends, control: control.clone() });
                owners.push(index);
            }
        }
        if pieces.is_empty() {
            return Err(TrimLoopError::Empty);
        }
        let bounds = UvBox::around(pieces.iter().flat_map(LoopPiece::hull));
        let (min, max) = (bounds.min, bounds.max);
        if min == max {
            return Err(TrimLoopError::Degenerate { min, max });
        }

        // Close the gaps, or report one that is too wide.
        let gauge = Gauge::new(bounds);
        let (mut widest_gap, mut ways) = (0.0f64, Vec::new());
        for this in 0..pieces.len() {
            let next = (this + 1) % pieces.len();
            let (end, start) = (pieces[this].ends[1], pieces[next].ends[0]);
            let (mut gap, tolerance) = (start - end, gauge.tolerance);
            let slack = tolerance.min(gauge.length(gap) * gauge.size);
            let is_gap = !gap.abs().cmple(gauge.rounding).all(); // also for NaN
            let pole = domain.filter(|_| is_gap);
            if let Some(way) = pole.and_then(|on| on.along_poles([end, start], slack)) {
                let (from, to) = (way[0], way[way.len() - 1]);
                gap = (from - end).abs().max((to - start).abs());
                ways.push((this + 1, [vec![end], way, vec![start]].concat()));
            } else if !gap.abs().cmple(tolerance).all() {
                let (curve, next) = (owners[this], owners[next]);
                return Err(TrimLoopError::Open { curve, next, end, gap, tolerance });
            }
            let lengths = bounds.size();
            for k in (0..2).filter(|&k| lengths[k] > 0.0) {
                widest_gap = widest_gap.max(gap[k].abs() / lengths[k]);
            }
        }
        for (place, way) in ways.into_iter().rev() {
            let lines = way.windows(2).filter(|ends| ends[0] != ends[1]);
            pieces.splice(place..place, lines.map(|ends| LoopPiece::line([ends[0], ends[1]])));
        }
        joints::close(&mut pieces, &gauge);
        Ok(Self { pieces, widest_gap })
    }

    /// The polygon with these corners; the last is joined to the first.
    ///
    /// # Errors
    /// As [`TrimCurve::polyline`], or when all corners are one point.
    pub fn polygon(corners: &[DVec2]) -> Result<Self, TrimLoopError> {
        let mut closed = corners.to_vec();
        closed.extend(corners.first());
        Self::new(&[TrimCurve::polyline(&closed)?])
    }

    /// The border of a rectangle, counter-clockwise from its smallest corner: the loop that
    /// keeps a whole domain, for other loops to cut holes into.
    ///
    /// # Errors
    /// When a parameter is not finite, or the rectangle is a point.
    pub fn rectangle(bounds: UvBox) -> Result<Self, TrimLoopError> {
        let UvBox { min, max } = bounds;
        Self::polygon(&[min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)])
    }

    /// A circle, counter-clockwise; see [`TrimCurve::circle`].
    ///
    /// # Errors
    /// When the center is not finite or the radius not positive, or so small beside the
    /// center that the circle is a point.
    pub fn circle(center: DVec2, radius: f64) -> Result<Self, TrimLoopError> {
        Self::new(&[TrimCurve::circle(center, radius)?])
    }

    /// The loop run backwards, which cuts the same.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { pieces: self.pieces.iter().rev().map(LoopPiece::reversed).collect(), ..*self }
    }

    /// The loop moved by `by`; each control point is rounded once.
    #[must_use]
    pub fn shifted(&self, by: DVec2) -> Self {
        let moved = |piece: &LoopPiece| LoopPiece {
            ends: piece.ends.map(|end| end + by),
            control: piece.control.iter().map(|c| *c + (c.z * by).extend(0.0)).collect(),
        };
        Self { pieces: self.pieces.iter().map(moved).collect(), ..*self }
    }

    /// The loop with those pieces that run along a seam within [`SEAM_TOLERANCE`] straightened and
    /// put on the seam. The distance by which they move counts as a gap.
    pub(super) fn straight_along_seams(&self, domain: &TrimDomain) -> Self {
        let (mut straight, bounds) = (self.clone(), self.bounds());
        let size = bounds.size();
        for axis in Direction::BOTH.into_iter().filter(|&axis| domain.is_periodic(axis)) {
            let [start, end] = domain.range()[axis];
            let period = end - start;
            for piece in &mut straight.pieces {
                let periods = ((piece.ends[0][axis] - start) / period).round();
                let seam = if periods == 1.0 { end } else { start + periods * period };
                let off = piece.hull().map(|point| (point[axis] - seam).abs()).fold(0.0, f64::max);
                let length = UvBox::around(piece.hull()).size()[axis.other()];
                let is_along = off / size[axis] <= ALONG * length / size[axis.other()];
                let is_near = off <= SEAM_TOLERANCE * period && off <= NEAR_SEAM * size[axis];
                if off == 0.0 || !(is_near && is_along) {
                    continue; // also for NaN
                }
                straight.widest_gap = straight.widest_gap.max(off / size[axis]);
                piece.control.iter_mut().for_each(|point| point[axis as usize] = point.z * seam);
                piece.ends.iter_mut().for_each(|end| end[axis] = seam);
            }
        }
        joints::close(&mut straight.pieces, &Gauge::new(bounds));
        straight
    }

    /// The widest gap between curves as written, as a fraction of the loop's extent, in u or in v.
    /// It is at most [`JOINT_TOLERANCE`](super::JOINT_TOLERANCE), except for rounding of tiny
    /// loops, and has been closed.
    pub fn widest_gap(&self) -> f64 {
        self.widest_gap
    }

    /// A rectangle that holds the loop: the hull of its control points.
    pub fn bounds(&self) -> UvBox {
        UvBox::around(self.pieces.iter().flat_map(LoopPiece::hull))
    }

    /// Fails if the loop turns round and runs back over what it has just run through, unless this
    /// is no longer than a [lobe](LOBE_TOLERANCE) or lies on a pole of the domain. (A bridge to
    /// another part of the loop, crossed once and later back, does not count.)
    pub(super) fn check_dangling(&self, domain: &TrimDomain) -> Result<(), TrimLoopError> {
        // u and v are unrelated: narrowness in one of them is relative to the loop's extent in that
        // one.
        let Gauge { size, tolerance, .. } = Gauge::new(self.bounds());
        let in_space = |c: &DVec3| DVec4::new(c.x / size.x, c.y / size.y, 0.0, c.z);
        let pieces = self.pieces.iter().map(|piece| piece.control.iter().map(in_space).collect());
        let course = Course::closed(pieces);
        for fold in course.folds() {
            let [at, until] = [fold.t, fold.until].map(|t| size * course.point_at(t).truncate());
            let is_short = ((until - at) / size).abs().max_element() <= LOBE_TOLERANCE;
            if !is_short && domain.along_poles([at, until], tolerance).is_none() {
                return Err(TrimLoopError::Dangling { at, until });
            }
        }
        Ok(())
    }

    pub(super) fn pieces(&self) -> &[LoopPiece] {
        &self.pieces
    }
}
