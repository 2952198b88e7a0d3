//! Which meetings are at the same place: seen by two leaves, or where pieces or surfaces meet.

use glam::{DVec2, DVec3};

use super::sense::has_no_normal;
use crate::geometry::{Direction, RectSide};
use crate::intersect::roots::meeting::Meeting;
use crate::patch::{Jet, Piece};

/// Surfaces met at a smaller cosine than this, the root of the unit roundoff, cannot be told from
/// touched ones, unless the meeting is certain all the same, as on what is flat.
const LEAST_COSINE: f64 = 1e-8;

/// Meetings at one place are no farther apart along the ray than this many times the sum of their
/// error bounds along it. A point beyond a border may be off the ray by the whole error; where the
/// other surface is met obliquely, this amounts to the other meeting's error along the ray.
const ALONG: f64 = 2.0;

/// Meetings at one place are closer in space than this many times the sum of their errors, over the
/// smaller cosine: each is off by its error, and by as much again where it was moved to a border; the
/// rest is spare. (Other factors were not tried.)
pub(crate) const APART: f64 = 4.0;

/// The smallest sine of the angle between tangents that is used to tell how near a side is; it
/// replaces smaller ones. Where tangents are parallel, as in a cusp, every side would be near. This
/// is less than for [`Piece::side_distances`], whose sides have no other evidence: here two
/// meetings are near each other already.
const NARROWEST: f64 = 1e-6;

/// What the meetings of a ray are seen in.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    /// The pieces that they are on.
    pub(super) pieces: &'a [Piece],
    /// The ray's direction.
    pub(super) axis: DVec3,
}

/// How far apart, in `t`, meetings at the same place may be.
pub(super) fn reach_along(meetings: &[Meeting]) -> f64 {
    2.0 * meetings.iter().map(off_along).fold(0.0, f64::max)
}

/// How far, in `t`, a meeting may be from another one at the same place; at a trim edge, the
/// distance of the edge is added.
fn off_along(meeting: &Meeting) -> f64 {
    (ALONG * meeting.z_error + meeting.off_trim_curve()) * meeting.t_from_z
}

/// Whether two meetings are at the same place: of one piece, or one that two pieces share.
pub(super) fn at_one_place(a: &Meeting, b: &Meeting, sight: Sight<'_>) -> bool {
    let Sight { pieces, axis } = sight;
    let along = off_along(a) + off_along(b); // no more than `reach_along`
    let (across, edge) = (APART * (a.error + b.error), a.off_trim_curve() + b.off_trim_curve());
    let reach = Reach::new(across, slope(a).min(slope(b)), edge, axis);
    let near = (a.t - b.t).abs() <= along && a.jet.point.distance(b.jet.point) <= reach.along_ray;
    if !near {
        return false;
    }
    let moved_by = |jet: &Jet| moved(jet, a.st - b.st);
    if a.piece == b.piece && moved_by(&a.jet).min(moved_by(&b.jet)) <= reach.along_ray {
        // Two leaves of one piece: the same parameters, or both at the same pole.
        return true;
    }
    let same_piece = a.piece == b.piece;
    // Each is as far from a side that they share as its own error leads along the ray.
    let [a, b] = [a, b].map(|m| {
        let own = Reach::new(across, slope(m), edge, axis);
        AtSides::new(m, &pieces[m.piece as usize], &own)
    });
    // Borders may meet, even two of one piece, as at the seam of a tube.
    if a.at_end && b.at_end {
        return true;
    }
    if same_piece || a.meeting.surface != b.meeting.surface {
        return false;
    }
    if !a.piece.shares_chart_with(b.piece) {
        // The charts of a surface meet along any of their sides.
        return (a.at_end || a.sides != [false; 4]) && (b.at_end || b.sides != [false; 4]);
    }
    a.adjoins(&b) || b.adjoins(&a) || a.is_beside(&b, &reach) || b.is_beside(&a, &reach)
}

/// Whether two meetings at one place, both certain, are farther apart along the ray than the sum of
/// their error bounds: they may well be two, as of borders that only nearly meet.
pub(super) fn are_apart(a: &Meeting, b: &Meeting) -> bool {
    let are_certain =
        a.is_certain() && b.is_certain() && a.off_trim_curve() + b.off_trim_curve() == 0.0;
    are_certain && (a.t - b.t).abs() > a.t_error() + b.t_error()
}

/// Whether two meetings at one place are farther apart along the ray than their errors allow: they
/// are taken for one because it is not known how far off the trim edges are that they are at.
pub(super) fn are_apart_without_edges(a: &Meeting, b: &Meeting) -> bool {
    a.off_trim_curve() + b.off_trim_curve() > 0.0
        && (a.t - b.t).abs() > ALONG * (a.t_error() + b.t_error())
}

/// How far a step in parameters moves a point, to first order.
///
/// Where the tangents are nearly parallel, as on a body that was stretched, parameters of one place
/// may differ by far more than their errors would move it along each tangent alone.
pub(super) fn moved(jet: &Jet, step: DVec2) -> f64 {
    (step.x * jet.ds + step.y * jet.dt).length()
}

/// How far two views of one place may be apart.
///
/// Both are within rounding of the ray, so that they differ across it by no more; but along the ray
/// each is off by that over the cosine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The direction of the ray.
    axis: DVec3,
    pub(super) along_ray: f64,
    across_ray: f64,
}

impl Reach {
    /// Between a meeting and another one like it.
    pub(super) fn around(meeting: &Meeting, axis: DVec3) -> Self {
        Self::new(2.0 * APART * meeting.error, slope(meeting), 2.0 * meeting.off_trim_curve(), axis)
    }

    /// Around a ray that was aimed at the meeting.
    pub(super) fn aimed(meeting: &Meeting, axis: DVec3) -> Self {
        Self::new(meeting.aimed, slope(meeting), 0.0, axis)
    }

    /// With an error `across` the ray, which the cosine makes longer along it; trim edges add
    /// `edge` to both.
    fn new(across: f64, cosine: f64, edge: f64, axis: DVec3) -> Self {
        Self { axis, along_ray: across / cosine + edge, across_ray: across + edge }
    }

    /// Which sides of its piece a place may be at, to first order.
    pub(super) fn sides(&self, st: DVec2, jet: &Jet) -> [bool; 4] {
        let (near, distances) = (self.in_parameters(jet), RectSide::distances(st));
        RectSide::ALL.map(|side| distances[side] <= near[side.fixed()])
    }

    /// The same distance in each parameter.
    fn in_parameters(&self, jet: &Jet) -> [f64; 2] {
        let lengths = [jet.ds.length(), jet.dt.length()];
        let [s, t] = [jet.ds / lengths[0], jet.dt / lengths[1]];
        let normal = s.cross(t);
        let sine = normal.length();
        let is_pole = sine.is_nan() || sine == 0.0;
        if is_pole {
            return lengths.map(|length| self.along_ray / length);
        }
        // The surface's unit vectors along which each parameter grows fastest, and how far it has
        // to go along these.
        let steepest = [t.cross(normal) / sine, normal.cross(s) / sine];
        let far = |k: usize| {
            let along = self.along_ray * steepest[k].dot(self.axis).abs();
            (along + self.across_ray) / (lengths[k] * sine.max(NARROWEST))
        };
        [far(0), far(1)]
    }
}

/// The cosine by which the error of a meeting grows along the ray.
fn slope(meeting: &Meeting) -> f64 {
    let is_known = meeting.is_certain() && !has_no_normal(meeting);
    meeting.cosine.abs().max(if is_known { f64::EPSILON } else { LEAST_COSINE })
}

/// The sides of its piece that a meeting is at.
struct AtSides<'a> {
    meeting: &'a Meeting,
    piece: &'a Piece,
    sides: [bool; 4],
    /// Whether one of these sides is a border of the surface or collapsed to a point, or there is a
    /// trim edge: whatever else ends there may be met at the same place.
    at_end: bool,
}

impl<'a> AtSides<'a> {
    fn new(meeting: &'a Meeting, piece: &'a Piece, reach: &Reach) -> Self {
        let sides = reach.sides(meeting.st, &meeting.jet);
        let ends = |side: RectSide| piece.is_border(side) || piece.is_collapsed(side);
        let at_side = RectSide::ALL.into_iter().any(|side| sides[side] && ends(side));
        let at_end = meeting.trim_curve.is_some() || at_side;
        Self { meeting, piece, sides, at_end }
    }

    /// Whether both meetings are at a knot line between their pieces, `self` before the line.
    fn adjoins(&self, after: &Self) -> bool {
        let (before, behind) = (self.piece.domain(), after.piece.domain());
        let touch = (0..2).all(|k| before[k][0] <= behind[k][1] && behind[k][0] <= before[k][1]);
        let at_line = |k: Direction| {
            let [first, last] = RectSide::ends_of(k);
            before[k][1] == behind[k][0] && self.sides[last] && after.sides[first]
        };
        touch && Direction::BOTH.into_iter().any(at_line)
    }

    /// Whether another meeting is at the same parameters, to within four times `reach`: there may
    /// be a thin piece between their pieces.
    fn is_beside(&self, other: &Self, reach: &Reach) -> bool {
        let [here, there] = [self, other].map(|at| at.piece.chart_uv(at.meeting.st));
        let step = (here - there) / self.piece.lengths();
        moved(&self.meeting.jet, step) <= 4.0 * reach.along_ray
    }
}
