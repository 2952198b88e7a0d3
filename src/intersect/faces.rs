//! The angle that a face covers around a place, as seen along a ray.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::HitFlags;
use super::borders::trim_reach;
use super::meeting::Meeting;
use crate::geometry::Direction;
use crate::patch::{CollapsedSide, Piece};

/// A collapsed side is looked at from one place to the next in so many steps: between two of them
/// the direction that leads away from the pole turns by less than half a turn.
const STEPS_ALONG: usize = 16;

/// A piece of a surface, where a ray meets it.
pub(super) struct Face<'a> {
    pub(super) piece: &'a Piece,
    pub(super) meeting: &'a Meeting,
    /// How far the place may be from where others meet it.
    pub(super) reach: f64,
    /// The ray's direction.
    pub(super) axis: DVec3,
}

impl Face<'_> {
    /// The sides of the piece that the place is at.
    pub(super) fn sides(&self) -> [bool; 4] {
        let distances = self.piece.side_distances(self.meeting.st, &self.meeting.jet);
        distances.map(|off| off <= self.reach)
    }

    /// The angle it covers, in radians: above zero where a ray leaves through it, below where one enters. `None` where
    /// it cannot be told.
    pub(super) fn angle(&self) -> Option<f64> {
        let sides = self.sides();
        let poles = self.piece.collapsed_sides().filter(|(side, _)| sides[side.number()]);
        let mut poles = poles.map(|(side, _)| side);
        let angle = match (poles.next(), poles.next()) {
            (None, _) => self.around_place(sides),
            (Some(side), None) => self.around_pole(side),
            _ => None, // where two such sides meet, no tangent leads away
        };
        angle.filter(|angle| angle.is_finite())
    }

    /// Around a place with a tangent plane: of all directions in it, those that neither a side nor trims cut off.
    fn around_place(&self, [s0, s1, t0, t1]: [bool; 4]) -> Option<f64> {
        let Meeting { st, jet, flags, .. } = self.meeting;
        let lengths = DVec2::from_array(self.piece.domain().map(|[from, to]| to - from));
        let sectors = match self.piece.trims() {
            Some(trims) if flags.contains(HitFlags::TRIM_EDGE) => {
                let reach = trim_reach(jet, self.reach) * lengths;
                Some(trims.around(self.piece.chart_uv(*st), reach)?)
            }
            _ => None,
        };
        let in_space = |angle: f64| {
            let along = DVec2::from_angle(angle) / lengths;
            self.across(along.x * jet.ds + along.y * jet.dt)
        };

        let edges = sectors.iter().flat_map(|sectors| sectors.edges().iter().copied());
        let mut cuts: Vec<f64> = (0..=4).map(|k| f64::from(k) * FRAC_PI_2).chain(edges).collect();
        cuts.sort_by(f64::total_cmp);
        let kept = cuts.windows(2).filter(|cut| {
            let middle = 0.5 * (cut[0] + cut[1]);
            let (v, u) = middle.sin_cos();
            let beyond = s0 && u < 0.0 || s1 && u > 0.0 || t0 && v < 0.0 || t1 && v > 0.0;
            cut[0] < cut[1] && !beyond && sectors.as_ref().is_none_or(|one| one.keeps(middle))
        });
        Some(kept.map(|cut| self.turn(in_space(cut[0]), in_space(cut[1]))).sum())
    }

    /// Around a pole: what the direction that leads away from it sweeps along the collapsed side.
    fn around_pole(&self, side: CollapsedSide) -> Option<f64> {
        let (piece, fixed) = (self.piece, side.parameter());
        let away = |along: f64| {
            let mut st = DVec2::splat(along);
            st[fixed] = side.end() as f64;
            let jet = piece.patch.jet(st);
            let out = [jet.ds, jet.dt][fixed];
            self.across(if side.end() == 0 { out } else { -out })
        };
        // The normal is the one's derivative along the side times the direction, or that times this.
        let sign = if (fixed == 0) == (side.end() == 0) { 1.0 } else { -1.0 };
        let swept = |[from, to]: [f64; 2]| -> f64 {
            let at = |k: usize| away(from + (to - from) * k as f64 / STEPS_ALONG as f64);
            (0..STEPS_ALONG).map(|k| self.turn(at(k), at(k + 1))).sum()
        };
        let [start, end] = piece.domain()[1 - fixed];
        let local = |u: f64| ((u - start) / (end - start)).clamp(0.0, 1.0);
        let kept = match piece.trims() {
            None => vec![[start, end]],
            Some(trims) => {
                let direction = [Direction::U, Direction::V][fixed];
                trims.kept_along(direction, piece.chart_uv(side.beside(DVec2::splat(0.5)))[fixed])
            }
        };
        Some(sign * kept.into_iter().map(|stretch| swept(stretch.map(local))).sum::<f64>())
    }

    /// A vector as seen along the ray.
    fn across(&self, v: DVec3) -> DVec3 {
        v.reject_from_normalized(self.axis)
    }

    /// By how much one of two such vectors is turned to become the other, about the ray: up to half a turn to either side.
    fn turn(&self, from: DVec3, to: DVec3) -> f64 {
        let sine = self.axis.dot(from.cross(to));
        if from == DVec3::ZERO || to == DVec3::ZERO { f64::NAN } else { sine.atan2(from.dot(to)) }
    }
}
