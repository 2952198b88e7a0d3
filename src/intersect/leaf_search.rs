//! One leaf, one ray: what is found, and how it is known.

use glam::{DVec2, DVec3, DVec4};

use super::exact::{END, ExactSolver, Proof, Rect, STRETCH, Solution, Task};
use super::kept_pole::Spot;
use super::newton::{Grounds, Newton, newton, project};
use super::{HitFlags, Occlusion, Root, Statistics};
use crate::geometry::trim::Side;
use crate::math::{RayFrame, rounding};
use crate::patch::{Jet, LEAF_SLACK, Leaf, OrientedBox, Passage, PatchSet, Piece, WIDENING};

/// A place where a ray meets a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The ray parameter.
    pub(super) t: f64,
    /// How far that may be off.
    pub(super) t_error: f64,
    pub(super) surface: u32,
    pub(super) piece: u32,
    pub(super) st: DVec2,
    pub(super) jet: Jet,
    /// The unit normal, where there is one.
    pub(super) normal: Option<DVec3>,
    pub(super) flags: HitFlags,
    /// How far the surface's point may be from the ray.
    pub(super) error: f64,
    /// The cosine between the ray and the normal, signed; zero where there is no normal.
    pub(super) cosine: f64,
    /// The stretch along which the ray runs inside the surface, as ray parameters.
    pub(super) stretch: Option<[f64; 2]>,
    /// Whether the ray passes a side of the piece on its outside, by more than the rounding of
    /// a ray that was aimed at the side.
    pub(super) beyond: bool,
}

/// Everything a search of leaves needs to know of the question.
#[derive(Clone, Copy, Debug)]
pub(super) struct Question<'a> {
    pub(super) set: &'a PatchSet,
    pub(super) ray: &'a RayFrame,
    pub(super) t_range: [f64; 2],
    pub(super) from: Option<&'a Root>,
}

/// A leaf, with its box and its piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) leaf: &'a Leaf,
    pub(super) oriented: &'a OrientedBox,
    pub(super) piece: &'a Piece,
}

impl<'a> Question<'a> {
    /// The root the ray starts on, and its piece, if it lies on that surface.
    fn start_on(&self, surface: u32) -> Option<(&'a Root, &'a Piece)> {
        let root = self.from?;
        // A root of other surfaces than these is none of theirs.
        let piece = self.set.pieces().get(root.piece as usize)?;
        (piece.surface == surface).then_some((root, piece))
    }

    /// Whether a crossing of an edge is that of the edge which the ray starts on, of another
    /// surface: at the same place, to within what both may be off by, and with the same sign of
    /// `N · d`, as in [`crossings`](super::crossings).
    fn starts_on_edge_at(&self, point: DVec3, cosine: f64, z_error: f64) -> bool {
        let Some(root) = self.from else { return false };
        let Some(piece) = self.set.pieces().get(root.piece as usize) else { return false };
        let jet = piece.patch.jet(root.st);
        let near = point.distance(jet.point) <= 2.0 * (z_error + root.error);
        let edge = || {
            at_border(piece, root.st, &jet, error_bound(piece, self.ray))
                || matches!(piece.side(root.st, trim_reach(&jet, root.error)), Side::Edge { .. })
        };
        let same_side = || {
            let other = piece.normal(root.st, &jet).map_or(0.0, |normal| normal.dot(self.ray.axis));
            cosine * other > 0.0 && cosine.abs().min(other.abs()) > CLEAR_SIDE
        };
        near && edge() && same_side()
    }
}

/// The cosine above which it is clear on which side a ray leaves an edge.
const CLEAR_SIDE: f64 = 1e-4;

/// What a search found, and its scratch memory.
#[derive(Debug, Default)]
pub(super) struct Findings {
    pub(super) meetings: Vec<Meeting>,
    /// The smallest ray parameter at which something may have been missed.
    pub(super) doubt: f64,
    pub(super) statistics: Statistics,
    /// Boxes the exact solver has looked at for this ray; whoever asks about the next one sets it
    /// to zero.
    pub(super) effort: u64,
    solver: ExactSolver,
    solutions: Vec<Solution>,
}

impl Findings {
    /// Forgets what was found, keeps memory and counts.
    pub(super) fn clear(&mut self) {
        self.meetings.clear();
        self.doubt = f64::INFINITY;
    }

    /// What was found as the answer of an any-hit search.
    pub(super) fn occlusion(&mut self) -> Occlusion {
        let certain = self.meetings.iter().any(|m| !m.flags.contains(HitFlags::DOUBTFUL));
        let occluded = !self.meetings.is_empty();
        let doubtful = !certain && (occluded || self.doubt < f64::INFINITY);
        self.statistics.doubtful += u64::from(doubtful);
        Occlusion { occluded, doubtful }
    }

    fn doubt_at(&mut self, t: f64) {
        self.doubt = self.doubt.min(t);
    }
}

/// The fast way: Newton where the leaf's certificate holds, else the exact solver.
///
/// Where the certificate holds there is at most one root in the widened leaf. If Newton
/// converges there, a second point with a residual below the error could only be within
/// `error·spread/cos` of it: well inside the slack. So the point found is the leaf's one
/// meeting if it lies in the leaf or its slack; if it lies outside, the leaf is proved to
/// be missed; so it is where a step from beyond the leaf surely leads away. `z_limit` is how far along the ray anything is still of interest.
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
    let rect = leaf.widened(piece, LEAF_SLACK);
    let [z_min, z_max] = question.ray.z_range;
    let task = Task {
        patch: &piece.patch,
        rect,
        wanted: leaf.rect(),
        collapsed: leaf.collapsed(piece),
        ray: question.ray,
        error: error_bound(piece, question.ray),
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

/// How far a computed point of the piece may be from the true one, for this ray.
pub(super) fn error_bound(piece: &Piece, ray: &RayFrame) -> f64 {
    piece.patch.residual_factor() * piece.patch.magnitude().max(ray.magnitude)
}

/// Whether the leaf's certificate speaks of this ray, and rounding is small against the
/// leaf.
fn certified(place: &Place<'_>, ray: &RayFrame, error: f64) -> bool {
    let certificate = &place.leaf.certificate;
    let slopes = place.oriented.directions().map(|row| row.dot(ray.axis));
    let steep = slopes[2].abs();
    let away_from_pole = place.leaf.pole(place.piece).is_none_or(|pole| {
        let distance = ray.coordinates(pole).truncate().length();
        error * f64::from(certificate.pole_per_error()) <= steep * distance
    });
    let needed = error * f64::from(certificate.steep_per_error());
    certificate.holds(slopes) && needed <= steep && away_from_pole
}

fn holds(rect: Rect, st: DVec2) -> bool {
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
        Proof::Collapsed => (2.0 * error, HitFlags::NONE),
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
    // A ray through a pole crosses the surface there, unless it may as well touch it: where the
    // radius of curvature is R, it meets the surface again 2 R cos(N, d) from there, and in
    // between is within R cos² / 2 of it. A leaf turns by less than its length over R.
    let sides = leaf.rect().map(|[from, to]| to - from);
    let length = (sides[0] * jet.ds.length()).max(sides[1] * jet.dt.length());
    let touches = cosine * cosine * length <= CLEAR_OF_POLE * error;
    if solution.proof == Proof::Collapsed && touches {
        flags.insert(HitFlags::DOUBTFUL);
    }
    let mut z_error = error / cosine.abs().max(f64::EPSILON);
    if let Proof::Contact { length } = solution.proof {
        z_error = z_error.min(length + error);
    }
    if let Proof::Stretch([from, to]) = solution.proof {
        // Ends are found to within a part of the leaf; a stretch is longer than `STRETCH` of it.
        z_error = 4.0 * error + END / STRETCH * (to - from).abs();
    }

    // What trims cut off is not there; their edges are. In a pole is what any kept parameter
    // leads to.
    let (mut piece, mut piece_index) = (piece, leaf.piece);
    match trim_side(leaf, piece, st, &jet, z_error) {
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
            let same = match solution.proof {
                Proof::Isolated(rect) => root.piece != leaf.piece || holds(rect, root.st),
                Proof::Collapsed => true,
                _ => false,
            };
            if !same {
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
    if undecided {
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

/// How far from the surface, in errors, a ray must be between a pole and the next root for the two
/// to be told apart: half of this; with two errors and less they were seen as one.
const CLEAR_OF_POLE: f64 = 16.0;

/// A ray aimed at a point of a border passes it by no more than this part of what rounding may
/// do there: 0.1 is the most that was seen.
const AIMED: f64 = 0.25;

/// The [`error_bound`] of a piece that is no larger than one of its points.
fn rounding_at(point: DVec3, piece: &Piece, ray: &RayFrame) -> f64 {
    piece.patch.residual_factor() * point.abs().max_element().max(ray.magnitude)
}

/// The place itself if it is on the piece, else the point of the piece's border that is
/// nearest to the ray there.
///
/// The slack of a border is a distance in space: where the ray grazes, a root that rounding
/// has put outside by much in one parameter is near the border for another value of the
/// other parameter. Where the ray runs inside the surface, the end of the stretch may be
/// well outside, and the ray cross the border far from there.
fn on_piece(piece: &Piece, ray: &RayFrame, st: DVec2) -> DVec2 {
    let nearest = st.clamp(DVec2::ZERO, DVec2::ONE);
    let residual = |st: DVec2| ray.coordinates(piece.patch.point(st)).truncate().length();
    match [nearest.x != st.x, nearest.y != st.y] {
        [false, false] => nearest,
        [true, false] => along_border(piece, ray, nearest, DVec2::Y),
        [false, true] => along_border(piece, ray, nearest, DVec2::X),
        [true, true] => {
            // Beyond a corner the ray may cross either of its sides.
            let [a, b] = [DVec2::X, DVec2::Y].map(|free| along_border(piece, ray, nearest, free));
            if residual(b) < residual(a) { b } else { a }
        }
    }
}

/// The point of a border nearest to the ray, from a place on it: least squares along the
/// direction that is free.
fn along_border(piece: &Piece, ray: &RayFrame, start: DVec2, free: DVec2) -> DVec2 {
    // Gauss and Newton's steps double the digits, but only near the end of a long way.
    let most_steps = 8;
    let mut nearest = start;
    for _ in 0..most_steps {
        let jet = piece.patch.jet(nearest);
        let at = ray.coordinates(jet.point).truncate();
        let along = project(ray, free.x * jet.ds + free.y * jet.dt);
        let step = along.dot(at) / along.length_squared();
        if !step.is_finite() {
            break;
        }
        let next = (nearest - step * free).clamp(DVec2::ZERO, DVec2::ONE);
        if next == nearest {
            break;
        }
        nearest = next;
    }
    nearest
}

/// How much farther than a hit may be off, as far as is known, a trim edge counts as near: the
/// edge itself is on a surface known to rounding, and the edge it is shared with on another.
pub(super) const TRIM_REACH: f64 = 4.0;

/// Whether a root of a leaf is kept by the trims of its surface, if it may be off by `error` in
/// space.
fn trim_side(leaf: &Leaf, piece: &Piece, st: DVec2, jet: &Jet, error: f64) -> Side {
    // A border's point that is nearest to the ray may be off the leaf.
    let known = || !leaf.is_trimmed() && holds(leaf.widened(piece, WIDENING), st);
    if piece.trims().is_none() || known() {
        return Side::Inside;
    }
    piece.side(st, trim_reach(jet, error))
}

/// How near a trim edge must be, in each parameter, for a root that may be off by `error` in
/// space to be at it.
///
/// A step in `s` alone moves the point by `|S_s|`; among steps in `s` and `t` the part of `s` is
/// at most the distance over `|S_s| sin θ`, with `θ` the angle between the tangents. At a pole
/// one tangent vanishes, and its parameter may be anything.
pub(super) fn trim_reach(jet: &Jet, error: f64) -> DVec2 {
    let lengths = DVec2::new(jet.ds.length(), jet.dt.length());
    let sine = jet.ds.cross(jet.dt).length() / (lengths.x * lengths.y);
    let sine = if sine > 0.0 { sine } else { 1.0 }; // also where it is not a number
    TRIM_REACH * error / (lengths * sine)
}

impl Solution {
    /// Whether a miss would not be proved by the solution's own box.
    fn proof_is_open(&self) -> bool {
        matches!(self.proof, Proof::Contact { .. } | Proof::Stretch(_))
    }
}

/// For each side of the piece that is a border of the surface and near the leaf: how far
/// from it, in the parameter, a hit may be within rounding of it.
///
/// The leaf is certified for the ray, so rounding moves a root by less than half of the
/// leaf's slack: what is farther from the side than a few times that is not at the border.
pub(super) fn border_reach(leaf: &Leaf, piece: &Piece) -> Option<[f64; 4]> {
    let mut reach = [f64::NEG_INFINITY; 4];
    let mut any = false;
    let rect = leaf.rect();
    for side in (0..4).filter(|&side| piece.is_border(side)) {
        let [from, to] = rect[side / 2];
        let more = 4.0 * LEAF_SLACK * (to - from);
        let distance = if side % 2 == 0 { from } else { 1.0 - to };
        if distance <= more {
            reach[side] = more;
            any = true;
        }
    }
    any.then_some(reach)
}

/// Whether a point lies within rounding of a side that is a border of the surface.
pub(super) fn at_border(piece: &Piece, st: DVec2, jet: &Jet, error: f64) -> bool {
    let distances = piece.side_distances(st, jet);
    (0..4).any(|side| piece.is_border(side) && distances[side] <= 4.0 * error)
}
