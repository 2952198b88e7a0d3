//! The search of one leaf by one ray: what is found, and how it is known.

use glam::DVec2;

use super::findings::Findings;
use super::hull::Hull;
use super::newton::{CertifiedLeaf, Newton, newton};
use crate::geometry::RectSide;
use crate::intersect::exact::{End, Evidence, Found, Problem, Solution};
use crate::intersect::roots::accept::{AROUND, Dropped, accept};
use crate::intersect::roots::borders::on_piece;
use crate::intersect::roots::placed_leaf::PlacedLeaf;
use crate::intersect::roots::question::Question;
use crate::math::RayFrame;
use crate::patch::{LEAF_SLACK, Leaf, Passage, Piece, StRect, WIDENING, holds};

/// Searches a leaf the fast way: by Newton where the leaf's certificate holds, else by the exact
/// solver.
///
/// Where the certificate holds there is at most one root in the widened leaf. If Newton
/// converges there, a second point with a residual below the error could only be within twice
/// `error·spread/cos` of the first: just inside the slack, which certificates leave room for. So
/// the point found is the leaf's only meeting if it lies in the leaf or its slack; if it lies
/// outside, the leaf is proved to be missed. The leaf is also missed where a step from beyond it
/// surely leads farther away.
///
/// `z_limit` is the distance along the ray up to which anything is of interest.
pub(crate) fn search(
    question: &Question<'_>,
    placed: &PlacedLeaf<'_>,
    passage: &Passage,
    z_limit: f64,
    findings: &mut Findings,
) {
    findings.statistics.leaf_tests += 1;
    let PlacedLeaf { leaf, oriented, piece } = *placed;
    let ray = question.ray;
    let error = piece.patch.error_bound(ray.magnitude);

    if certified(placed, ray, error) {
        let widened = leaf.widened(piece, WIDENING);
        let starts_here =
            question.from.is_some_and(|root| root.piece == leaf.piece && holds(widened, root.st));
        if starts_here {
            return; // the one root is the one the ray starts on
        }
        let start = first_guess(leaf, passage.middle);
        let wanted = leaf.widened(piece, LEAF_SLACK);
        let (axes, tilts) = (oriented.unit_axes(), leaf.certificate.tilts());
        let certified_leaf = CertifiedLeaf { domain: widened, wanted, axes, tilts };
        let (end, steps) = newton(&piece.patch, ray, start, &certified_leaf, error);
        findings.statistics.newton_iterations += u64::from(steps);
        match end {
            Newton::Converged { st, jet, z } => {
                if holds(wanted, st) {
                    let solution = Solution { st, evidence: Evidence::Isolated(widened) };
                    findings.add(accept(question, placed, &solution, Some((jet, z))));
                }
                return;
            }
            Newton::Missed => return,
            Newton::Failed => {}
        }
    }
    // A search may reach a leaf whose box the ray meets though the ray misses the boxes around it:
    // a packet does so on behalf of other rays. So what is searched, and doubted, depends on the
    // leaf alone, not on how it was reached.
    if let Some(from) = met_from(placed, passage, ray) {
        search_exactly(question, placed, Some(from), z_limit, findings);
    }
}

/// Searches a leaf the exact way: all roots by subdivision, whatever the certificate says.
/// `nearest_z` is the result of [`met_from`]: if it is `None`, only proved roots count.
///
/// Doubt arises in three ways: from a solution that cannot be decided; from a stretch of which
/// neither end counts; and, if nothing is met, from a leaf that was not searched entirely, or whose
/// stretches were moved out of the ray's range.
pub(crate) fn search_exactly(
    question: &Question<'_>,
    placed: &PlacedLeaf<'_>,
    nearest_z: Option<f64>,
    z_limit: f64,
    findings: &mut Findings,
) {
    let (ray, piece) = (question.ray, placed.piece);
    if findings.effort >= MOST_EFFORT {
        if let Some(z) = nearest_z {
            findings.doubt_at(z * ray.t_from_z);
        }
        return;
    }
    let (problem, holds_all) = pose(placed, ray, z_limit);
    let mut found = findings.solve(&problem, cost_of_box(piece.patch.degree()));
    let is_proved = |found: &Found| found.evidence().is_proof();
    if nearest_z.is_none() {
        // In the slack, weights may vanish and the surface may be anywhere.
        found.retain(is_proved);
    }
    let open_z = found.iter().filter_map(|found| open_from(found.evidence(), &problem));
    let open_z = open_z.fold(f64::INFINITY, f64::min);
    clip_stretches(piece, ray, &mut found);

    let (is_met, mut doubt) = accept_all(question, placed, &problem, &found, findings);
    if !is_met {
        if let Some(z) = nearest_z.filter(|_| !holds_all && !found.iter().any(is_proved))
            && (!found.is_empty()
                || passes_near(&problem, cost_of_box(piece.patch.degree()), findings))
        {
            doubt = doubt.min(z * ray.t_from_z);
        }
        // The places that stand for a stretch may have been moved out of the ray's range, far from
        // the origin.
        doubt = doubt.min(open_z * ray.t_from_z);
    }
    // No part of the leaf is nearer.
    findings.doubt_at(nearest_z.map_or(doubt, |z| doubt.max(z * ray.t_from_z)));
    findings.found = found;
}

/// Adds what is met of all that was found on a leaf. Returns whether anything is, and the smallest
/// ray parameter at which something may have been missed.
fn accept_all(
    question: &Question<'_>,
    placed: &PlacedLeaf<'_>,
    problem: &Problem<'_>,
    found: &[Found],
    findings: &mut Findings,
) -> (bool, f64) {
    let (mut any, mut doubt) = (false, f64::INFINITY);
    for found in found {
        let mut is_met = false;
        for solution in found.solutions() {
            match accept(question, placed, solution, None) {
                Ok(meeting) => {
                    findings.meetings.push(meeting);
                    is_met = true;
                }
                Err(Dropped::InDoubt(t)) => doubt = doubt.min(t),
                Err(Dropped::Surely) => {}
            }
        }
        // Both ends of a stretch may lie outside the ray's range, and the range between them.
        let evidence = found.evidence();
        if !is_met
            && matches!(evidence, Evidence::Stretch { .. })
            && let Some(z) = open_from(evidence, problem)
        {
            doubt = doubt.min(z * question.ray.t_from_z);
        }
        any |= is_met;
    }
    (any, doubt)
}

/// Whether the ray, within its range of interest, may pass the leaf within [`AROUND`] errors. Its
/// control points' hull tells less: that of a leaf which is next to a line, as beside the crest of
/// a crease, holds all that lies between the line and its chords.
fn passes_near(problem: &Problem<'_>, cost_of_box: u64, findings: &mut Findings) -> bool {
    if findings.effort >= MOST_EFFORT {
        return true;
    }
    // The solver discards what is half its error away, or more where weights differ.
    let near = Problem { error: 2.0 * AROUND * problem.error, ..*problem };
    let places = findings.solve(&near, cost_of_box);
    let any = !places.is_empty();
    findings.found = places;
    any
}

/// The problem of finding all roots of a ray on a leaf, as far as `z_limit` along the ray, and
/// whether these are all that count.
fn pose<'a>(
    &PlacedLeaf { leaf, piece, .. }: &PlacedLeaf<'a>,
    ray: &'a RayFrame,
    z_limit: f64,
) -> (Problem<'a>, bool) {
    let error = piece.patch.error_bound(ray.magnitude);
    let (rect, holds_all) = searched_rect(leaf, piece, error);
    let [z_min, z_max] = ray.z_range;
    let problem = Problem {
        patch: &piece.patch,
        rect,
        wanted: leaf.rect(),
        collapsed: leaf.collapsed(piece),
        ray,
        error,
        z_range: [z_min, z_max.min(z_limit)],
    };
    (problem, holds_all)
}

/// The distance along the ray from which on it may meet a leaf, or pass it within rounding: not
/// before it enters the leaf's box, nor before the nearest control point. `None` if the ray passes
/// by the control points' hull.
pub(crate) fn met_from(placed: &PlacedLeaf<'_>, passage: &Passage, ray: &RayFrame) -> Option<f64> {
    let (hull, error) =
        (Hull::of(placed.leaf, placed.piece, ray), placed.piece.patch.error_bound(ray.magnitude));
    let nearest = hull.nearest_z().max(passage.entry) - error;
    (!hull.is_passed_by(AROUND * error)).then_some(nearest.max(ray.z_range[0]))
}

/// How many boxes the exact solver looks at for one ray, on bicubic surfaces, before it leaves
/// further leaves undecided, which makes the answer doubtful: about a tenth of a second of work. A
/// ray through any proper surface takes about a hundred. A ray that runs inside a plane through
/// many leaves takes about a hundred for each, and thousands for each leaf around a pole that it
/// passes closely: all hits of one on a disk have cost more than 2¹⁵. A surface that is folded flat
/// onto itself, or is only a curve, may take thousands of boxes for each of thousands of leaves.
const MOST_EFFORT: u64 = 1 << 17;

/// The cost of one box, in boxes of bicubic surfaces: from how often two control points are mixed
/// to cut the net down to the box. At degrees around 30, [`MOST_EFFORT`] boxes would take ten
/// seconds and more. But no box counts as more than 16, so that any ray may use as many boxes as
/// the most difficult leaf may take, searched twice.
fn cost_of_box([p, q]: [usize; 2]) -> u64 {
    let mixes = |[p, q]: [usize; 2]| ((p + 1) * (q + 1) * (p + q)) as u64;
    (mixes([p, q]) / mixes([3, 3])).clamp(1, 16)
}

/// The rectangle in which roots are searched for, and whether it holds all roots that count. It is
/// the leaf with its slack; where the leaf ends at a side of its piece, it reaches beyond the side
/// by as much as points may be off.
///
/// Far from the origin that may be more than the slack, or even than the leaf; as
/// [`FARTHEST_BEYOND`] limits it, roots that count may lie farther out.
fn searched_rect(leaf: &Leaf, piece: &Piece, error: f64) -> (StRect, bool) {
    let mut rect = leaf.widened(piece, LEAF_SLACK);
    let sides = leaf.rect();
    let middle = DVec2::from_array(sides.map(|[from, to]| 0.5 * (from + to)));
    let mut holds_all = true;
    for side in RectSide::ALL {
        let fixed = side.fixed();
        if !side.is_reached_by(&sides) || leaf.collapsed(piece) == Some(side) {
            continue;
        }
        // What is searched beyond the side, as a part of the leaf's side, across a place of the
        // leaf.
        let part = |place: DVec2| {
            let half_side =
                piece.patch.point(side.beside(place)).distance(piece.patch.point(place));
            BEYOND_SIDES * error / (2.0 * half_side)
        };
        let in_middle = part(middle);
        if in_middle > LEAF_SLACK {
            let farthest = FARTHEST_BEYOND / piece.patch.degree()[fixed] as f64;
            // A surface that crosses itself has no length in one place, but is long at both ends of
            // the side. A ray that passes within rounding of that place meets the surface there.
            let is_short = |across: f64| {
                let mut place = middle;
                place[side.along()] = across;
                part(place) > 4.0 * farthest
            };
            holds_all &=
                in_middle <= 4.0 * farthest || !sides[side.along()].into_iter().any(is_short);
            let [from, to] = sides[fixed];
            let more = in_middle.min(farthest) * (to - from);
            rect[fixed][side.end()] = if side.is_last() { to + more } else { from - more };
        }
    }
    (rect, holds_all)
}

/// How many errors beyond a side of a piece are searched: twice as far as roots are wanted. A root
/// is as far from the side as the ray passes it, over the sine of the ray's angle with the surface.
const BEYOND_SIDES: f64 = 16.0;

/// The search reaches beyond a side by at most this part of the leaf's side, over the degree:
/// rounding errors of control points grow there by the power of the degree, to 1.6 times at a
/// corner. Where half of that reach is less than twice the error bound of points, in the middle of
/// the side and at one of its ends, and nothing is found, it is doubtful whether the leaf is met.
const FARTHEST_BEYOND: f64 = 0.125;

/// The distance from which on a ray may meet something that is known only to lie along a stretch of
/// the ray; `None` for a proved root, or a stretch outside the range of interest.
fn open_from(evidence: Evidence, problem: &Problem<'_>) -> Option<f64> {
    let ([from, to], [z_min, z_max]) = (evidence.open_range()?, problem.z_range);
    (from <= z_max && to >= z_min).then_some(from.max(z_min))
}

/// Cuts stretches that reach into the slack beyond the piece down to the part on the piece. A
/// stretch of which no part is on the piece becomes contacts with the border, somewhere along it.
fn clip_stretches(piece: &Piece, ray: &RayFrame, found: &mut [Found]) {
    for found in found {
        let Found::Stretch(ends) = found else { continue };
        let Some([first, last]) = ends[0].evidence.open_range() else { continue };
        let places = ends.map(|end| on_piece(piece, ray, end.st));
        let [from, to] = places.map(|st| ray.axis.dot(piece.patch.point(st) - ray.origin));
        *ends = End::BOTH.map(|end| Solution {
            st: places[end as usize],
            evidence: if from < to {
                Evidence::Stretch { z: [from, to], end }
            } else {
                Evidence::Contact([to.min(first), from.max(last)])
            },
        });
    }
}

/// Whether the leaf's certificate covers this ray, and rounding is small compared with the leaf.
fn certified(placed: &PlacedLeaf<'_>, ray: &RayFrame, error: f64) -> bool {
    let certificate = &placed.leaf.certificate;
    let slopes = placed.oriented.directions().map(|row| row.dot(ray.axis));
    let Some(steepness) = certificate.steepness_if_valid(slopes, error) else { return false };
    placed.leaf.pole(placed.piece).is_none_or(|pole| {
        let distance = ray.distance(pole);
        error * f64::from(certificate.pole_per_error()) <= steepness * distance
    })
}

/// Newton's start: the parameters at box coordinates, which run from −1 to 1 along the leaf's
/// parameters.
fn first_guess(leaf: &Leaf, middle: DVec2) -> DVec2 {
    let at = |[from, to]: [f64; 2], x: f64| 0.5 * ((from + to) + x * (to - from));
    let [s, t] = leaf.rect();
    DVec2::new(at(s, middle.x), at(t, middle.y))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::wanted::Wanted;
    use crate::intersect::{Query, SurfaceBvh};
    use crate::math::Ray;

    /// Once a ray has cost all that it may cost, leaves that it may meet are left in doubt.
    #[test]
    fn what_is_not_searched_any_more_is_in_doubt() {
        let bvh = SurfaceBvh::build(&[shapes::plane(2.0, 2.0).unwrap()]).unwrap();
        let query = Query::primary(Ray::new(DVec3::new(0.1, 0.2, 3.0), DVec3::NEG_Z).unwrap());
        let frame = RayFrame::new(&query.ray);
        let question = Question::new(bvh.patches(), &query, &frame, Wanted::First);
        let oriented = bvh.tree.oriented(0);
        let leaf = &bvh.leaves[0];
        let piece = &bvh.patches().pieces()[leaf.piece as usize];
        let placed = PlacedLeaf { leaf, oriented: &oriented, piece };
        for (effort, met, doubt) in [(0, 1, f64::INFINITY), (MOST_EFFORT, 0, 2.5)] {
            let mut findings = Findings::default();
            findings.effort = effort;
            search_exactly(&question, &placed, Some(2.5), f64::INFINITY, &mut findings);
            assert_eq!((findings.meetings.len(), findings.doubt), (met, doubt));
        }
    }
}
