//! Merges the meetings that are one crossing.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::balance::Balance;
use super::faces::{EdgeReach, Face};
use super::same_place::{Sight, are_apart, are_apart_without_edges, at_one_place, reach_along};
use super::sense::{has_no_normal, may_touch, same_sense};
use super::vertices;
use crate::intersect::HitFlags;
use crate::intersect::exact::End;
use crate::intersect::roots::around::{EdgeEnd, EdgeEnds, Turn};
use crate::intersect::roots::meeting::{Meeting, Stretch, TrimCurve};
use crate::patch::Piece;

/// Sorts meetings by `t` and merges those that are one crossing: at the same place, with
/// the same sign of `N · d`, and seen by two leaves, or on adjoining pieces of a surface,
/// or on borders or trim edges of two surfaces. Stretches inside a surface that overlap become one.
/// [`vertices`] decides which way the ray, along `axis`, goes through a vertex.
/// Where something else is met at the place of a meeting without a normal, that one is doubtful.
///
/// Beside a vertex, two meetings that are not at one place may each be at the place of a third,
/// which is less well known. Whether they are one crossing is not known: both are doubtful.
///
/// A ray that passes a convex edge on its outside, within rounding, may be said to enter and to
/// leave there, or to do neither. Where only one of the two sides was near enough, its meeting is
/// doubtful. So is all that is met at a place where it does not [balance](Balance).
pub(crate) fn merge(meetings: &mut Vec<Meeting>, pieces: &[Piece], axis: DVec3) {
    let sight = Sight { pieces, axis };
    meetings.sort_by(Meeting::order);
    join_stretches(meetings);
    let balance = Balance::new(meetings, sight);
    vertices::settle(meetings, sight);

    let reach = reach_along(meetings);
    let mut crossings: Vec<Crossing> = Vec::new();
    // Those that the next meeting may still belong to.
    let mut near: Vec<usize> = Vec::new();
    for (k, meeting) in meetings.iter().enumerate() {
        near.retain(|&c| meeting.t - meetings[crossings[c].last()].t <= reach);
        let is_same =
            |view: &Meeting| same_sense(view, meeting) && at_one_place(view, meeting, sight);
        let joins = |&&c: &&usize| is_same(&crossings[c].counted(meetings));
        if let Some(&c) = near.iter().rev().find(joins) {
            crossings[c].join(k, meetings, sight);
            continue;
        }
        let mut crossing = Crossing::new(k, meeting);
        for &c in &near {
            if crossings[c].views.iter().any(|&view| is_same(&meetings[view])) {
                crossings[c].is_open = true;
                crossing.is_open = true;
            }
        }
        near.push(crossings.len());
        crossings.push(crossing);
    }
    for crossing in crossings.iter_mut().filter(|one| one.on_either_side && !one.is_settled) {
        crossing.is_settled = crossing.is_closed(meetings, sight);
    }
    // No crossing counts by a view that comes before its own place among the crossings.
    for (c, crossing) in crossings.iter().enumerate() {
        meetings[c] = crossing.counted(meetings);
    }
    meetings.truncate(crossings.len());
    // A certain view may lie a little behind the doubtful one whose place it has taken.
    meetings.sort_by(|a, b| a.t.total_cmp(&b.t));
    doubt_without_normal(meetings, sight);
    doubt_half_touches(meetings, sight);
    balance.check(meetings);
}

/// Views of one crossing, by their places among the meetings of the ray.
struct Crossing {
    /// All of them, by `t`; never empty.
    views: SmallVec<[usize; 4]>,
    /// The view that counts: the first certain one, or the first if none is certain.
    best: usize,
    /// The flags of all of them, but for doubt.
    flags: HitFlags,
    is_certain: bool,
    /// Whether any of them is at a trim curve.
    is_at_trims: bool,
    /// Whether all of them that are certain are beyond a side.
    is_beyond: bool,
    /// Whether any of them is at a trim curve of which it may be on either side.
    on_either_side: bool,
    /// Whether it counts all the same: one of them [settles] it, or it [is closed](Self::is_closed).
    is_settled: bool,
    /// Whether it may be more than one crossing, or a part of another: a view is doubtful and
    /// grazing, or at the place of another crossing's, or farther from the others than their errors
    /// explain, or at the place of the others only because it is not known where trim edges are, and
    /// not beyond an edge that they share.
    is_open: bool,
}

impl Crossing {
    fn new(view: usize, meeting: &Meeting) -> Self {
        Self {
            views: smallvec![view],
            best: view,
            flags: meeting.flags.without(HitFlags::DOUBTFUL),
            is_certain: meeting.is_certain(),
            is_at_trims: meeting.trim_curve.is_some(),
            is_beyond: meeting.beyond || !meeting.is_certain(),
            on_either_side: meeting.on_either_side(),
            is_settled: settles(meeting),
            is_open: may_touch(meeting),
        }
    }

    /// The last view.
    fn last(&self) -> usize {
        self.views[self.views.len() - 1]
    }

    /// Adds another view.
    fn join(&mut self, view: usize, meetings: &[Meeting], sight: Sight<'_>) {
        let meeting = &meetings[view];
        self.on_either_side |= meeting.on_either_side();
        self.is_settled |= settles(meeting);
        let counted = &meetings[self.best];
        self.is_open |= are_apart(counted, meeting);
        if are_apart_without_edges(counted, meeting) {
            let ends = |m| Face::new(m, EdgeReach::Met, sight).edge_ends();
            self.is_open |= Turn::of(&ends(counted), &ends(meeting)) != Turn::Alike;
        }
        self.views.push(view);
        if meeting.is_certain() && !self.is_certain {
            self.best = view;
        }
        self.flags = self.flags.with(meeting.flags.without(HitFlags::DOUBTFUL));
        self.is_certain |= meeting.is_certain();
        self.is_at_trims |= meeting.trim_curve.is_some();
        self.is_beyond &= meeting.beyond || !meeting.is_certain();
        self.is_open |= may_touch(meeting);
    }

    /// Whether each edge that the ray may pass on either side has another face on its other side: as
    /// the ray passes one of them, it passes the surface.
    fn is_closed(&self, meetings: &[Meeting], sight: Sight<'_>) -> bool {
        let views = || self.views.iter().map(|&view| &meetings[view]);
        let ends: SmallVec<[(&Meeting, EdgeEnds); 4]> =
            views().map(|m| (m, passed_edges(m, sight))).collect();
        let is_shared = |own: &Meeting, end: &EdgeEnd| {
            let others = ends.iter().filter(|(other, _)| other.piece != own.piece);
            others.flat_map(|(_, theirs)| theirs).any(|other| end.adjoins(other))
        };
        ends.iter()
            .filter(|(m, _)| m.on_either_side())
            .all(|(m, own)| !own.is_empty() && own.iter().all(|end| is_shared(m, end)))
    }

    /// The view that counts, with what is known from all.
    fn counted(&self, meetings: &[Meeting]) -> Meeting {
        let is_doubtful = self.is_open || !self.is_certain;
        let doubt = if is_doubtful { HitFlags::DOUBTFUL } else { HitFlags::NONE };
        let flags = self.flags.with(doubt);
        let best = &meetings[self.best];
        let trim_curve = self.is_at_trims.then(|| TrimCurve {
            off: best.off_trim_curve(),
            on_either_side: self.on_either_side && !self.is_settled,
        });
        Meeting { flags, trim_curve, beyond: self.is_beyond, ..*best }
    }
}

/// The edges that the ray of a meeting passes: where it may be on either side, those that it may
/// have been aimed at. Of others, such a face says nothing.
fn passed_edges(meeting: &Meeting, sight: Sight<'_>) -> EdgeEnds {
    let reach = if meeting.on_either_side() { EdgeReach::Aimed } else { EdgeReach::Met };
    Face::new(meeting, reach, sight).edge_ends()
}

/// Whether the surface is surely met there, whatever else is.
fn settles(meeting: &Meeting) -> bool {
    meeting.is_certain() && !meeting.on_either_side() && !meeting.beyond
}

/// Flags meetings without a normal at whose place something else is met. This comes after views of
/// one crossing are merged, so that no view can take the flag away again.
fn doubt_without_normal(meetings: &mut [Meeting], sight: Sight<'_>) {
    for k in (0..meetings.len()).filter(|&k| has_no_normal(&meetings[k])).collect::<Vec<_>>() {
        let bare = &meetings[k];
        if meetings.iter().any(|m| !has_no_normal(m) && at_one_place(m, bare, sight)) {
            meetings[k].flags.insert(HitFlags::DOUBTFUL);
        }
    }
}

/// Flags what is met only because the ray passes close to it on its outside, or may do so, unless
/// another side of the same edge is met there in the opposite direction and matches no other
/// meeting there.
///
/// Where a trim edge meets a border without trims, rays are said to meet the edge from a little
/// farther away than the border: these pass the border's face on its outside, and the other, too.
fn doubt_half_touches(meetings: &mut [Meeting], sight: Sight<'_>) {
    // An edge of the only surface there is borders on nothing.
    let has_others =
        sight.pieces.first().map(|p| p.surface) != sight.pieces.last().map(|p| p.surface);
    let is_half = |m: &Meeting| m.beyond || m.on_either_side() && has_others;
    for k in (0..meetings.len()).filter(|&k| is_half(&meetings[k])).collect::<Vec<_>>() {
        let touch = &meetings[k];
        let same_way = |m: &Meeting| m.cosine * touch.cosine > 0.0;
        let near = |a: &Meeting, b: &Meeting| at_one_place(a, b, sight);
        let is_taken = |m: &Meeting| {
            (0..meetings.len()).any(|j| j != k && same_way(&meetings[j]) && near(&meetings[j], m))
        };
        let opposite = |m: &&Meeting| m.cosine * touch.cosine < 0.0;
        // Where two bodies touch along an edge, a face of one says nothing of the other.
        let is_of_one_body = |m: &Meeting| {
            let [own, others] = [touch, m].map(|m| passed_edges(m, sight));
            Turn::of(&own, &others) != Turn::Opposite
        };
        let matches = |m: &Meeting| near(m, touch) && !is_taken(m) && is_of_one_body(m);
        let whole = meetings.iter().filter(opposite).any(matches);
        if !whole {
            meetings[k].flags.insert(HitFlags::DOUBTFUL);
        }
    }
}

/// Drops the ends of stretches that lie inside another stretch of the same surface.
fn join_stretches(meetings: &mut Vec<Meeting>) {
    let stretches: Vec<(u32, [f64; 2], f64)> = meetings
        .iter()
        .filter_map(|m| Some((m.surface, m.stretch?.t, 4.0 * m.t_error())))
        .collect();
    meetings.retain(|m| {
        let Some(Stretch { t: [from, to], end }) = m.stretch else { return true };
        !stretches.iter().any(|&(surface, [other_from, other_to], error)| {
            let other = surface == m.surface && [other_from, other_to] != [from, to];
            let continued = if end == End::First {
                other_from < from - error && from - error <= other_to
            } else {
                other_to > to + error && other_from <= to + error
            };
            other && continued
        })
    });
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};
    use crate::intersect::roots::meeting::testing::view;
    use crate::intersect::{Query, SurfaceBvh};
    use crate::math::Ray;

    #[test]
    fn a_certain_view_stays_where_a_grazing_one_leaves_doubt() {
        let (first, other) = (view(1.0, 0.5, HitFlags::NONE), view(1.5, 0.7, HitFlags::BORDER));
        let counted = |views: &[Meeting]| {
            let mut crossing = Crossing::new(0, &views[0]);
            (1..views.len())
                .for_each(|k| crossing.join(k, views, Sight { pieces: &[], axis: DVec3::Z }));
            let Meeting { t, flags, .. } = crossing.counted(views);
            (t, flags)
        };
        let grazing = view(1.2, 1e-5, HitFlags::DOUBTFUL);
        let doubtful_border = HitFlags::DOUBTFUL.with(HitFlags::BORDER);
        assert_eq!(counted(&[first, grazing, other]), (1.0, doubtful_border));

        // Far from the origin, where errors are large, steeper ones may touch the surface, too.
        let far = |cosine| Meeting { error: 5e-9, ..view(1.2, cosine, HitFlags::DOUBTFUL) };
        assert!(may_touch(&far(5e-4)) && !may_touch(&far(6e-4)));
        assert!(!may_touch(&view(1.2, 5e-4, HitFlags::DOUBTFUL)));
        assert!(may_touch(&view(1.2, 5e-5, HitFlags::DOUBTFUL)));

        // A steep doubtful view is just another view: it gives way, and its doubt goes with it.
        let steep = view(1.2, 0.5, HitFlags::DOUBTFUL);
        assert_eq!(counted(&[steep, first]), (1.0, HitFlags::NONE));
    }

    #[test]
    fn two_views_at_the_place_of_a_flatter_third_are_in_doubt() {
        let planes = [0; 3].map(|_| shapes::plane(1.0, 1.0).unwrap());
        let bvh = SurfaceBvh::build(&planes).unwrap();
        // At the borders of three surfaces.
        let at = |surface: u32, t: f64, cosine: f64| Meeting {
            surface,
            piece: surface,
            st: DVec2::new(0.0, 0.5),
            ..view(t, cosine, HitFlags::BORDER)
        };
        let (first, last) = (at(0, 1.0, 0.5), at(2, 1.0 + 2e-12, 0.5));
        let flat = at(1, 1.0 + 1e-12, 1e-3);
        for (views, count, is_doubtful) in [
            (vec![first, last], 2, false),
            (vec![first, flat], 1, false),
            (vec![first, flat, last], 2, true),
        ] {
            let mut meetings = views;
            merge(&mut meetings, bvh.patches().pieces(), DVec3::Z);
            assert_eq!(meetings.len(), count);
            assert!(meetings.iter().all(|m| m.is_certain() != is_doubtful), "{meetings:?}");
        }
    }

    /// A meeting without a normal goes through the surface either way: beside another one, it may be
    /// the same crossing or not.
    #[test]
    fn a_meeting_without_a_normal_is_in_doubt_beside_another() {
        let planes = [0; 2].map(|_| shapes::plane(1.0, 1.0).unwrap());
        let bvh = SurfaceBvh::build(&planes).unwrap();
        let at = |surface: u32, t: f64| Meeting {
            surface,
            piece: surface,
            st: DVec2::new(0.0, 0.5),
            ..view(t, 0.5, HitFlags::BORDER)
        };
        let bare = |t: f64| Meeting { normal: None, cosine: 0.0, z_error: 1e-15, ..at(1, t) };
        for (apart, is_doubtful) in [(0.0, true), (1e-15, true), (1e-3, false)] {
            let mut meetings = vec![at(0, 1.0), bare(1.0 + apart)];
            merge(&mut meetings, bvh.patches().pieces(), DVec3::Z);
            let bare = meetings.iter().find(|m| m.normal.is_none());
            assert_eq!(bare.map(|m| !m.is_certain()), Some(is_doubtful), "{apart}: {meetings:?}");
        }
    }

    /// A tube of one piece, its seam creased or smooth, is met twice by a ray through the seam.
    #[test]
    fn a_seam_of_one_piece_is_one_crossing() {
        let drop = [(1.0, 0.0), (3.0, 2.0), (3.0, -2.0), (1.0, 0.0)];
        let round = [(1.0, 0.0), (1.0, 2.0), (-6.0, 0.0), (1.0, -2.0), (1.0, 0.0)];
        for profile in [&drop[..], &round] {
            let knots = |n: usize| KnotVector::clamped_uniform(n - 1, n).unwrap();
            let at = |&(x, y): &(f64, f64)| [0.0, 1.0].map(|z| DVec3::new(x, y, z));
            let net = profile.iter().flat_map(at).collect();
            let tube = NurbsSurface::new(knots(profile.len()), knots(2), net, None).unwrap();
            for surface in [tube.clone(), tube.swapped()] {
                let bvh = SurfaceBvh::build(&[surface]).unwrap();
                assert_eq!(bvh.patches().pieces().len(), 1);
                for k in -5..=5 {
                    let direction = DVec3::new(1.0, 0.03 * f64::from(k), 0.01 * f64::from(k));
                    let seam = DVec3::new(1.0, 0.0, 0.5);
                    let ray = Ray::new(seam - 16.0 * direction, direction).unwrap();
                    let mut hits = Vec::new();
                    let doubtful = bvh.tracer().all_hits(&Query::primary(ray), &mut hits);
                    assert!(!doubtful && hits.len() == 2, "{k}: {hits:?}");
                }
            }
        }
    }
}
