//! What becomes of a solution: a meeting, a doubt, or nothing.

mod leave;

use glam::{DVec2, DVec3};

use super::borders::{at_border, on_piece};
use super::grazing::KnownRoot;
use super::meeting::{Cover, Meeting, Stretch, TrimCurve};
use super::placed_leaf::PlacedLeaf;
use super::pole_side::stands_still;
use super::question::Question;
use super::reach::{
    AIMED, AIMED_AT_TRIMS, TRIM_REACH, TRIM_SPARE, root_reach, rounding_at, trim_reach,
};
use super::spot::Spot;
use super::trim_side::trim_side;
use crate::geometry::trim::Side;
use crate::intersect::HitFlags;
use crate::intersect::exact::{AT_CONTACT, AT_POLE, END, Evidence, STRETCH, Solution};
use crate::intersect::hit::SPARE;
use crate::math::{RayFrame, rounding};
use crate::patch::{Jet, Leaf};

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
    placed: &PlacedLeaf<'_>,
    solution: &Solution,
    known: Option<(Jet, f64)>,
) -> Result<Meeting, Dropped> {
    let on_ray = on_ray(placed, question.ray, solution, known)?;
    let mut candidate = Candidate::new(question, placed.leaf, solution, on_ray);
    candidate.keep_to_trims()?;
    if candidate.may_be_in_range() {
        candidate.leave_start()?;
        candidate.leave_edge()?;
    }
    candidate.stay_in_range()?;
    if candidate.trims == AtTrims::JustCutOff {
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
    trims: AtTrims,
}

/// Where trims leave a place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum AtTrims {
    /// Inside, far from their edges.
    Inside,
    /// At a [trim curve](TrimCurve), to within this distance in space.
    Edge { distance: f64, kept: KeptAround },
    /// Cut off for certain, but so near to an edge that another search may have found the place
    /// there.
    JustCutOff,
}

impl AtTrims {
    /// How far the edge may be that the place is at, and what is kept there; `None` elsewhere.
    fn edge(self) -> Option<(f64, KeptAround)> {
        match self {
            Self::Edge { distance, kept } => Some((distance, kept)),
            Self::Inside | Self::JustCutOff => None,
        }
    }
}

/// What trims keep around a place at their edge, of all that a ray may meet there that was aimed at
/// the same point and is off it by rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KeptAround {
    Nothing,
    All,
    /// The edge passes there: see [`TrimCurve::on_either_side`].
    Part,
    /// Not asked, or judged otherwise than the place itself.
    Unknown,
}

impl<'a> Candidate<'a> {
    fn new(
        question: &'a Question<'a>,
        leaf: &'a Leaf,
        solution: &'a Solution,
        on_ray: OnRay<'a>,
    ) -> Self {
        let (ray, evidence) = (question.ray, solution.evidence);
        let Spot { piece, st, .. } = on_ray.spot;
        let error = piece.patch.error_bound(ray.magnitude);
        let flags = match evidence {
            Evidence::Isolated(_) | Evidence::Collapsed => HitFlags::NONE,
            Evidence::Contact(_) => HitFlags::DOUBTFUL,
            Evidence::Stretch { .. } => HitFlags::DOUBTFUL.with(HitFlags::INSIDE),
        };
        let mut candidate = Self {
            question,
            leaf,
            solution,
            on_ray,
            error,
            z_error: error,
            normal: None,
            cosine: 0.0,
            flags,
            moved: st != solution.st,
            trims: AtTrims::Inside,
        };
        candidate.measure();
        candidate
    }

    /// Measures how steeply the ray meets the surface at the place, and so how far off the place
    /// may be along the ray.
    fn measure(&mut self) {
        let Self { question, leaf, error, .. } = *self;
        let OnRay { ref spot, z, .. } = self.on_ray;
        let (ray, evidence) = (question.ray, self.solution.evidence);
        (self.normal, self.cosine) = spot.normal_along(ray);
        if matches!(evidence, Evidence::Contact(_)) && !spot.has_one_side(ray, self.cosine, error) {
            self.cosine = 0.0;
        }
        if evidence == Evidence::Collapsed && may_touch_at_pole(leaf, &spot.jet, self.cosine, error)
        {
            self.flags.insert(HitFlags::DOUBTFUL);
        }
        self.z_error = error_along(evidence, error, (z, self.cosine));
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
                if piece.is_cut_within(spot.st, trim_reach(&spot.jet, z_error)) {
                    self.flags.insert(HitFlags::TRIM_EDGE);
                }
                let speeds = DVec2::new(spot.jet.ds.length(), spot.jet.dt.length());
                // At a pole a parameter may be anything: a distance that is not finite says
                // nothing.
                let off = (distance / piece.lengths()).dot(speeds);
                let distance = if off.is_finite() { off } else { 0.0 };
                let pole = leaf.collapsed(piece).filter(|_| !inside);
                let place = pole.and_then(|side| spot.kept(question.set, side, (ray, allowed)));
                let mut kept = KeptAround::Unknown;
                if let Some(place) = place {
                    self.on_ray = OnRay::new(place, ray, allowed);
                    self.measure();
                } else if question.all_hits {
                    kept = match aimed_side(leaf, spot, ray, z_error / error) {
                        Side::Outside if !inside => KeptAround::Nothing,
                        Side::Inside if inside => KeptAround::All,
                        Side::Edge { .. } if self.flags.contains(HitFlags::TRIM_EDGE) => {
                            KeptAround::Part
                        }
                        _ => KeptAround::Unknown,
                    };
                }
                self.trims = AtTrims::Edge { distance, kept };
            }
            // The ray may run on inside the surface to a part that is kept.
            Side::Outside if matches!(self.solution.evidence, Evidence::Stretch { .. }) => {
                return Err(Dropped::from(z, ray));
            }
            Side::Outside if question.all_hits => {
                let known =
                    KnownRoot { ray, error: TRIM_SPARE * error, along: TRIM_SPARE * z_error };
                let side = trim_side(leaf, piece, (spot.st, &spot.jet), &known);
                if !matches!(side, Side::Edge { .. }) {
                    return Err(Dropped::Surely);
                }
                self.trims = AtTrims::JustCutOff;
            }
            Side::Outside => return Err(Dropped::Surely),
        }
        Ok(())
    }

    /// Whether the place may lie in the ray's range, given how far off both it and the ray's start
    /// may be.
    fn may_be_in_range(&self) -> bool {
        let start_off = self.question.from.map_or(0.0, |root| root.error);
        let off = SPARE * self.z_error + start_off;
        let [t, t_off] = [self.on_ray.z, off].map(|z| z * self.question.ray.t_from_z);
        let [t_min, t_max] = self.question.t_range;
        t + t_off >= t_min && t - t_off <= t_max
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
        if undecided || (self.trims.edge().is_some() && is_flat) {
            self.flags.insert(HitFlags::DOUBTFUL);
        }
        Ok(())
    }

    /// Whether the place is at a border, if it may be off by `more` than its error.
    fn is_at_border(&self, more: f64) -> bool {
        let Spot { piece, st, ref jet, .. } = self.on_ray.spot;
        at_border(piece, st, jet, self.error + more)
    }

    /// What the piece covers around the ray, and whether the ray passes beyond it; see [`Meeting`].
    /// A ray passes within `aimed` of the places it was aimed at.
    fn cover(&self, aimed: f64, at_border: bool) -> (Cover, bool) {
        let OnRay { ref spot, residual, .. } = self.on_ray;
        let ray = self.question.ray;
        let edge = self.trims.edge();
        let (at_trims, kept) = (edge.is_some(), edge.map_or(KeptAround::Unknown, |(_, kept)| kept));
        let is_off = residual > aimed;
        let beside_pole = is_off && self.solution.evidence == Evidence::Collapsed;
        let outside_pole =
            if beside_pole { spot.is_passed_outside_at_pole(ray, [aimed, -aimed]) } else { None };
        let beyond =
            kept == KeptAround::Nothing || is_off && self.moved || outside_pole.unwrap_or(false);
        // Where the surface goes on in another piece, either is met, but neither covers everything.
        let inside_pole = || spot.is_passed_outside_at_pole(ray, [aimed; 2]) == Some(false);
        let cover = if beyond {
            Cover::Nothing
        } else if outside_pole.is_some() && !at_trims && inside_pole() {
            Cover::Whole // with trims, which may cut off any part of the sector, it is not known
        } else if beside_pole {
            Cover::Unknown
        } else if kept == KeptAround::All && !at_border {
            Cover::Whole
        } else {
            Cover::Sector
        };
        (cover, beyond)
    }

    fn meeting(self) -> Meeting {
        let at_border = self.is_at_border(0.0);
        let aimed = AIMED
            * rounding_at(self.on_ray.spot.jet.point, self.on_ray.spot.piece, self.question.ray);
        let (cover, beyond) = self.cover(aimed, at_border);
        let Self { question, on_ray, error, z_error, normal, mut cosine, mut flags, .. } = self;
        let OnRay { spot, z, .. } = on_ray;
        let ray = question.ray;
        if at_border {
            flags.insert(HitFlags::BORDER);
        }
        if question.all_hits && at_border && stands_still(&spot, error) {
            // Which way the ray goes through the surface is not known.
            flags.insert(HitFlags::DOUBTFUL);
            cosine = 0.0;
        }
        let trim_curve = self.trims.edge().map(|(off, kept)| {
            let on_either_side = kept == KeptAround::Part;
            TrimCurve { off, on_either_side }
        });
        let Spot { index, piece, st, jet } = spot;
        let stretch = match self.solution.evidence {
            Evidence::Stretch { z, end } => Some(Stretch { t: z.map(|z| z * ray.t_from_z), end }),
            _ => None,
        };
        Meeting {
            t: z * ray.t_from_z,
            z_error,
            t_from_z: ray.t_from_z,
            surface: piece.surface,
            piece: index,
            st,
            jet,
            normal,
            flags,
            error,
            trim_curve,
            cosine,
            stretch,
            beyond,
            aimed,
            cover,
            place: None,
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

impl<'a> OnRay<'a> {
    fn new(spot: Spot<'a>, ray: &RayFrame, allowed: f64) -> Self {
        let point = spot.jet.point;
        let (z, residual) = (ray.axis.dot(point - ray.origin), ray.distance(point));
        Self { spot, z, residual, allowed }
    }
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
    let allowed = match solution.evidence {
        Evidence::Isolated(_) => error,
        Evidence::Collapsed => AT_POLE * error,
        Evidence::Contact(_) => AT_CONTACT * error,
        Evidence::Stretch { .. } => AROUND * error,
    };
    if residual <= allowed {
        let spot = Spot { index: leaf.piece, piece, st, jet };
        return Ok(OnRay { spot, z, residual, allowed });
    }
    // Where floating-point parameters are so coarse that the ray may pass the border near enough to
    // meet it, the nearest point of the border lies between two of them.
    let speed = jet.ds.length() * st.x + jet.dt.length() * st.y;
    let too_coarse = residual <= MET * allowed + 4.0 * rounding::UNIT_ROUNDOFF * speed;
    let stretch = solution.evidence.open_range();
    let unexplained = stretch.is_some() || !moved || too_coarse;
    let from = stretch.map_or(z, |[from, _]| from.min(z));
    Err(if unexplained { Dropped::from(from, ray) } else { Dropped::Surely })
}

/// A ray that passes a border within this part of the largest distance allowed meets it for certain,
/// or is in doubt.
const MET: f64 = 0.5;

/// Whether a ray through a pole may touch the surface there instead of crossing it.
///
/// With the radius of curvature R, the ray meets the surface again at the distance 2 R cos(N, d),
/// and in between is within R cos² / 2 of the surface. Leaves are made to turn by less than a
/// radian, so R is taken to be no less than the leaf's length. (A tip finer than the smallest leaf
/// is not seen.)
fn may_touch_at_pole(leaf: &Leaf, jet: &Jet, cosine: f64, error: f64) -> bool {
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
fn error_along(evidence: Evidence, error: f64, (z, cosine): (f64, f64)) -> f64 {
    match evidence {
        Evidence::Isolated(_) | Evidence::Collapsed => steep(error, cosine),
        // The ray may touch anywhere between, and the place was moved to where the surface is
        // nearest.
        Evidence::Contact([from, to]) => (z - from).max(to - z).max(0.0) + error,
        // Ends are found to within `END` of the leaf; a stretch is longer than `STRETCH` of it.
        Evidence::Stretch { z: [from, to], .. } => {
            AROUND * error + END / STRETCH * (to - from).abs()
        }
    }
}

/// Error bound of a crossing along the ray.
fn steep(error: f64, cosine: f64) -> f64 {
    error / cosine.abs().max(f64::EPSILON)
}

/// Twice the distance from the surface, in errors, that a ray must reach between a pole and the
/// next root for the two to be told apart; with two errors and less they were seen as one.
const CLEAR_OF_POLE: f64 = 16.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact is somewhere between two ends, wherever its place was moved to, as to a border: none
    /// of them is farther from the place than the error says.
    #[test]
    fn the_error_of_a_contact_reaches_both_of_its_ends() {
        let [from, to] = [0.25, 1.0];
        for z in [-3.0, 0.0, 0.25, 0.5, 0.75, 1.0, 2.0] {
            for cosine in [0.0, 1e-9, 1.0] {
                let reach = error_along(Evidence::Contact([from, to]), 1e-3, (z, cosine));
                assert!(z - reach < from && z + reach > to, "{z}, {cosine}: {reach}");
            }
        }
    }
}
