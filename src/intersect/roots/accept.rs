//! What becomes of a solution: a meeting, a doubt, or nothing.

use glam::{DVec2, DVec3};

use super::borders::{
    AIMED, AIMED_AT_TRIMS, TRIM_REACH, TRIM_SPARE, at_border, on_piece, root_reach, rounding_at,
    trim_reach,
};
use super::grazing::KnownRoot;
use super::meeting::{Cover, Meeting};
use super::pole_side::stands_still;
use super::question::{PlacedLeaf, Question, Sense, Start};
use super::spot::Spot;
use super::trim_side::trim_side;
use crate::geometry::trim::Side;
use crate::intersect::HitFlags;
use crate::intersect::exact::{AT_POLE, END, Proof, STRETCH, Solution};
use crate::math::{RayFrame, rounding};
use crate::patch::{Jet, LEAF_SLACK, Leaf, holds};

/// Why a solution is no meeting.
pub(crate) enum Dropped {
    /// Nothing is met there.
    Surely,
    /// Something may still be met from this ray parameter on.
    InDoubt(f64),
}

impl Dropped {
    /// In doubt from the distance `z` along the ray on.
    fn from(z: f64, ray: &RayFrame) -> Self {
        Self::InDoubt(z.max(ray.z_range[0]) * ray.t_from_z)
    }
}

/// The meeting of a solution, if it lies on the piece and in the ray's range. `known` is the
/// surface at the solution and its distance along the ray, if the search has them.
///
/// # Errors
/// Why it is none.
pub(crate) fn accept(
    question: &Question<'_>,
    place: &PlacedLeaf<'_>,
    solution: &Solution,
    known: Option<(Jet, f64)>,
) -> Result<Meeting, Dropped> {
    let on_ray = on_ray(place, question.ray, solution, known)?;
    let mut candidate = Candidate::new(question, place.leaf, solution, on_ray);
    candidate.keep_to_trims()?;
    candidate.leave_start()?;
    candidate.leave_edge()?;
    candidate.stay_in_range()?;
    if candidate.just_cut_off {
        return Err(Dropped::from(candidate.on_ray.z, question.ray));
    }
    Ok(candidate.meeting())
}

/// A place where the ray may meet the piece, and what is known about it so far.
struct Candidate<'a> {
    question: &'a Question<'a>,
    leaf: &'a Leaf,
    solution: &'a Solution,
    on_ray: OnRay<'a>,
    /// Error bounds of the point: off the ray, and along it.
    error: f64,
    z_error: f64,
    normal: Option<DVec3>,
    cosine: f64,
    flags: HitFlags,
    /// Whether the solution lies a little outside the piece.
    moved: bool,
    /// Whether a trim curve is near, if only one along the border; see [`Meeting::at_trims`].
    at_trims: bool,
    /// How far the point may be from the trim edge it is at; zero elsewhere.
    edge: f64,
    /// Whether trims cut the point off by more than the rounding of a ray aimed at their edge.
    cut_off: bool,
    /// Whether trims keep it, and all that a ray aimed at it may meet.
    kept_whole: bool,
    /// See [`Meeting::on_edge`].
    on_edge: bool,
    /// Whether trims cut it off for certain, but so near to their edge that another search may have
    /// found it there.
    just_cut_off: bool,
}

impl<'a> Candidate<'a> {
    fn new(
        question: &'a Question<'a>,
        leaf: &'a Leaf,
        solution: &'a Solution,
        on_ray: OnRay<'a>,
    ) -> Self {
        let (ray, proof) = (question.ray, solution.proof);
        let OnRay { ref spot, z, .. } = on_ray;
        let error = spot.piece.patch.error_bound(ray.magnitude);
        let (normal, mut cosine) = spot.normal_along(ray);
        if matches!(proof, Proof::Contact(_)) && !spot.has_one_side(ray, cosine, error) {
            cosine = 0.0;
        }
        let mut flags = match proof {
            Proof::Isolated(_) | Proof::Collapsed => HitFlags::NONE,
            Proof::Contact(_) => HitFlags::DOUBTFUL,
            Proof::Stretch(_) => HitFlags::DOUBTFUL.with(HitFlags::INSIDE),
        };
        if proof == Proof::Collapsed && may_touch(leaf, &spot.jet, cosine, error) {
            flags.insert(HitFlags::DOUBTFUL);
        }
        let z_error = error_along(proof, error, (z, cosine));
        let moved = spot.st != solution.st;
        Self {
            question,
            leaf,
            solution,
            on_ray,
            error,
            z_error,
            normal,
            cosine,
            flags,
            moved,
            at_trims: false,
            edge: 0.0,
            cut_off: false,
            kept_whole: false,
            on_edge: false,
            just_cut_off: false,
        }
    }

    /// Drops what trims cut off, but not what lies on their edges. At a pole, a kept parameter that
    /// leads to it is taken, if there is one.
    fn keep_to_trims(&mut self) -> Result<(), Dropped> {
        let Self { question, leaf, ref on_ray, error, z_error, .. } = *self;
        let OnRay { ref spot, z, allowed, .. } = *on_ray;
        let (ray, piece) = (question.ray, spot.piece);
        let known = KnownRoot { ray, error, along: z_error };
        match trim_side(leaf, piece, (spot.st, &spot.jet), &known) {
            Side::Inside => {}
            Side::Edge { inside, distance } => {
                self.at_trims = true;
                if piece.is_cut_within(spot.st, trim_reach(&spot.jet, z_error)) {
                    self.flags.insert(HitFlags::TRIM_EDGE);
                }
                let lengths = DVec2::from_array(piece.domain().map(|[from, to]| to - from));
                let speeds = DVec2::new(spot.jet.ds.length(), spot.jet.dt.length());
                // At a pole a parameter may be anything: a distance that is not finite says
                // nothing.
                let off = (distance / lengths).dot(speeds);
                self.edge = if off.is_finite() { off } else { 0.0 };
                let pole = leaf.collapsed(piece).filter(|_| !inside);
                let kept = pole.and_then(|side| spot.kept(question.set, side, (ray, allowed)));
                if let Some(kept) = kept {
                    self.on_ray.z = ray.axis.dot(kept.jet.point - ray.origin);
                    (self.normal, self.cosine) = kept.normal_along(ray);
                    self.on_ray.spot = kept;
                } else if question.all_hits {
                    match aimed_side(leaf, spot, ray, z_error / error) {
                        Side::Outside => self.cut_off = !inside,
                        Side::Inside => self.kept_whole = inside,
                        Side::Edge { .. } => {
                            self.on_edge = self.flags.contains(HitFlags::TRIM_EDGE)
                        }
                    }
                }
            }
            // The ray may run on inside the surface to a part that is kept.
            Side::Outside if matches!(self.solution.proof, Proof::Stretch(_)) => {
                return Err(Dropped::from(z, ray));
            }
            Side::Outside if question.all_hits => {
                let known =
                    KnownRoot { ray, error: TRIM_SPARE * error, along: TRIM_SPARE * z_error };
                let side = trim_side(leaf, piece, (spot.st, &spot.jet), &known);
                self.just_cut_off = matches!(side, Side::Edge { .. });
                if !self.just_cut_off {
                    return Err(Dropped::Surely);
                }
            }
            Side::Outside => return Err(Dropped::Surely),
        }
        Ok(())
    }

    /// Drops the root the ray starts on: it is not met again.
    fn leave_start(&self) -> Result<(), Dropped> {
        let Self { question, error, z_error, cosine, .. } = *self;
        let (z, proof) = (self.on_ray.z, self.solution.proof);
        let off = question.from.map_or(f64::NEG_INFINITY, |root| root.error);
        let reach = start_reach(proof, error, z_error, cosine) + off;
        if z.abs() > reach {
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
    /// the start. Another piece has the start's root only if the ray starts beside a side, to
    /// within `reach`. But so near to a crease it may meet the other face, too: there it goes
    /// through the surface in the opposite sense. And it is no farther off than the start is along
    /// *this* ray: to the ray that found it, which may have been grazing, `reach` is far.
    fn is_start(&self, start: &Start<'_>, reach: f64) -> Option<bool> {
        let Self { z_error, cosine, flags, leaf, .. } = *self;
        // Where the ray may touch the surface at a pole, this may be its next root.
        if flags.contains(HitFlags::DOUBTFUL) {
            return None;
        }
        let is_within = self.on_ray.z.abs() <= z_error + start.error;
        match self.solution.proof {
            Proof::Isolated(rect) if start.root.piece == leaf.piece => {
                holds(rect, start.root.st).then_some(true)
            }
            Proof::Isolated(_) => match start.sense(cosine) {
                Sense::Same if is_within => {
                    (is_short(leaf, reach) && start.is_at_side(2.0 * reach)).then_some(true)
                }
                Sense::Opposite if !is_within => Some(false),
                _ => None,
            },
            Proof::Collapsed => is_within.then_some(true),
            Proof::Contact(_) | Proof::Stretch(_) => None,
        }
    }

    /// Drops the crossing of an edge on which the ray starts, if the start was found on the other
    /// surface of the edge: at the same place, and with the same sign of `N · d`, as in
    /// [`crossings`](crate::intersect::crossings).
    ///
    /// Beside the edge the ray crosses one of the surfaces, by rounding perhaps both. It is in
    /// doubt whether crossings are the same that are only as near to each other, and to the edge,
    /// as both may be off.
    fn leave_edge(&self) -> Result<(), Dropped> {
        let Self { question, z_error, cosine, flags, at_trims, edge, .. } = *self;
        let (z, point) = (self.on_ray.z, self.on_ray.spot.jet.point);
        // What lies on a trim edge may be as far from what is kept as is allowed there.
        let most_off = question.from.map_or(f64::NEG_INFINITY, |root| z_error + root.error);
        let farthest = if at_trims { TRIM_REACH * most_off + edge } else { most_off };
        let is_clear = flags.without(HitFlags::TRIM_EDGE).is_empty();
        if !(is_clear && z.abs() <= farthest) {
            return Ok(());
        }
        let start = question.start().filter(|start| start.sense(cosine) == Sense::Same);
        let Some(start) = start else { return Ok(()) };
        let is_at_place = |apart: f64, more: f64| {
            z.abs() <= apart
                && point.distance(start.jet.point) <= 2.0 * apart
                && (at_trims || self.is_at_border(more))
        };
        let off = z_error + start.error;
        let is_edge = start.is_on_edge() && start.has_edge_at(point);
        if is_at_place(off, 0.0) && is_edge && is_short(self.leaf, off) {
            return Err(Dropped::Surely);
        }
        let is_in_doubt = is_at_place(farthest, most_off) && start.may_be_on_edge(most_off);
        if is_in_doubt { Err(Dropped::InDoubt(0.0)) } else { Ok(()) }
    }

    /// Drops what lies outside the ray's range. At the ends of the range, and at trim edges that
    /// are met at a small angle, the result is doubtful.
    fn stay_in_range(&mut self) -> Result<(), Dropped> {
        let [t, t_error] = [self.on_ray.z, self.z_error].map(|z| z * self.question.ray.t_from_z);
        let [t_min, t_max] = self.question.t_range;
        let undecided = [t_min, t_max].iter().any(|end| (t - end).abs() <= t_error);
        if !(t > t_min && t < t_max) {
            let from = Dropped::InDoubt((t - t_error).max(t_min));
            return Err(if undecided { from } else { Dropped::Surely });
        }
        let is_flat = self.z_error > EDGE_IN_DOUBT * self.error;
        if undecided || (self.at_trims && is_flat) {
            self.flags.insert(HitFlags::DOUBTFUL);
        }
        Ok(())
    }

    /// Whether the place is at a border, if it may be off by `more` than its error.
    fn is_at_border(&self, more: f64) -> bool {
        let Spot { piece, st, ref jet, .. } = self.on_ray.spot;
        at_border(piece, st, jet, self.error + more)
    }

    fn meeting(self) -> Meeting {
        let at_border = self.is_at_border(0.0);
        let Self { question, on_ray, error, z_error, normal, .. } = self;
        let Self { at_trims, edge, mut cosine, mut flags, .. } = self;
        let OnRay { spot, z, residual, .. } = on_ray;
        let ray = question.ray;
        if at_border {
            flags.insert(HitFlags::BORDER);
        }
        let aimed = AIMED * rounding_at(spot.jet.point, spot.piece, ray);
        let is_at_pole = self.solution.proof == Proof::Collapsed;
        let beside_pole = is_at_pole && residual > aimed;
        let outside_pole =
            if beside_pole { spot.is_passed_outside_at_pole(ray, [aimed, -aimed]) } else { None };
        let beyond =
            self.cut_off || residual > aimed && self.moved || outside_pole.unwrap_or(false);
        // Where the surface goes on in another piece, either is met, but neither covers everything.
        let inside_pole = || spot.is_passed_outside_at_pole(ray, [aimed; 2]) == Some(false);
        let cover = if beyond {
            Cover::Nothing
        } else if outside_pole.is_some() && !at_trims && inside_pole() {
            Cover::Whole // with trims, which may cut off any part of the sector, it is not known
        } else if beside_pole {
            Cover::Unknown
        } else if self.kept_whole && !at_border {
            Cover::Whole
        } else {
            Cover::Sector
        };
        if question.all_hits && at_border && stands_still(&spot, error) {
            // Which way the ray goes through the surface is not known.
            flags.insert(HitFlags::DOUBTFUL);
            cosine = 0.0;
        }
        let Spot { index, piece, st, jet } = spot;
        let stretch = match self.solution.proof {
            Proof::Stretch(z) => Some(z.map(|z| z * ray.t_from_z)),
            _ => None,
        };
        Meeting {
            t: z * ray.t_from_z,
            t_error: z_error * ray.t_from_z,
            z_error,
            surface: piece.surface,
            piece: index,
            st,
            jet,
            normal,
            flags,
            error,
            at_trims,
            edge,
            cosine,
            stretch,
            beyond,
            on_edge: self.on_edge,
            aimed,
            cover,
            place: 0,
        }
    }
}

/// The side of trims on which all is that a ray may meet that was aimed at a spot near their edge.
/// Errors along the ray are `longer` than across it.
fn aimed_side(leaf: &Leaf, spot: &Spot<'_>, ray: &RayFrame, longer: f64) -> Side {
    let Spot { piece, st, ref jet, .. } = *spot;
    let across = AIMED * rounding_at(jet.point, piece, ray);
    let along = across * longer;
    let reach = root_reach(jet, ray.axis, across, along);
    let side = piece.side_within(st, reach, AIMED_AT_TRIMS);
    // Beside a narrow strip, far along the ray, there may be other edges.
    let strip = KnownRoot { ray, error: across / TRIM_REACH, along: along / TRIM_REACH };
    match side {
        Side::Edge { .. } if strip.is_long() && !leaf.has_pole() => {
            strip.side(piece, st, jet).unwrap_or(side)
        }
        _ => side,
    }
}

/// A place on a closed piece within rounding of the ray.
struct OnRay<'a> {
    spot: Spot<'a>,
    /// Its distance along the ray, its distance from the ray, and the largest such distance
    /// allowed.
    z: f64,
    residual: f64,
    allowed: f64,
}

/// The place of a solution on the closed piece: a root a little outside counts as the nearest point
/// of the border.
///
/// # Errors
/// If that place is not within rounding of the ray.
fn on_ray<'a>(
    &PlacedLeaf { leaf, piece, .. }: &PlacedLeaf<'a>,
    ray: &RayFrame,
    solution: &Solution,
    known: Option<(Jet, f64)>,
) -> Result<OnRay<'a>, Dropped> {
    let error = piece.patch.error_bound(ray.magnitude);
    let st = on_piece(piece, ray, solution.st);
    let moved = st != solution.st;
    let (jet, z) = known.filter(|_| !moved).unwrap_or_else(|| {
        let jet = piece.patch.jet(st);
        (jet, ray.axis.dot(jet.point - ray.origin))
    });
    let residual = ray.distance(jet.point);
    let allowed = match solution.proof {
        Proof::Isolated(_) => error,
        Proof::Collapsed => AT_POLE * error,
        Proof::Contact(_) => 2.0 * error,
        Proof::Stretch(_) => AROUND * error,
    };
    if residual <= allowed {
        let spot = Spot { index: leaf.piece, piece, st, jet };
        return Ok(OnRay { spot, z, residual, allowed });
    }
    // Where floating-point parameters are too coarse, the root lies between two of them.
    let speed = jet.ds.length() * st.x + jet.dt.length() * st.y;
    let too_coarse = residual <= allowed + 4.0 * rounding::UNIT_ROUNDOFF * speed;
    let stretch = solution.proof.stretch();
    let unexplained = stretch.is_some() || !moved || too_coarse;
    let from = stretch.map_or(z, |[from, _]| from.min(z));
    Err(if unexplained { Dropped::from(from, ray) } else { Dropped::Surely })
}

/// Whether roots that may be this far apart along a ray can be said to be one: where the distance
/// is less than the leaf's slack. How far the root at the tip of a spike may be from there, nobody
/// knows.
fn is_short(leaf: &Leaf, reach: f64) -> bool {
    let [x, y] = leaf.half_side_lengths().map(f64::from);
    reach <= 2.0 * LEAF_SLACK * x.min(y)
}

/// Whether a ray through a pole may touch the surface there instead of crossing it.
///
/// With the radius of curvature R, the ray meets the surface again at the distance 2 R cos(N, d),
/// and in between is within R cos² / 2 of the surface. A leaf turns by less than its length over R.
fn may_touch(leaf: &Leaf, jet: &Jet, cosine: f64, error: f64) -> bool {
    let sides = leaf.rect().map(|[from, to]| to - from);
    let length = (sides[0] * jet.ds.length()).max(sides[1] * jet.dt.length());
    cosine * cosine * length <= CLEAR_OF_POLE * error
}

/// A leaf is met only by rays within this many errors of it: a stretch along which a ray runs
/// inside the leaf may be off by that much.
pub(crate) const AROUND: f64 = 4.0;

/// A root at a trim edge is doubtful if its error along the ray is more than this many times the
/// error across it, that is, if the ray is within 1e-5 of the tangent plane: the hit may be off the
/// edge by as much.
const EDGE_IN_DOUBT: f64 = 1e5;

/// Error bound along the ray of a root at `z`, given the error bound of its point.
fn error_along(proof: Proof, error: f64, (z, cosine): (f64, f64)) -> f64 {
    match proof {
        Proof::Isolated(_) | Proof::Collapsed => steep(error, cosine),
        // The ray may touch anywhere between, and the place was moved to where the surface is
        // nearest.
        Proof::Contact([from, to]) => (z - from).max(to - z).max(0.0) + error,
        // Ends are found to within `END` of the leaf; a stretch is longer than `STRETCH` of it.
        Proof::Stretch([from, to]) => 4.0 * error + END / STRETCH * (to - from).abs(),
    }
}

/// How far from a ray's start a solution may be and still be the root the ray starts on.
///
/// A contact is cut off where the leaf's slack ends: another leaf may have found what lies between
/// the contact and the start, which is no longer than the contact.
fn start_reach(proof: Proof, error: f64, z_error: f64, cosine: f64) -> f64 {
    match proof {
        Proof::Contact([from, to]) => z_error.max(steep(error, cosine).min(to - from + error)),
        _ => z_error,
    }
}

/// Error bound of a crossing along the ray.
fn steep(error: f64, cosine: f64) -> f64 {
    error / cosine.abs().max(f64::EPSILON)
}

/// Twice the distance from the surface, in errors, that a ray must reach between a pole and the
/// next root for the two to be told apart; with two errors and less they were seen as one.
const CLEAR_OF_POLE: f64 = 16.0;
