//! Whether what is reported of a place adds up.
//!
//! Take a disk across the ray so small that the rays through it cannot be told apart. Of the faces
//! that are met at a place, each covers a share of the disk: all of it where the ray passes well
//! inside the face, none where it passes well outside and meets it only because edges are met from
//! some way off, half at an edge, a sector at a corner. All rays through the disk leave a closed
//! surface the same number of times more than they enter it, so that the shares, positive where
//! the ray leaves and negative where it enters, add up to that number.
//!
//! Edges are met from farther away than meetings are merged. So, some way beside a corner, a face
//! that is met on the outside of one edge may be merged with a face that the ray goes through, or
//! dropped for its sake, while the face across that edge stays: it then seems to be a crossing.
//! There the reported crossings are not what the shares add up to, and are doubtful.

use std::f64::consts::TAU;

use smallvec::SmallVec;

use super::faces::{EdgeReach, Face};
use super::same_place::{Reach, Sight, at_one_place, reach_along};
use super::sense::{has_no_normal, may_touch};
use super::vertices::{AtVertex, MOST_TURNED};
use crate::intersect::HitFlags;
use crate::intersect::roots::meeting::{Cover, Meeting};

/// What the crossings of each place must add up to.
pub(super) struct Balance {
    places: SmallVec<[Shares; 2]>,
}

impl Balance {
    /// Finds the places at which several faces are met, and numbers the meetings by them.
    /// The meetings are sorted by `t`. Each of a place is at one place with some other of it.
    pub(super) fn new(meetings: &mut [Meeting], sight: Sight<'_>) -> Self {
        let reach = reach_along(meetings);
        let mut places = SmallVec::new();
        for run in meetings.chunk_by_mut(|a, b| b.t - a.t <= reach) {
            let firsts = firsts_of(run, sight);
            for first in 0..run.len() {
                let here = |k: &usize| firsts[*k] == first;
                let members: SmallVec<[usize; 8]> = (0..run.len()).filter(here).collect();
                let shares = Shares::of(members.iter().map(|&k| &run[k]), sight);
                if let Some(shares) = shares {
                    let place = places.len() as u32;
                    members.iter().for_each(|&k| run[k].place = Some(place));
                    places.push(shares);
                }
            }
        }
        Self { places }
    }

    /// Flags the crossings of places at which they do not add up.
    pub(super) fn check(&self, crossings: &mut [Meeting]) {
        for (shares, place) in self.places.iter().zip(0..) {
            let here = crossings.iter_mut().filter(|crossing| crossing.place == Some(place));
            let mut here: SmallVec<[&mut Meeting; 4]> = here.collect();
            let left = here.iter().filter(|crossing| crossing.cosine > 0.0).count();
            if !shares.allow(left, here.len() - left) {
                here.iter_mut().for_each(|crossing| crossing.flags.insert(HitFlags::DOUBTFUL));
            }
        }
    }
}

/// For each of some meetings, the first of those that it is at one place with, directly or by way
/// of others.
fn firsts_of(run: &[Meeting], sight: Sight<'_>) -> SmallVec<[usize; 8]> {
    let mut firsts: SmallVec<[usize; 8]> = (0..run.len()).collect();
    for k in 1..run.len() {
        for j in 0..k {
            let [a, b] = [firsts[j], firsts[k]];
            if a != b && at_one_place(&run[j], &run[k], sight) {
                let (to, from) = (a.min(b), a.max(b));
                firsts.iter_mut().filter(|first| **first == from).for_each(|first| *first = to);
            }
        }
    }
    firsts
}

/// The shares of the disk that the faces of a place cover.
struct Shares {
    faces: usize,
    /// Their sum, positive where the ray leaves; not a number if one is unknown.
    net: f64,
    /// Whether the ray enters one face and leaves another.
    both: bool,
}

impl Shares {
    /// `None` if nothing is to be said: where there is only one face, where the faces are all met
    /// from one side and belong to one surface, whose pieces meet without edges, or where the ray
    /// may touch one of them.
    fn of<'m>(
        meetings: impl Iterator<Item = &'m Meeting> + Clone,
        sight: Sight<'_>,
    ) -> Option<Self> {
        let first = meetings.clone().next()?;
        let both = meetings.clone().any(|m| m.cosine * first.cosine < 0.0);
        let is_one = !both && meetings.clone().all(|m| m.surface == first.surface);
        if is_one || meetings.clone().any(|m| may_touch(m) || has_no_normal(m)) {
            return None;
        }
        let mut faces: SmallVec<[Face<'_>; 4]> = SmallVec::new();
        let mut net = 0.0;
        for meeting in meetings.clone() {
            let around = Reach::around(meeting, sight.axis);
            let is_seen = faces.iter().any(|face| {
                face.meeting.piece == meeting.piece && face.with_reach(around).holds(meeting.st)
            });
            if !is_seen {
                let face = Face::new(meeting, EdgeReach::Aimed, sight);
                net += face.share();
                faces.push(face);
            }
        }
        let is_whole = (net - net.round()).abs() <= MOST_TURNED;
        if faces.len() > 2 && !is_whole {
            // So near to a corner that faces do not agree about its edges. A larger disk, of what
            // they cover as far as edges are met, will do if all of them are met.
            match AtVertex::of(meetings, sight) {
                AtVertex::Through(sign) => net = sign,
                AtVertex::Touching => net = 0.0,
                AtVertex::ThroughMore | AtVertex::Unknown => {}
            }
        }
        (faces.len() > 1).then_some(Self { faces: faces.len(), net, both })
    }

    /// Whether the crossings may be these, of which the ray leaves so many and enters so many.
    ///
    /// Which side of an edge the ray passes may be judged otherwise by the two faces there: the
    /// share of one is then half too large or too small. Of two faces, that is no reason for doubt,
    /// nor is a share that is unknown: neither was merged with a third.
    /// Nor is it of one crossing that all faces agree about; nor that their shares are fewer than a
    /// closed surface has, for an open one may end there, or that one of them is unknown.
    fn allow(&self, left: usize, entered: usize) -> bool {
        let sum = left as f64 - entered as f64;
        let is_one = !self.both && left + entered == 1;
        if is_one {
            let is_more = self.net.abs() > 1.5 + MOST_TURNED; // false for NaN
            !is_more
        } else {
            let off = (sum - self.net).abs();
            if self.faces == 2 {
                off.is_nan() || off <= 0.5 + MOST_TURNED
            } else {
                off <= MOST_TURNED
            }
        }
    }
}

impl Face<'_> {
    /// The share of its surroundings that the face covers, positive if the ray leaves through it;
    /// not a number if it is unknown.
    fn share(&self) -> f64 {
        match self.meeting.cover {
            Cover::Nothing => 0.0,
            Cover::Whole => 1f64.copysign(self.meeting.cosine),
            Cover::Sector => self.angle().map_or(f64::NAN, |angle| angle / TAU),
            Cover::Unknown => f64::NAN,
        }
    }
}
