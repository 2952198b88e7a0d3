//! What is reported of what a ray meets.
//!
//! The rules are here so that all ways of asking follow the same ones.

use glam::{DVec2, DVec3};

use crate::intersect::crossings::APART;
use crate::intersect::roots::accept::AROUND;
use crate::intersect::roots::borders::at_border;
use crate::intersect::roots::meeting::Meeting;
use crate::intersect::{Answer, Hit, HitFlags, Root};
use crate::patch::{Jet, PatchSet, Piece};

/// The first of some meetings, and whether something doubtful could come before it.
pub(super) fn answer_of<'m>(
    set: &PatchSet,
    meetings: impl Iterator<Item = &'m Meeting> + Clone,
    doubt: f64,
) -> Answer {
    // A hit so far away that `t` is infinite lies beyond every range.
    let reachable = meetings.filter(|meeting| meeting.t < f64::INFINITY);
    let first = reachable.clone().min_by(|a, b| a.order(b));
    // A doubtful meeting may lie before where it was found, by as much as its error bound. But one
    // at the place of the first meeting is the first itself if it is known as well as that, as the
    // ends of stretches are.
    let before = |first: &Meeting, meeting: &Meeting| {
        let reach = APART * (first.error + meeting.error);
        let earlier = first.t - (meeting.t - meeting.t_error());
        let is_first = meeting.jet.point.distance(first.jet.point) <= reach
            && (meeting.stretch.is_some() || earlier <= APART * first.t_error());
        !meeting.is_certain() && earlier >= 0.0 && !is_first
    };
    let is_before = |first| reachable.clone().any(|meeting| before(first, meeting));
    let open = doubt < f64::INFINITY && first.is_none_or(|first| doubt <= first.t);
    let open = open || first.is_some_and(is_before);
    let mut hit = first.map(|meeting| hit(set, meeting));
    let flagged = hit.is_some_and(|hit| hit.flags.contains(HitFlags::DOUBTFUL));
    let doubtful = flagged || open;
    if let Some(hit) = hit.as_mut().filter(|_| doubtful) {
        hit.flags.insert(HitFlags::DOUBTFUL);
    }
    Answer { hit, doubtful }
}

/// The hit to report for a meeting.
pub(super) fn hit(set: &PatchSet, meeting: &Meeting) -> Hit {
    let piece = &set.pieces()[meeting.piece as usize];
    let mut flags = meeting.flags;
    let normal = reported_normal(piece, meeting.jet.point, meeting.normal);
    let normal = normal.unwrap_or_else(|| {
        flags.insert(HitFlags::NO_NORMAL);
        DVec3::NAN
    });
    // A doubtful meeting may be off along the ray by more than its angle implies.
    let least = if meeting.is_certain() { 0.0 } else { AROUND * meeting.error / meeting.z_error };
    let cosine = if flags.contains(HitFlags::NO_NORMAL) { 0.0 } else { meeting.cosine.abs() };
    let cosine = cosine.max(least).min(1.0);
    let root = Root::new(set.id(), meeting.piece, meeting.st, meeting.z_error, cosine);
    Hit {
        t: meeting.t,
        surface: meeting.surface,
        uv: piece.uv(meeting.st),
        point: meeting.jet.point,
        normal,
        flags,
        root,
    }
}

/// The normal to report at a point of a piece, of which `limit` is the normal in the piece, or its
/// limit at a pole: none at an apex, where other pieces have other limits.
#[inline]
pub(super) fn reported_normal(piece: &Piece, point: DVec3, limit: Option<DVec3>) -> Option<DVec3> {
    limit.filter(|_| !piece.is_apex(point))
}

/// [`HitFlags::BORDER`] for a certain hit on a border of its surface, to within the errors of a ray
/// of this magnitude ([`RayFrame::magnitude`](crate::math::RayFrame::magnitude)).
#[inline]
pub(super) fn border_flag(piece: &Piece, st: DVec2, jet: &Jet, magnitude: f64) -> HitFlags {
    let error = piece.patch.error_bound(magnitude);
    if at_border(piece, st, jet, error) { HitFlags::BORDER } else { HitFlags::NONE }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::SurfaceBvh;
    use crate::intersect::roots::meeting::testing::view;

    /// A doubtful meeting behind the first one leaves it in doubt if it may lie before it.
    #[test]
    fn what_may_lie_before_the_first_hit_leaves_it_in_doubt() {
        let bvh = SurfaceBvh::build(&[shapes::plane(1.0, 1.0).unwrap()]).unwrap();
        let first = view(1.0, 0.5, HitFlags::NONE);
        for (behind, off, is_doubtful) in
            [(1e-9, 1e-8, true), (1e-9, 1e-10, false), (-1e-9, 1e-10, true), (1e-3, 1e-8, false)]
        {
            let other = Meeting { z_error: off, ..view(1.0 + behind, 0.5, HitFlags::DOUBTFUL) };
            for meetings in [[first, other], [other, first]] {
                let answer = answer_of(bvh.patches(), meetings.iter(), f64::INFINITY);
                assert_eq!(answer.doubtful, is_doubtful, "{behind} {off}: {answer:?}");
                let nearest = 1.0 + f64::min(behind, 0.0);
                assert_eq!(answer.hit.map(|hit| hit.t), Some(nearest));
            }
        }
        // What was not searched may hold a nearer hit.
        for (doubt, is_doubtful) in [(0.9, true), (1.0, true), (1.1, false)] {
            let answer = answer_of(bvh.patches(), [first].iter(), doubt);
            assert_eq!(answer.doubtful, is_doubtful, "{doubt}");
        }
    }
}
