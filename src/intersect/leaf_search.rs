//! One leaf, one ray: what is found, and how it is known.

use glam::{DVec2, DVec4};

use super::borders::{at_border, error_bound, on_piece, rounding_at, trim_side};
use super::exact::{AT_POLE, END, Proof, Rect, STRETCH, Solution, Task};
use super::grazing::Known;
use super::kept_pole::Spot;
use super::meeting::{Findings, Meeting, Place, Question};
use super::newton::{Grounds, Newton, newton};
use super::{HitFlags, Root};
use crate::geometry::trim::Side;
use crate::math::{RayFrame, rounding};
use crate::patch::{CollapsedSide, Jet, LEAF_SLACK, Leaf, Passage, Piece, WIDENING};

/// The fast way: Newton where the leaf's certificate holds, else the exact solver.
///
/// Where the certificate holds there is at most one root in the widened leaf. If Newton
/// converges there, a second point with a residual below the error could only be within
/// `error·spread/cos` of it: well inside the slack. So the point found is the leaf's one
/// meeting if it lies in the leaf or its slack; if it lies outside, the leaf is proved to
/// be missed. It is also missed where a step from beyond the leaf surely leads farther away.
/// `z_limit` is how far along the ray anything is still of interest.
pub(super) fn search(
    question: &Question<'_>,
    place: &Place<'_>,
    passage: &Passage,
    z_limit: f64,
    findings: &mut Findings,
) {
    findings.statistics.leaf_tests += 1;
    let Place { leaf, oriented, piece } = *place;
    let ray = question.ray;
    let error = error_bound(piece, ray);

    if certified(place, ray, error) {
        let widened = leaf.widened(piece, WIDENING);
        let starts_here =
            question.from.is_some_and(|root| root.piece == leaf.piece && holds(widened, root.st));
        if starts_here {
            return; // the one root is the one the ray starts on
        }
        let start = first_guess(leaf, passage.middle);
        let wanted = leaf.widened(piece, LEAF_SLACK);
        let (axes, bend) = (oriented.unit_axes(), leaf.certificate.bend());
        let grounds = Grounds { domain: widened, wanted, axes, bend };
        let (end, steps) = newton(&piece.patch, ray, start, &grounds, error);
        findings.statistics.newton_iterations += u64::from(steps);
        match end {
            Newton::Converged { st, jet, z } => {
                if holds(wanted, st) {
                    let solution = Solution { st, proof: Proof::Isolated(widened) };
                    accept(question, place, &solution, Some((jet, z)), findings);
                }
                return;
            }
            Newton::Missed => return,
            Newton::Failed => {}
        }
    }
    search_exactly(question, place, z_limit, findings);
}

/// The exact way: all roots by subdivision, whatever the certificate says.
pub(super) fn search_exactly(
    question: &Question<'_>,
    place: &Place<'_>,
    z_limit: f64,
    findings: &mut Findings,
) {
    let Place { leaf, piece, .. } = *place;
    if findings.effort >= MOST_BOXES {
        findings.doubt_at(nearest_z(piece, question.ray) * question.ray.t_from_z);
        return;
    }
    let error = error_bound(piece, question.ray);
    let (rect, is_all) = searched(leaf, piece, error);
    if !is_all {
        findings.doubt_at(nearest_z(piece, question.ray) * question.ray.t_from_z);
    }
    let [z_min, z_max] = question.ray.z_range;
    let task = Task {
        patch: &piece.patch,
        rect,
        wanted: leaf.rect(),
        collapsed: leaf.collapsed(piece),
        ray: question.ray,
        error,
        z_range: [z_min, z_max.min(z_limit)],
    };
    let mut solutions = std::mem::take(&mut findings.solutions);
    solutions.clear();
    let before = findings.solver.boxes;
    findings.solver.solve(&task, &mut solutions);
    findings.statistics.exact_calls += 1;
    let boxes = findings.solver.boxes - before;
    findings.effort += boxes;
    findings.statistics.exact_boxes += boxes;
    clip_stretches(piece, question.ray, &mut solutions);
    for solution in &solutions {
        accept(question, place, solution, None, findings);
    }
    findings.solutions = solutions;
}

/// How many boxes the exact solver looks at for one ray before it leaves further leaves undecided,
/// which makes the answer doubtful: some tenth of a second's work. A ray through any surface that
/// is one takes some hundred; one that runs through many leaves inside a plane, some hundred for
/// each, and thousands for each of those around a pole that it passes closely: all its hits on a
/// disk have cost more than 2¹⁵. A surface that is folded flat onto itself, or is but a curve, may
/// take thousands for each of thousands.
const MOST_BOXES: u64 = 1 << 17;

/// The rectangle in which roots are searched for, and whether it holds all that count: the leaf and its slack,
/// and where the leaf ends at a side of its piece as much more as holds what points may be off by.
///
/// Far from the origin that may be more than the slack, or more than the leaf, about which nothing is known.
fn searched(leaf: &Leaf, piece: &Piece, error: f64) -> (Rect, bool) {
    let mut rect = leaf.widened(piece, LEAF_SLACK);
    let sides = leaf.rect();
    let middle = DVec2::from_array(sides.map(|[from, to]| 0.5 * (from + to)));
    let at_middle = piece.patch.point(middle);
    let mut is_all = true;
    for side in CollapsedSide::ALL {
        let (k, end) = (side.parameter(), side.end());
        if !side.is_reached_by(&sides) || leaf.collapsed(piece) == Some(side) {
            continue;
        }
        let half_side = piece.patch.point(side.beside(middle)).distance(at_middle);
        let part = BEYOND_SIDES * error / (2.0 * half_side);
        if part > LEAF_SLACK {
            is_all &= part <= 2.0 * FARTHEST_BEYOND;
            let [from, to] = sides[k];
            let more = part.min(FARTHEST_BEYOND) * (to - from);
            rect[k][end] = if end == 0 { from - more } else { to + more };
        }
    }
    (rect, is_all)
}

/// So many errors beyond a side of a piece are searched, twice as far as roots are wanted: they are as far from it
/// as the ray passes, over the sine of its angle with the surface.
const BEYOND_SIDES: f64 = 16.0;

/// But no farther than so many sides of the leaf. Where a point may be off by half of that, it is doubtful whether
/// the leaf is met.
const FARTHEST_BEYOND: f64 = 2.0;

/// No point of a piece is met before this: the least of its control points.
fn nearest_z(piece: &Piece, ray: &RayFrame) -> f64 {
    let z = |c: DVec4| ray.axis.dot(c.truncate() / c.w - ray.origin);
    let nearest = piece.patch.control().map(z).fold(f64::INFINITY, f64::min);
    (nearest - error_bound(piece, ray)).max(ray.z_range[0])
}

/// Cuts stretches that reach into the slack beyond the piece down to the part on the piece.
/// What is left where nothing was on it is the contact of one point of the border.
fn clip_stretches(piece: &Piece, ray: &RayFrame, solutions: &mut [Solution]) {
    let is_stretch = |solution: &Solution| matches!(solution.proof, Proof::Stretch(_));
    // The solver reports both ends of a stretch, one after the other.
    for ends in solutions.chunk_by_mut(|a, b| a.proof == b.proof) {
        for pair in ends.chunks_exact_mut(2).filter(|pair| pair.iter().all(is_stretch)) {
            pair.iter_mut().for_each(|end| end.st = on_piece(piece, ray, end.st));
            let [from, to] =
                [0, 1].map(|k| ray.axis.dot(piece.patch.point(pair[k].st) - ray.origin));
            let proof = if from < to {
                Proof::Stretch([from, to])
            } else {
                Proof::Contact { length: from - to }
            };
            pair.iter_mut().for_each(|end| end.proof = proof);
        }
    }
}

/// Whether the leaf's certificate speaks of this ray, and rounding is small against the
/// leaf.
fn certified(place: &Place<'_>, ray: &RayFrame, error: f64) -> bool {
    let certificate = &place.leaf.certificate;
    let slopes = place.oriented.directions().map(|row| row.dot(ray.axis));
    let Some(steepness) = certificate.speaks_of(slopes, error) else { return false };
    place.leaf.pole(place.piece).is_none_or(|pole| {
        let distance = ray.coordinates(pole).truncate().length();
        error * f64::from(certificate.pole_per_error()) <= steepness * distance
    })
}

pub(super) fn holds(rect: Rect, st: DVec2) -> bool {
    (0..2).all(|k| rect[k][0] <= st[k] && st[k] <= rect[k][1])
}

/// Box coordinates run from −1 to 1 along the leaf's parameters.
fn first_guess(leaf: &Leaf, middle: DVec2) -> DVec2 {
    let at = |[from, to]: [f64; 2], x: f64| 0.5 * ((from + to) + x * (to - from));
    let [s, t] = leaf.rect();
    DVec2::new(at(s, middle.x), at(t, middle.y))
}

/// Makes a meeting of a solution that lies on the piece and in the ray's range.
fn accept(
    question: &Question<'_>,
    place: &Place<'_>,
    solution: &Solution,
    known: Option<(Jet, f64)>,
    findings: &mut Findings,
) {
    let Place { leaf, piece, .. } = *place;
    let ray = question.ray;
    let error = error_bound(piece, ray);

    // The piece is closed: a root a little outside counts as the nearest point of the
    // border, if that is within rounding of the ray.
    let mut st = on_piece(piece, ray, solution.st);
    let (mut jet, mut z) = match known {
        Some(known) if st == solution.st => known,
        _ => {
            let jet = piece.patch.jet(st);
            (jet, ray.axis.dot(jet.point - ray.origin))
        }
    };
    let nearest = st;
    let residual = ray.coordinates(jet.point).truncate().length();
    let (allowed, mut flags) = match solution.proof {
        Proof::Isolated(_) => (error, HitFlags::NONE),
        Proof::Collapsed => (AT_POLE * error, HitFlags::NONE),
        Proof::Contact { .. } => (2.0 * error, HitFlags::DOUBTFUL),
        Proof::Stretch(_) => (4.0 * error, HitFlags::DOUBTFUL.with(HitFlags::INSIDE)),
    };
    if residual > allowed {
        // Where parameters are too coarse, the root lies between two of them.
        let speed = jet.ds.length() * st.x + jet.dt.length() * st.y;
        let too_coarse =
            st == solution.st || residual <= allowed + 4.0 * rounding::UNIT_ROUNDOFF * speed;
        if solution.proof_is_open() || too_coarse {
            findings.doubt_at(z * ray.t_from_z);
        }
        return;
    }

    let mut normal = piece.normal(st, &jet);
    let mut cosine = normal.map_or(0.0, |normal| normal.dot(ray.axis));
    if solution.proof == Proof::Collapsed && may_touch(leaf, &jet, cosine, error) {
        flags.insert(HitFlags::DOUBTFUL);
    }
    let z_error = error_along(solution.proof, error, cosine);

    // What trims cut off is not there; their edges are. In a pole is what any kept parameter
    // leads to.
    let (mut piece, mut piece_index) = (piece, leaf.piece);
    let known = Known { ray, error, along: z_error };
    match trim_side(leaf, piece, (st, &jet), &known) {
        Side::Inside => {}
        Side::Edge { inside, .. } => {
            flags.insert(HitFlags::TRIM_EDGE);
            let spot = Spot { index: piece_index, piece, st, jet };
            let pole = leaf.collapsed(piece).filter(|_| !inside);
            let kept = pole.and_then(|side| spot.kept(question.set, side, (ray, allowed)));
            if let Some(kept) = kept {
                Spot { index: piece_index, piece, st, jet } = kept;
                z = ray.axis.dot(jet.point - ray.origin);
                normal = piece.normal(st, &jet);
                cosine = normal.map_or(0.0, |normal| normal.dot(ray.axis));
            }
        }
        Side::Outside => {
            // The ray may run on inside the surface to where that is kept.
            if matches!(solution.proof, Proof::Stretch(_)) {
                findings.doubt_at(z.max(ray.z_range[0]) * ray.t_from_z);
            }
            return;
        }
    }

    // The root the ray starts on is not met again.
    if let Some((root, start)) = question.start_on(piece.surface) {
        let reach = z_error + root.error;
        if z.abs() <= reach && jet.point.distance(start.patch.point(root.st)) <= 2.0 * reach {
            // Where the ray may touch a pole, the root behind or ahead is the next one, or none.
            let touches = flags.contains(HitFlags::DOUBTFUL);
            if touches || !is_same_root(solution.proof, leaf, (root, start), reach) {
                findings.doubt_at(0.0);
            }
            return;
        }
    }

    let border = at_border(piece, st, &jet, error);
    let edge = border || flags.contains(HitFlags::TRIM_EDGE);
    let start_reach = question.from.map_or(f64::NEG_INFINITY, |root| z_error + root.error);
    if edge
        && flags.without(HitFlags::TRIM_EDGE).is_empty()
        && z.abs() <= start_reach
        && question.starts_on_edge_at(jet.point, cosine, z_error)
    {
        return;
    }

    let t = z * ray.t_from_z;
    let t_error = z_error * ray.t_from_z;
    let [t_min, t_max] = question.t_range;
    let undecided = [t_min, t_max].iter().any(|end| (t - end).abs() <= t_error);
    if !(t > t_min && t < t_max) {
        if undecided {
            findings.doubt_at(t.max(t_min));
        }
        return;
    }
    let edge_in_doubt = flags.contains(HitFlags::TRIM_EDGE) && z_error > EDGE_IN_DOUBT * error;
    if undecided || edge_in_doubt {
        flags.insert(HitFlags::DOUBTFUL);
    }
    if border {
        flags.insert(HitFlags::BORDER);
    }
    let stretch = match solution.proof {
        Proof::Stretch(z) => Some(z.map(|z| z * ray.t_from_z)),
        _ => None,
    };
    let beyond = nearest != solution.st && residual > AIMED * rounding_at(jet.point, piece, ray);
    let (surface, piece) = (piece.surface, piece_index);
    findings.meetings.push(Meeting {
        t,
        t_error,
        z_error,
        surface,
        piece,
        st,
        jet,
        normal,
        flags,
        error,
        cosine,
        stretch,
        beyond,
    });
}

/// Whether a ray through a pole may as well touch the surface there as cross it.
///
/// Where the radius of curvature is R, it meets the surface again 2 R cos(N, d) from there, and in
/// between is within R cos² / 2 of it. A leaf turns by less than its length over R.
fn may_touch(leaf: &Leaf, jet: &Jet, cosine: f64, error: f64) -> bool {
    let sides = leaf.rect().map(|[from, to]| to - from);
    let length = (sides[0] * jet.ds.length()).max(sides[1] * jet.dt.length());
    cosine * cosine * length <= CLEAR_OF_POLE * error
}

/// Where a ray meets a trim edge at so small an angle that its root is known along the ray to this many
/// errors only, at 1e-5 from the tangent plane, it is doubtful: what is shown may be off the edge by as much.
const EDGE_IN_DOUBT: f64 = 1e5;

/// How far off a root may be along the ray, for how far a point may be from it.
fn error_along(proof: Proof, error: f64, cosine: f64) -> f64 {
    let steep = error / cosine.abs().max(f64::EPSILON);
    match proof {
        Proof::Isolated(_) | Proof::Collapsed => steep,
        Proof::Contact { length } => steep.min(length + error),
        // Ends are found to within a part of the leaf; a stretch is longer than `STRETCH` of it.
        Proof::Stretch([from, to]) => 4.0 * error + END / STRETCH * (to - from).abs(),
    }
}

/// Whether what was found where a ray starts is proved to be the root it starts on. On another
/// piece it is that root only if the ray starts within twice `reach` of a side: a surface that crosses
/// itself has two roots there.
fn is_same_root(proof: Proof, leaf: &Leaf, (root, start): (&Root, &Piece), reach: f64) -> bool {
    let at_side = || {
        let distances = start.side_distances(root.st, &start.patch.jet(root.st));
        distances.into_iter().any(|distance| distance <= 2.0 * reach)
    };
    match proof {
        Proof::Isolated(rect) if root.piece == leaf.piece => holds(rect, root.st),
        Proof::Isolated(_) => at_side(),
        Proof::Collapsed => true,
        Proof::Contact { .. } | Proof::Stretch(_) => false,
    }
}

/// How far from the surface, in errors, a ray must be between a pole and the next root for the two
/// to be told apart: half of this; with two errors and less they were seen as one.
const CLEAR_OF_POLE: f64 = 16.0;

/// A ray aimed at a point of a border passes it by no more than this part of what rounding may
/// do there: 0.1 is the most that was seen.
const AIMED: f64 = 0.25;

impl Solution {
    /// Whether a miss would not be proved by the solution's own box.
    fn proof_is_open(&self) -> bool {
        matches!(self.proof, Proof::Contact { .. } | Proof::Stretch(_))
    }
}
