//! Which way a ray goes through a surface where it meets it, as far as is known.

use crate::intersect::roots::meeting::Meeting;

/// The cosine below which the ray of a doubtful meeting may touch the surface.
const MAY_TOUCH: f64 = 1e-4;

/// It may also touch the surface if the square of the cosine is less than this many times the error
/// over the size of the piece: if the radius of curvature is an eighth of that size, and the ray is
/// off by four times the error.
const BENT: f64 = 64.0;

/// Whether the ray of a meeting may touch the surface: such a meeting counts for either side.
///
/// A doubtful meeting that is steep has one side. (At a corner of a piece whose tangents there have
/// one line, as where a crease of a limit surface runs on smoothly, nothing is proved. Where it is
/// not known which way the ray goes through the surface there, the meeting's cosine is zero: see
/// [`Spot::has_one_side`](crate::intersect::roots::spot::Spot::has_one_side).)
pub(super) fn may_touch(meeting: &Meeting) -> bool {
    if meeting.is_certain() || has_no_normal(meeting) {
        return false;
    }
    let jet = &meeting.jet;
    let size = jet.ds.length().max(jet.dt.length());
    let is_bent = meeting.cosine.powi(2) * size < BENT * meeting.error;
    meeting.cosine.abs() < MAY_TOUCH || is_bent
}

/// Whether the surface has no normal there, nor a limit of normals: it runs to a cusp or a crease.
/// (At an apex, a meeting has the limit along its ruling.)
pub(super) fn has_no_normal(meeting: &Meeting) -> bool {
    meeting.normal.is_none()
}

/// Whether the ray passes through the surface in the same direction at both meetings, as far as is
/// known. Without a normal it is unknown: it matches only other views without one.
pub(super) fn same_sense(a: &Meeting, b: &Meeting) -> bool {
    match (has_no_normal(a), has_no_normal(b)) {
        (false, false) => a.cosine * b.cosine > 0.0 || may_touch(a) || may_touch(b),
        (a, b) => a == b,
    }
}
