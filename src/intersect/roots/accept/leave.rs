//! What a ray leaves is not met again: the root it starts on, and the edge that this root is on.

use super::{Candidate, Dropped, steep};
use crate::intersect::HitFlags;
use crate::intersect::exact::Evidence;
use crate::intersect::hit::SPARE;
use crate::intersect::roots::around::Turn;
use crate::intersect::roots::reach::TRIM_REACH;
use crate::intersect::roots::spot::Spot;
use crate::intersect::roots::start::{Sense, StartRoot, is_at_side};
use crate::patch::{LEAF_SLACK, Leaf, holds};

impl Candidate<'_> {
    /// Drops the root the ray starts on: it is not met again.
    pub(super) fn leave_start(&self) -> Result<(), Dropped> {
        let Self { question, error, z_error, cosine, .. } = *self;
        let Some(root) = question.from else { return Ok(()) };
        let reach = start_reach(self.solution.evidence, error, z_error, cosine) + root.error;
        if self.on_ray.z.abs() > reach {
            return Ok(());
        }
        let Some(start) = question.start() else { return Ok(()) };
        let Spot { piece, ref jet, .. } = self.on_ray.spot;
        let is_near = jet.point.distance(start.jet.point) <= 2.0 * reach;
        if start.piece.surface != piece.surface || !is_near {
            return Ok(());
        }
        match self.is_start(&start, reach) {
            Some(true) => Err(Dropped::Surely),
            Some(false) => Ok(()),
            None => Err(Dropped::InDoubt(0.0)),
        }
    }

    /// Whether this is the root the ray starts on, which lies on the same surface and no farther off
    /// than `reach`; `None` if that is not known.
    ///
    /// On the start's own piece it is, if the solution is the only root in a rectangle that holds
    /// the start. Another piece has the start's root only if that is beside a side of both, to
    /// within `reach`. But so near to a crease the ray may meet the other face, too: there it goes
    /// through the surface in the opposite sense, unless the surface is joined to itself the other
    /// way round. And it is no farther off than the start is along *this* ray: to the ray that found
    /// it, which may have been grazing, `reach` is far.
    fn is_start(&self, start: &StartRoot<'_>, reach: f64) -> Option<bool> {
        let Self { z_error, cosine, flags, leaf, .. } = *self;
        let is_within = self.on_ray.z.abs() <= z_error + start.error;
        match self.solution.evidence {
            Evidence::Isolated(rect) if start.root.piece == leaf.piece => {
                holds(rect, start.root.st).then_some(true)
            }
            Evidence::Isolated(_) => match start.sense(cosine) {
                Sense::Same if is_within => {
                    let Spot { piece, st, ref jet, .. } = self.on_ray.spot;
                    let beside = 2.0 * reach;
                    let are_beside = start.is_at_side(beside) && is_at_side(piece, st, jet, beside);
                    let turn = || start.turn(&self.on_ray.spot, beside, beside);
                    let is_one = is_short(leaf, reach) && are_beside;
                    (is_one && turn() != Turn::Opposite).then_some(true)
                }
                Sense::Opposite if !is_within => Some(false),
                _ => None,
            },
            // Where the ray may touch the surface at the pole, this may be its next root.
            Evidence::Collapsed if flags.contains(HitFlags::DOUBTFUL) => None,
            Evidence::Collapsed => is_within.then_some(true),
            Evidence::Contact(_) | Evidence::Stretch { .. } => None,
        }
    }

    /// Drops the crossing of an edge on which the ray starts, if the start was found on the other
    /// surface of the edge: at the same place, and with the same sign of `N · d`, as in
    /// [`crossings`](crate::intersect::crossings).
    ///
    /// A ray that passes the edge on its outside goes in through one surface and out through the
    /// other. Where they are turned opposite ways, these have the same sign.
    ///
    /// Beside the edge the ray crosses one of the surfaces, by rounding perhaps both. It is in
    /// doubt whether crossings are the same that are only as near to each other, and to the edge,
    /// as both may be off.
    ///
    /// A flat ray leaves its start's surface so slowly that it may pass an edge far away within
    /// rounding. There it is in doubt, too, if the two surfaces share that edge, and unless it is
    /// known to go through them in opposite senses.
    pub(super) fn leave_edge(&self) -> Result<(), Dropped> {
        let Self { question, z_error, cosine, flags, trims, .. } = *self;
        let Some(root) = question.from else { return Ok(()) };
        let (z, point) = (self.on_ray.z, self.on_ray.spot.jet.point);
        let most_off = SPARE * z_error + root.error;
        // What lies on a trim edge may be as far from what is kept as is allowed there.
        let farthest =
            trims.edge().map_or(most_off, |(distance, _)| TRIM_REACH * most_off + distance);
        let is_clear = flags.without(HitFlags::TRIM_EDGE).is_empty();
        if !(is_clear && z.abs() <= farthest) {
            return Ok(());
        }
        let Some(start) = question.start() else { return Ok(()) };
        let sense = start.sense(cosine);
        if sense == Sense::Opposite {
            return Ok(());
        }
        let is_at_place = |apart: f64, more: f64| {
            z.abs() <= apart
                && point.distance(start.jet.point) <= 2.0 * apart
                && (trims.edge().is_some() || self.is_at_border(more))
        };
        let off = z_error + start.error;
        let is_edge = start.is_on_edge() && start.has_edge_at(point);
        if sense == Sense::Same && is_at_place(off, 0.0) && is_edge && is_short(self.leaf, off) {
            let is_doubtful = start.turn(&self.on_ray.spot, 0.0, z_error) == Turn::Opposite;
            return Err(if is_doubtful { Dropped::InDoubt(0.0) } else { Dropped::Surely });
        }
        let are_near = sense == Sense::Same
            && is_at_place(farthest, most_off)
            && start.may_be_on_edge(most_off);
        let is_passed = || {
            start.is_flat()
                && is_at_place(farthest, SPARE * z_error)
                && start.may_have_edge_at(point, z_error)
        };
        if are_near || is_passed() { Err(Dropped::InDoubt(0.0)) } else { Ok(()) }
    }
}

/// How far from a ray's start a solution may be and still be the root the ray starts on.
///
/// A contact is cut off where the leaf's slack ends: another leaf may have found what lies between
/// the contact and the start, which is no longer than the contact.
fn start_reach(evidence: Evidence, error: f64, z_error: f64, cosine: f64) -> f64 {
    match evidence {
        Evidence::Contact([from, to]) => z_error.max(steep(error, cosine).min(to - from + error)),
        _ => SPARE * z_error,
    }
}

/// Whether roots that may be this far apart along a ray can be said to be one: where the distance
/// is less than the leaf's slack. How far the root at the tip of a spike may be from there, nobody
/// knows.
fn is_short(leaf: &Leaf, reach: f64) -> bool {
    let [x, y] = leaf.half_side_lengths().map(f64::from);
    reach <= 2.0 * LEAF_SLACK * x.min(y)
}
