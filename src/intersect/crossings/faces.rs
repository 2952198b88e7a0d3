//! The angle that a face covers around a place, as seen along a ray, and the edges it has there.

use glam::{DVec2, DVec3};

use super::same_place::{Reach, Sight, moved};
use crate::geometry::trim::Sectors;
use crate::geometry::{Direction, RectSide};
use crate::intersect::roots::around::{EdgeEnds, direction, edges_at, kept_sectors};
use crate::intersect::roots::meeting::Meeting;
use crate::intersect::roots::reach::{AIMED_AT_TRIMS, root_reach, trim_reach};
use crate::math::bernstein::restrict;
use crate::patch::Piece;

/// The most times a curve is halved to see on which side of the ray it passes: what is left is then
/// far below what rounding can resolve.
const MOST_HALVINGS: u32 = 40;

/// Directions are known to span a plane if the sine of the angle between two of them is more than
/// this, the root of the unit roundoff.
const LEAST_SINE: f64 = 1e-8;

/// A ray through a pole nearly touches the surface around it if some vector that leads away from
/// the pole, as seen along the ray, is shorter than this part of the longest: it goes through the
/// surface once more beside the pole, perhaps too near to be told from it. Measured on a pointed
/// lens, with directions off by about 1e-9 and 1e-6: without this, 4674 and 378 of 20,000 rays were
/// counted oddly without doubt, with it none.
const LEAST_ACROSS: f64 = 1e-6;

/// A piece of a surface, where a ray meets it.
#[derive(Clone, Copy)]
pub(super) struct Face<'a> {
    piece: &'a Piece,
    pub(super) meeting: &'a Meeting,
    /// How far the place may be from the same place as met on other pieces.
    pub(super) reach: Reach,
    /// How near trim edges must be to count.
    edges: EdgeReach,
    /// The ray's direction.
    axis: DVec3,
}

/// How near trim edges must be to pass through a place.
#[derive(Clone, Copy)]
pub(super) enum EdgeReach {
    /// As near as the edges of other faces that meet there may be seen.
    Met,
    /// As near as to a ray that was aimed at them.
    Aimed,
}

impl<'a> Face<'a> {
    /// The face of a meeting.
    pub(super) fn new(meeting: &'a Meeting, edges: EdgeReach, sight: Sight<'a>) -> Self {
        let Sight { pieces, axis } = sight;
        let reach = match edges {
            EdgeReach::Met => Reach::around(meeting, axis),
            EdgeReach::Aimed => Reach::aimed(meeting, axis),
        };
        Self { piece: &pieces[meeting.piece as usize], meeting, reach, edges, axis }
    }

    /// The face, whose place may be as far as this from the same place as met elsewhere.
    pub(super) fn with_reach(self, reach: Reach) -> Self {
        Self { reach, ..self }
    }

    /// The sides of the piece that the place is at.
    pub(super) fn sides(&self) -> [bool; 4] {
        self.reach.sides(self.meeting.st, &self.meeting.jet)
    }

    /// Whether another place of the piece is the same, to within rounding; at a pole all places of
    /// the side are.
    pub(super) fn holds(&self, st: DVec2) -> bool {
        moved(&self.meeting.jet, st - self.meeting.st) <= 2.0 * self.reach.along_ray
    }

    /// The angle the face covers, in radians: positive if the ray leaves through the face, negative
    /// if it enters. `None` if the angle cannot be determined.
    pub(super) fn angle(&self) -> Option<f64> {
        let sides = self.sides();
        let mut poles = self.piece.collapsed_sides().filter(|(side, _)| sides[*side]);
        let angle = match (poles.next(), poles.next()) {
            (None, _) => self.around_place(sides),
            (Some((side, pole)), None) => self.around_pole(side, pole),
            _ => None, // where two such sides meet, no tangent leads away
        };
        angle.filter(|angle| angle.is_finite())
    }

    /// The angle around a place with a tangent plane: of the directions in that plane that neither
    /// a side nor trims cut off.
    fn around_place(&self, sides: [bool; 4]) -> Option<f64> {
        let (jet, lengths) = (&self.meeting.jet, self.piece.lengths());
        let sectors = self.sectors()?;
        let in_space = |angle: f64| {
            let along = direction(angle) / lengths;
            self.across(along.x * jet.ds + along.y * jet.dt)
        };

        let kept = kept_sectors(sides, sectors.as_ref());
        // All turn the same way; for one that turns by half a turn, rounding would decide which
        // way.
        let turned = |[from, to]: [f64; 2]| self.turn(in_space(from), in_space(to)).abs();
        Some(kept.into_iter().map(turned).sum::<f64>().copysign(self.meeting.cosine))
    }

    /// The sectors that trims cut the surroundings of the place into: `Some(None)` if no edge is
    /// near, `None` if that cannot be told.
    fn sectors(&self) -> Option<Option<Sectors>> {
        let Meeting { st, jet, trim_curve, .. } = self.meeting;
        let trims = self.piece.trims().filter(|_| trim_curve.is_some());
        let Some(trims) = trims else { return Some(None) };
        let uv = self.piece.chart_uv(*st);
        let sectors = match self.edges {
            EdgeReach::Met => {
                let reach = trim_reach(jet, self.reach.along_ray);
                trims.around(uv, self.piece.chart_reach(reach, 1.0))
            }
            EdgeReach::Aimed => {
                let reach = aimed_reach(self.meeting, self.axis);
                let reach = self.piece.chart_reach(reach, AIMED_AT_TRIMS);
                trims.around_within(uv, reach, AIMED_AT_TRIMS)
            }
        };
        sectors.map(Some)
    }

    /// The edges that lead away from the place, as far as they are known.
    pub(super) fn edge_ends(&self) -> EdgeEnds {
        let sides = self.sides();
        let borders = RectSide::ALL.map(|side| sides[side] && self.piece.is_border(side));
        let Some(sectors) = self.sectors() else { return EdgeEnds::new() };
        edges_at(self.piece, &self.meeting.jet, borders, sectors.as_ref())
    }

    /// The angle around a pole: swept, along the collapsed side, by the
    /// [direction](Piece::away_from_pole) that leads away from the pole.
    fn around_pole(&self, side: RectSide, pole: DVec3) -> Option<f64> {
        let (piece, fixed) = (self.piece, side.fixed());
        let away = piece.away_from_pole(side, pole);
        // Where all of them are parallel, as at a cusp, they say nothing about its surroundings.
        let spans = |a: &DVec3, b: &DVec3| {
            a.cross(*b).length() > LEAST_SINE * a.length() * b.length() // false for zero
        };
        if !away.iter().any(|a| spans(a, &away[0]) || spans(a, &away[away.len() - 1])) {
            return None;
        }
        let longest = away.iter().map(|v| v.length()).fold(0.0, f64::max);
        let across: Vec<DVec3> = away.into_iter().map(|v| self.across(v)).collect();

        // The normal is the cross product of the direction's derivative along the side and the
        // direction, or of these in reverse order.
        let sign = if (fixed == Direction::U) != side.is_last() { 1.0 } else { -1.0 };
        let [start, end] = piece.domain()[side.along()];
        let local = |u: f64| ((u - start) / (end - start)).clamp(0.0, 1.0);
        let kept = match piece.trims() {
            None => vec![[start, end]],
            Some(trims) => trims.kept_along(fixed, piece.chart_uv(side.place(0.5))[fixed]),
        };
        let swept = |stretch: [f64; 2]| {
            let [from, to] = stretch.map(local);
            self.swept(part_of(&across, from, to), LEAST_ACROSS * longest, MOST_HALVINGS)
        };
        Some(sign * kept.into_iter().map(swept).sum::<Option<f64>>()?)
    }

    /// The angle a Bézier curve sweeps about the ray; its control points are given as seen along
    /// the ray. If they are all on one side of a line through the ray, so is the curve, and its
    /// ends give the angle. Otherwise this holds, sooner or later, for the control points of its
    /// halves. `None` if the curve comes nearer than `least` to the ray.
    fn swept(&self, control: Vec<DVec3>, least: f64, halvings: u32) -> Option<f64> {
        let [first, last] = [control[0], control[control.len() - 1]];
        let middle = control.iter().filter_map(|v| v.try_normalize()).sum::<DVec3>();
        // By more than rounding: for half a turn, rounding would decide which way.
        let needed = |v: &DVec3| (LEAST_SINE * v.length()).max(least);
        let ahead = |v: &DVec3| v.dot(middle) > needed(v) * middle.length();
        if control.iter().all(ahead) {
            return Some(self.turn(first, last));
        }
        let halvings = halvings.checked_sub(1)?;
        let below = self.swept(part_of(&control, 0.0, 0.5), least, halvings)?;
        Some(below + self.swept(part_of(&control, 0.5, 1.0), least, halvings)?)
    }

    /// A vector as seen along the ray.
    fn across(&self, v: DVec3) -> DVec3 {
        v.reject_from_normalized(self.axis)
    }

    /// The angle about the ray from one vector seen along it to another, up to half a turn to
    /// either side.
    fn turn(&self, from: DVec3, to: DVec3) -> f64 {
        let sine = self.axis.dot(from.cross(to));
        if from == DVec3::ZERO || to == DVec3::ZERO { f64::NAN } else { sine.atan2(from.dot(to)) }
    }
}

/// How near a trim edge must be, in each parameter, for a ray to have been aimed at it.
fn aimed_reach(meeting: &Meeting, axis: DVec3) -> DVec2 {
    let along = meeting.aimed * (meeting.z_error / meeting.error);
    root_reach(&meeting.jet, axis, meeting.aimed, along)
}

/// A part of a Bézier curve, of constant weight.
fn part_of(control: &[DVec3], from: f64, to: f64) -> Vec<DVec3> {
    let mut control = control.to_vec();
    restrict(&mut control, from, to);
    control
}
