//! Merges the meetings that are one crossing.

use glam::{DVec2, DVec3};

use super::meeting::Meeting;
use super::{HitFlags, vertices};
use crate::patch::Piece;

/// Sorts meetings by `t` and merges those that are one crossing: at the same place, with
/// the same sign of `N · d`, and seen by two leaves, or on adjoining pieces of a surface,
/// or on borders or trim edges of two surfaces. Stretches inside a surface that overlap become one.
/// [`vertices`] decides which way the ray, along `axis`, goes through a vertex.
/// Whatever else is met at the place of a tip stays, and the tip becomes doubtful.
///
/// A ray that passes a convex edge on its outside, within rounding, may be said to enter and to
/// leave there, or to do neither. Where only one of the two sides was near enough, its meeting is doubtful.
pub(super) fn merge(meetings: &mut Vec<Meeting>, pieces: &[Piece], axis: DVec3) {
    let place = |m: &Meeting| (m.surface, m.piece);
    meetings.sort_by(|a, b| a.t.total_cmp(&b.t).then_with(|| place(a).cmp(&place(b))));
    join_stretches(meetings);
    vertices::settle(meetings, pieces, axis);

    let reach = reach_along(meetings);
    let mut crossings: Vec<Crossing> = Vec::new();
    for &meeting in &*meetings {
        // Crossings are in order, except where a certain view has replaced one, from within reach behind it.
        let near = |earlier: &&mut Crossing| meeting.t - earlier.view.t <= 2.0 * reach;
        let same = crossings.iter_mut().rev().take_while(near).find(|earlier| {
            same_side(&earlier.view, &meeting) && at_one_place(&earlier.view, &meeting, pieces)
        });
        match same {
            Some(crossing) => crossing.join(meeting),
            None => crossings.push(Crossing::new(meeting)),
        }
    }
    meetings.clear();
    meetings.extend(crossings.into_iter().map(|crossing| crossing.view));
    // A certain view may lie a little behind the doubtful one whose place it has taken.
    meetings.sort_by(|a, b| a.t.total_cmp(&b.t));
    doubt_tips(meetings, pieces);
    doubt_half_touches(meetings, pieces);
}

/// Views of one crossing.
struct Crossing {
    /// The view that counts: the first certain one, or the first if none is certain.
    view: Meeting,
    is_certain: bool,
    /// Whether a view is doubtful and grazing: it may be a crossing of its own, or contain another.
    is_open: bool,
}

impl Crossing {
    fn new(meeting: Meeting) -> Self {
        Self { view: meeting, is_certain: meeting.is_certain(), is_open: touches(&meeting) }
    }

    /// Adds another view; all flags except `DOUBTFUL` are united.
    fn join(&mut self, meeting: Meeting) {
        let flags = self.view.flags.with(meeting.flags).without(HitFlags::DOUBTFUL);
        let beyond = self.view.beyond && meeting.beyond;
        if meeting.is_certain() && !self.is_certain {
            self.view = meeting;
        }
        self.is_certain |= meeting.is_certain();
        self.is_open |= touches(&meeting);
        let is_doubtful = self.is_open || !self.is_certain;
        self.view.flags = if is_doubtful { flags.with(HitFlags::DOUBTFUL) } else { flags };
        self.view.beyond = beyond;
    }
}

/// Flags tips at whose place something else is met. This comes after views of one crossing are merged, so
/// that no view can take the flag away again.
fn doubt_tips(meetings: &mut [Meeting], pieces: &[Piece]) {
    for k in (0..meetings.len()).filter(|&k| has_no_normal(&meetings[k])).collect::<Vec<_>>() {
        let tip = &meetings[k];
        if meetings.iter().any(|m| !has_no_normal(m) && at_one_place(m, tip, pieces)) {
            meetings[k].flags.insert(HitFlags::DOUBTFUL);
        }
    }
}

/// Flags what is met only because the ray passes close to it on its outside, unless another side of
/// the same edge is met there in the opposite direction and matches no other meeting there.
fn doubt_half_touches(meetings: &mut [Meeting], pieces: &[Piece]) {
    for k in (0..meetings.len()).filter(|&k| meetings[k].beyond).collect::<Vec<_>>() {
        let touch = &meetings[k];
        let same_way = |m: &Meeting| m.cosine * touch.cosine > 0.0;
        let near = |a: &Meeting, b: &Meeting| at_one_place(a, b, pieces);
        let is_taken = |m: &Meeting| {
            (0..meetings.len()).any(|j| j != k && same_way(&meetings[j]) && near(&meetings[j], m))
        };
        let opposite = |m: &&Meeting| m.cosine * touch.cosine < 0.0;
        let whole = meetings.iter().filter(opposite).any(|m| near(m, touch) && !is_taken(m));
        if !whole {
            meetings[k].flags.insert(HitFlags::DOUBTFUL);
        }
    }
}

/// The cosine below which the ray of a doubtful meeting may touch the surface.
const GRAZING: f64 = 1e-4;

/// Whether the ray of a meeting may touch the surface: such a meeting counts for either side.
///
/// A doubtful meeting that is steep has one side. At a corner of a piece whose tangents there are
/// parallel, as where a crease of a limit surface runs on smoothly, nothing is proved; but it is known
/// on which side of the surface around the corner the ray is.
pub(super) fn touches(meeting: &Meeting) -> bool {
    !meeting.is_certain() && meeting.cosine.abs() < GRAZING && !has_no_normal(meeting)
}

/// Whether a meeting is at a tip, or so near to one that the surface has no normal there.
pub(super) fn has_no_normal(meeting: &Meeting) -> bool {
    meeting.normal.is_none()
}

/// Whether the ray passes through the surface in the same direction at both meetings, as far as is known.
/// At a tip the direction is unknown: it matches only other views of a tip.
fn same_side(a: &Meeting, b: &Meeting) -> bool {
    match (has_no_normal(a), has_no_normal(b)) {
        (false, false) => a.cosine * b.cosine > 0.0 || touches(a) || touches(b),
        (a, b) => a == b,
    }
}

/// Surfaces met at a smaller cosine than this, the root of the unit roundoff, cannot be told from touched ones.
pub(super) const LEAST_COSINE: f64 = 1e-8;

/// Meetings at one place are no farther apart along the ray than this many times the sum of their error bounds along
/// it. A point beyond a border may be off the ray by the whole error; where the other surface is met obliquely, this
/// amounts to the other meeting's error along the ray.
const ALONG: f64 = 2.0;

/// Meetings at one place are closer in space than this many times the sum of their errors, over the smaller cosine:
/// more than the error of each and its move to a border. (Other factors were not tried.)
pub(super) const APART: f64 = 4.0;

/// How far apart, in `t`, meetings at the same place may be.
pub(super) fn reach_along(meetings: &[Meeting]) -> f64 {
    2.0 * meetings.iter().map(off_along).fold(0.0, f64::max)
}

/// How far, in `t`, a meeting may be from another one at the same place; at a trim edge, the distance of the edge is
/// added.
fn off_along(meeting: &Meeting) -> f64 {
    let t_from_z = meeting.t_error / meeting.z_error;
    ALONG * meeting.t_error + meeting.edge * t_from_z
}

/// Whether two meetings are at the same place: of one piece, or one that two pieces share.
pub(super) fn at_one_place(a: &Meeting, b: &Meeting, pieces: &[Piece]) -> bool {
    let along = off_along(a) + off_along(b); // no more than `reach_along`
    let reach = APART * (a.error + b.error) / a.cosine.abs().min(b.cosine.abs()).max(LEAST_COSINE);
    let reach = reach + a.edge + b.edge;
    let near = (a.t - b.t).abs() <= along && a.jet.point.distance(b.jet.point) <= reach;
    if !near {
        return false;
    }
    if a.piece == b.piece {
        // Two leaves of one piece: the same parameters, or both at the same pole.
        let d = a.st - b.st;
        let apart = (a.jet.ds * d.x).length() + (a.jet.dt * d.y).length();
        if apart <= reach {
            return true;
        }
    }
    let same_piece = a.piece == b.piece;
    let [a, b] = [a, b].map(|m| AtSides::new(m, &pieces[m.piece as usize], reach));
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
    a.adjoins(&b) || b.adjoins(&a) || a.is_beside(&b, reach) || b.is_beside(&a, reach)
}

/// The sides of its piece that a meeting is at.
struct AtSides<'a> {
    meeting: &'a Meeting,
    piece: &'a Piece,
    /// `s = 0`, `s = 1`, `t = 0`, `t = 1`.
    sides: [bool; 4],
    /// Whether one of these sides is a border of the surface or collapsed to a point, or there is a trim edge:
    /// whatever else ends there may be met at the same place.
    at_end: bool,
}

impl<'a> AtSides<'a> {
    fn new(meeting: &'a Meeting, piece: &'a Piece, reach: f64) -> Self {
        let distances = piece.side_distances(meeting.st, &meeting.jet);
        let sides = distances.map(|distance| distance <= reach);
        let ends = |side: usize| piece.is_border(side) || piece.is_collapsed(side);
        let at_end = meeting.flags.contains(HitFlags::TRIM_EDGE)
            || (0..4).any(|side| sides[side] && ends(side));
        Self { meeting, piece, sides, at_end }
    }

    /// Whether both meetings are at a knot line between their pieces, `self` before the line.
    fn adjoins(&self, after: &Self) -> bool {
        let (before, behind) = (self.piece.domain(), after.piece.domain());
        let touch = (0..2).all(|k| before[k][0] <= behind[k][1] && behind[k][0] <= before[k][1]);
        let at_line =
            |k: usize| before[k][1] == behind[k][0] && self.sides[2 * k + 1] && after.sides[2 * k];
        touch && (0..2).any(at_line)
    }

    /// Whether another meeting is at the same parameters, to within four times `reach`: there may be a thin piece
    /// between their pieces.
    fn is_beside(&self, other: &Self, reach: f64) -> bool {
        let [here, there] = [self, other].map(|at| at.piece.chart_uv(at.meeting.st));
        let lengths = self.piece.domain().map(|[from, to]| to - from);
        let d = (here - there) / DVec2::from_array(lengths);
        let Meeting { jet, .. } = self.meeting;
        (jet.ds * d.x).length() + (jet.dt * d.y).length() <= 4.0 * reach
    }
}

/// Drops the ends of stretches that lie inside another stretch of the same surface.
fn join_stretches(meetings: &mut Vec<Meeting>) {
    let stretches: Vec<(u32, [f64; 2], f64)> =
        meetings.iter().filter_map(|m| Some((m.surface, m.stretch?, 4.0 * m.t_error))).collect();
    meetings.retain(|m| {
        let Some([from, to]) = m.stretch else { return true };
        let is_start = (m.t - from).abs() <= (m.t - to).abs();
        !stretches.iter().any(|&(surface, [other_from, other_to], error)| {
            let other = surface == m.surface && [other_from, other_to] != [from, to];
            let continued = if is_start {
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
    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::{Query, SurfaceBvh};
    use crate::math::Ray;
    use crate::patch::Jet;

    fn view(t: f64, cosine: f64, flags: HitFlags) -> Meeting {
        let jet = Jet { point: t * DVec3::Z, ds: DVec3::X, dt: DVec3::Y };
        Meeting {
            t,
            t_error: 1e-15 / cosine,
            z_error: 1e-15 / cosine,
            surface: 0,
            piece: 0,
            st: DVec2::splat(0.5),
            jet,
            normal: Some(DVec3::Z),
            flags,
            error: 1e-15,
            edge: 0.0,
            cosine,
            stretch: None,
            beyond: false,
        }
    }

    #[test]
    fn a_certain_view_stays_where_a_grazing_one_leaves_doubt() {
        let (first, other) = (view(1.0, 0.5, HitFlags::NONE), view(1.5, 0.7, HitFlags::BORDER));
        let grazing = view(1.2, 1e-5, HitFlags::DOUBTFUL);
        let mut crossing = Crossing::new(first);
        crossing.join(grazing);
        crossing.join(other);
        assert_eq!(crossing.view.t, 1.0);
        assert_eq!(crossing.view.flags, HitFlags::DOUBTFUL.with(HitFlags::BORDER));

        // A steep doubtful view is just another view: it gives way, and its doubt goes with it.
        let mut crossing = Crossing::new(view(1.2, 0.5, HitFlags::DOUBTFUL));
        crossing.join(first);
        assert_eq!((crossing.view.t, crossing.view.flags), (1.0, HitFlags::NONE));
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
