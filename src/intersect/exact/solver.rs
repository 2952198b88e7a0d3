//! The list of boxes, and what becomes of each.

mod ends;

use glam::{DMat2, DVec2};

use super::contact::{self, Contact};
use super::parameter_box::{Bounds, Preconditioned, RayNet};
use super::problem::{Evidence, Found, Problem, Solution};
use crate::math::Interval;
use crate::math::bernstein::restrict_net;
use crate::patch::{StRect, holds};

/// How many boxes one call may look at before it only searches for the two ends of what is
/// left. A transversal hit takes 2 to 10, a tangency about a hundred; a ray inside a surface
/// would take all there are.
const BUDGET: u32 = 2048;

/// How many boxes each end of a stretch may cost.
const END_BUDGET: u32 = 1024;

/// Halves reach over the dividing line by this part of the box, so that roots on the line are
/// inside. A place within reach of the line is searched in both halves, and again in both halves of
/// those: a tangency, forty halvings deep, 1.4 times on average. (With a twentieth it would be 45
/// times, and the budget would be used up.)
const OVERLAP: f64 = 1.0 / 256.0;

/// A box cut down to a part keeps this fraction of the part's sides around it, so that a root at
/// its end is inside.
const MARGIN: f64 = 0.05;

/// A clip is kept if it leaves less than this part of a side that can still be halved; else the box
/// is halved.
const WORTHWHILE: f64 = 0.7;

/// A box is not clipped to an image thinner than this many errors along one parameter while its
/// image is wider than [`WIDE`] errors along the other. A Jacobian is of use where the error is
/// less than a twentieth of the image: this is more than ten times that.
const THIN: f64 = 256.0;

/// A box whose image is within this many errors along both parameters may get arbitrarily thin: it
/// is soon within rounding.
const WIDE: f64 = 4096.0;

/// The inverse of a Jacobian is of use where it amplifies the rounding error to no more than this
/// part of the box's side: what it then cuts off, or proves, is worth its cost.
const MOST_AMPLIFIED: f64 = 0.05;

/// Krawczyk's test is made where the map's contraction factor is below this: nearer to one, it cuts
/// off little.
const MOST_CONTRACTION: f64 = 0.9;

/// A box is not divided below this side: parameters near 1 have no finer digits.
const FINEST_SIDE: f64 = 4.0 * f64::EPSILON;

/// The ends of a stretch are found to within this part of the leaf: they are doubtful anyway,
/// and more precision would be expensive for a ray that runs through many leaves of a plane.
pub(crate) const END: f64 = 1e-9;

/// A contact longer than this part of the leaf is a stretch along which the ray runs inside
/// the surface. A contact at a tangency of second order is about 1e-8 long, the root of the
/// rounding error; at one of fourth order, 1e-4.
pub(crate) const STRETCH: f64 = 1e-3;

/// Boxes are discarded that are farther from the ray than this part of the promise for a point. The
/// other half is kept for the error of a contact's own point.
const DISCARDED: f64 = 0.5;

/// The point of a contact is within this many errors of the ray: one that nothing has discarded, and
/// one of its own.
pub(crate) const AT_CONTACT: f64 = 2.0;

/// A ray that passes the point of a collapsed side within this many errors meets it there.
pub(crate) const AT_POLE: f64 = 2.0;

/// Scratch memory of the exact solver; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct ExactSolver {
    whole: RayNet,
    net: RayNet,
    preconditioned: Preconditioned,
    /// Boxes yet to be looked at, in the parameters of `whole`.
    waiting: Vec<StRect>,
    contacts: Vec<Contact>,
    isolated: Vec<Solution>,
    /// Boxes that are only searched for the two ends of a stretch.
    spare: Vec<StRect>,
    queue: Vec<EndBox>,
    /// The largest extent of the leaf.
    size: f64,
    /// Error bound `ε` of `w x` and `w y`: [`DISCARDED`] of that of a point, times the largest
    /// weight. The [module](super) says what it rests on.
    error: f64,
    /// Boxes looked at since the solver was made.
    pub boxes: u64,
}

/// A box that may hold the end of a stretch.
#[derive(Clone, Copy, Debug)]
struct EndBox {
    rect: StRect,
    /// Where the box begins along the ray; if the last place is searched for, minus where it ends.
    z: f64,
    /// Whether the box is too short for a division to tell more.
    short: bool,
    /// Across which direction to halve it.
    axis: usize,
}

/// What becomes of a box.
enum BoxVerdict {
    Empty,
    Root(DVec2),
    Contact([f64; 2]),
    /// The box and the ray lie in one plane, to within rounding.
    Inside,
    Shrunk(StRect),
    Halved(usize),
}

impl ExactSolver {
    /// All places where the ray meets the leaf, appended to `found`.
    pub(crate) fn solve(&mut self, problem: &Problem<'_>, found: &mut Vec<Found>) {
        self.load(problem);
        let mut used = 0;
        while let Some(rect) = self.waiting.pop() {
            used += 1;
            self.boxes += 1;
            match self.judge(problem, rect) {
                BoxVerdict::Empty => {}
                BoxVerdict::Root(st) => self.isolated.push(self.root(problem, rect, st)),
                BoxVerdict::Contact(z) => {
                    let contact = Contact::new(rect, z, self.at_collapsed_side(problem, rect));
                    contact::merge_into(&mut self.contacts, contact);
                }
                BoxVerdict::Inside => self.spare.push(rect),
                BoxVerdict::Shrunk(part) => self.waiting.push(part),
                BoxVerdict::Halved(axis) => self.waiting.extend(halves(rect, axis, OVERLAP)),
            }
            if used >= BUDGET {
                self.spare.append(&mut self.waiting);
            }
        }
        self.search_ends(problem);
        self.report(problem, found);
    }

    /// Loads the leaf's net in ray coordinates, and one box: all of it.
    fn load(&mut self, problem: &Problem<'_>) {
        let ray = problem.ray;
        self.whole.degree = problem.patch.degree();
        self.whole.control.clear();
        self.whole.control.extend(
            problem
                .patch
                .control()
                .map(|c| ray.along_axes(c.truncate() - c.w * ray.origin).extend(c.w)),
        );
        let degree = self.whole.degree;
        restrict_net(&mut self.whole.control, degree, problem.rect[0], problem.rect[1]);
        // Bounds of NaNs would be empty, and prove a miss. Limits on coordinates and weights keep
        // all of this far from overflow.
        debug_assert!(self.whole.control.iter().all(|c| c.is_finite()), "{:?}", self.whole);
        let bounds = self.whole.bounds();
        let extents = [bounds.x, bounds.y, bounds.z].map(|range| range.hi - range.lo);
        self.size = extents.into_iter().fold(0.0, f64::max);
        self.error =
            DISCARDED * problem.error * self.whole.control.iter().map(|c| c.w).fold(0.0, f64::max);
        self.waiting.clear();
        self.spare.clear();
        self.contacts.clear();
        self.isolated.clear();
        self.waiting.push([[0.0, 1.0]; 2]);
    }

    /// What becomes of a box: of the questions of the [module](super), the first is asked of `f`,
    /// then the fourth, the first of `g`, the second and the third.
    fn judge(&mut self, problem: &Problem<'_>, rect: StRect) -> BoxVerdict {
        let error = self.error;
        self.net.restrict_from(&self.whole, rect);
        let bounds = self.net.bounds();
        if self.is_empty(problem, rect, &bounds) {
            return BoxVerdict::Empty;
        }
        let exhausted = rect.map(|[from, to]| to - from <= FINEST_SIDE);
        let within_rounding = bounds.x.magnitude().max(bounds.y.magnitude()) <= 2.0 * error;
        if within_rounding || exhausted == [true; 2] {
            return self.contact(&bounds);
        }

        // g = A f, close to the identity where the box is small against its curvature.
        let jacobian = self.net.mean_jacobian();
        let longer = usize::from(jacobian.y_axis.length() > jacobian.x_axis.length());
        let inverse = jacobian.inverse();
        let amplified = error * (inverse.x_axis.abs() + inverse.y_axis.abs()).max_element();
        let usable = amplified < MOST_AMPLIFIED; // false for NaN: a singular Jacobian
        if !usable {
            return self.turned(rect, &bounds, error);
        }
        self.preconditioned.assign(&self.net, inverse);
        let ranges = self.preconditioned.ranges();
        if ranges.iter().any(|range| range.lo > amplified || range.hi < -amplified) {
            return BoxVerdict::Empty;
        }
        let clips =
            [self.preconditioned.clip(0, 0, amplified), self.preconditioned.clip(1, 1, amplified)];
        let [Some(mut s), Some(mut t)] = clips else { return BoxVerdict::Empty };

        // Krawczyk's test on the box of side 1.
        let kappa = self.preconditioned.contraction();
        if kappa.max_element() < MOST_CONTRACTION {
            let center = DVec2::splat(0.5) - self.preconditioned.middle();
            let radius = 0.5 * kappa + amplified;
            let (low, high) = (center - radius, center + radius);
            if low.max_element() > 1.0 || high.min_element() < 0.0 {
                return BoxVerdict::Empty;
            }
            // Coefficients may each be off by `amplified`, and derivatives are made of their
            // differences.
            let [p, q] = self.net.degree;
            let unique = kappa.max_element() + 2.0 * (p + q) as f64 * amplified < 1.0;
            let inside = low.min_element() > 0.0 && high.max_element() < 1.0;
            if inside
                && unique
                && let Some(st) = self.refined(problem, rect, center)
            {
                return BoxVerdict::Root(st);
            }
            s = [s[0].max(low.x), s[1].min(high.x)];
            t = [t[0].max(low.y), t[1].min(high.y)];
            if s[0] > s[1] || t[0] > t[1] {
                return BoxVerdict::Empty;
            }
        }
        next_box(rect, self.not_too_thin([s, t], error), exhausted, longer)
    }

    /// What becomes of a box where the Jacobian is singular to working precision: near a
    /// silhouette, at a pole, or where the box is still too large.
    ///
    /// There `f` is turned so that its first component takes the direction in which the
    /// image of the box is longest. Near a silhouette the second component is then quadratic,
    /// and tells how far the ray is from touching; around a pole the first is the distance
    /// from the pole.
    fn turned(&mut self, rect: StRect, bounds: &Bounds, error: f64) -> BoxVerdict {
        let exhausted = rect.map(|[from, to]| to - from <= FINEST_SIDE);
        let rotation = longest_direction(self.net.mean_jacobian());
        self.preconditioned.assign(&self.net, rotation);
        let error = error * std::f64::consts::SQRT_2;
        let ranges = self.preconditioned.ranges();
        if ranges.iter().any(|range| range.lo > error || range.hi < -error) {
            return BoxVerdict::Empty;
        }
        if ranges[1].magnitude() <= 2.0 * error {
            // The box and the ray lie in one plane, as far as rounding can tell.
            return self.contact(bounds);
        }

        let mut part: StRect = [[0.0, 1.0]; 2];
        for axis in 0..2 {
            for component in 0..2 {
                let Some([from, to]) = self.preconditioned.clip(component, axis, error) else {
                    return BoxVerdict::Empty;
                };
                part[axis] = [part[axis][0].max(from), part[axis][1].min(to)];
            }
            if part[axis][0] > part[axis][1] {
                return BoxVerdict::Empty;
            }
        }
        let spread = self.net.spread();
        let part = self.not_too_thin(part, error);
        next_box(rect, part, exhausted, usize::from(spread.y > spread.x))
    }

    /// The part of the box, widened where it is as thin as rounding along one parameter and wide
    /// along the other: otherwise the Jacobian would be singular to working precision however small
    /// the box, and no root could be proved. This happens where the ray is at right angles to the
    /// straight lines of a surface: one clip then determines which line the ray meets, to the last
    /// digit.
    fn not_too_thin(&self, mut part: StRect, error: f64) -> StRect {
        let spread = self.net.spread().to_array();
        let image = [0, 1].map(|k| spread[k] * (part[k][1] - part[k][0]));
        for k in 0..2 {
            if image[k] < THIN * error && image[1 - k] > WIDE * error {
                let more = 0.5 * THIN * error / spread[k];
                part[k] = [(part[k][0] - more).max(0.0), (part[k][1] + more).min(1.0)];
            }
        }
        part
    }

    /// The verdict on a box that cannot be told from the ray: one place, or a stretch whose ends
    /// are still to be found.
    fn contact(&self, bounds: &Bounds) -> BoxVerdict {
        let short = bounds.z.hi - bounds.z.lo <= STRETCH * self.size;
        if short { BoxVerdict::Contact([bounds.z.lo, bounds.z.hi]) } else { BoxVerdict::Inside }
    }

    /// Whether nothing wanted can lie in the box.
    fn is_empty(&self, problem: &Problem<'_>, rect: StRect, bounds: &Bounds) -> bool {
        let off_ray = |range: Interval| range.lo > self.error || range.hi < -self.error;
        let z_error = problem.error;
        let behind = bounds.z.hi < problem.z_range[0] - z_error;
        let beyond = bounds.z.lo > problem.z_range[1] + z_error;
        // Boxes in the outer half of the slack belong to other leaves, or to none.
        let in_problem = |k: usize, x: f64| {
            let [from, to] = problem.rect[k];
            from + x * (to - from)
        };
        let unwanted = (0..2).any(|k| {
            let low_slack = 0.5 * (problem.wanted[k][0] - problem.rect[k][0]);
            let high_slack = 0.5 * (problem.rect[k][1] - problem.wanted[k][1]);
            in_problem(k, rect[k][1]) < problem.wanted[k][0] - low_slack
                || in_problem(k, rect[k][0]) > problem.wanted[k][1] + high_slack
        });
        off_ray(bounds.x) || off_ray(bounds.y) || behind || beyond || unwanted
    }

    /// The proved root refined on the surface itself, in the parameters of the problem's
    /// rectangle: the best place that Newton's iteration comes to; `None` when its residual stays
    /// large.
    fn refined(&self, problem: &Problem<'_>, rect: StRect, start: DVec2) -> Option<DVec2> {
        let sides = DVec2::from_array(problem.rect.map(|[from, to]| to - from));
        let mut x = inner(rect, start);
        let mut best = (f64::INFINITY, x);
        for _ in 0..8 {
            let (jacobian, at) = linearised(problem, inner(problem.rect, x));
            if at.length() < best.0 {
                best = (at.length(), x);
            } else if best.0 <= problem.error {
                break; // rounding leaves nothing to gain
            }
            x -= jacobian.inverse() * at / sides;
            if !holds(rect, x) {
                break; // also when the step is not a number
            }
        }
        (best.0 <= problem.error).then_some(best.1)
    }

    /// The only root of a box, at a place of the box.
    fn root(&self, problem: &Problem<'_>, rect: StRect, x: DVec2) -> Solution {
        let outer = |k: usize| {
            let [from, to] = problem.rect[k];
            rect[k].map(|x| from + x * (to - from))
        };
        Solution { st: inner(problem.rect, x), evidence: Evidence::Isolated([outer(0), outer(1)]) }
    }

    fn at_collapsed_side(&self, problem: &Problem<'_>, rect: StRect) -> bool {
        problem.collapsed.is_some_and(|side| side.is_reached_by(&rect))
    }
}

/// The Jacobian of the distances from the ray's planes by the piece's parameters, and the
/// distances.
fn linearised(problem: &Problem<'_>, st: DVec2) -> (DMat2, DVec2) {
    let jet = problem.patch.jet(st);
    let at = problem.ray.coordinates(jet.point).truncate();
    (DMat2::from_cols(problem.ray.across(jet.ds), problem.ray.across(jet.dt)), at)
}

/// The rotation that turns the direction in which a linear map stretches most into the
/// first axis.
fn longest_direction(map: DMat2) -> DMat2 {
    let image = map * map.transpose();
    let angle = 0.5 * (2.0 * image.x_axis.y).atan2(image.x_axis.x - image.y_axis.y);
    DMat2::from_angle(-angle)
}

/// The place in `rect` of a point given in units of its sides.
fn inner(rect: StRect, x: DVec2) -> DVec2 {
    let at = |[from, to]: [f64; 2], x: f64| from + x * (to - from);
    DVec2::new(at(rect[0], x.x), at(rect[1], x.y))
}

/// The two halves across an axis, each longer by a part of the whole.
fn halves(rect: StRect, axis: usize, overlap: f64) -> [StRect; 2] {
    let [from, to] = rect[axis];
    let (middle, more) = (0.5 * (from + to), overlap * (to - from));
    let mut parts = [rect; 2];
    parts[0][axis] = [from, (middle + more).min(to)];
    parts[1][axis] = [(middle - more).max(from), to];
    parts
}

/// The box cut down to `part` of its sides if that is worthwhile, else its halves across the
/// longer side that can still be halved.
fn next_box(rect: StRect, part: StRect, exhausted: [bool; 2], longer: usize) -> BoxVerdict {
    let worthwhile = (0..2).any(|k| !exhausted[k] && part[k][1] - part[k][0] < WORTHWHILE);
    if !worthwhile {
        return BoxVerdict::Halved(if exhausted[longer] { 1 - longer } else { longer });
    }
    let mut shrunk = rect;
    for k in 0..2 {
        // A root at the end of a clip stays inside the box by a part of what is left.
        let [from, to] = rect[k];
        let more = MARGIN * (part[k][1] - part[k][0]) + 2.0 * f64::EPSILON;
        let at = |x: f64| from + x.clamp(0.0, 1.0) * (to - from);
        shrunk[k] = [at(part[k][0] - more), at(part[k][1] + more)];
    }
    BoxVerdict::Shrunk(shrunk)
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{BUDGET, ExactSolver, Problem};
    use crate::geometry::construct::{Caps, TubeStyle, tube};
    use crate::geometry::{KnotVector, NurbsCurve, NurbsSurface};
    use crate::intersect::{Query, SurfaceBvh};
    use crate::math::{Ray, RayFrame};
    use crate::patch::{PatchSet, TensorPatch};

    /// All of a patch, none of whose sides is a point, against all of a ray ahead.
    fn whole<'a>(patch: &'a TensorPatch, ray: &'a RayFrame, error: f64) -> Problem<'a> {
        let (rect, wanted) = ([[0.0, 1.0]; 2], [[0.0, 1.0]; 2]);
        let z_range = [0.0, f64::INFINITY];
        Problem { patch, rect, wanted, collapsed: None, ray, error, z_range }
    }

    /// The parabolic cylinder `(φ, φ², s − t)` with `φ = s + t − 1`, and the line on it where `φ` is
    /// zero, from corner to corner of the parameters: it would take millions of boxes along the
    /// diagonal. What no box was spent on is reported all the same, from end to end of the line.
    #[test]
    fn what_is_left_when_the_budget_is_used_up_is_reported_in_doubt() {
        // Values of the blossoms of s, t, s² and t² at zeros and ones: (0, ½, 1) and (0, 0, 1).
        let (once, twice) = ([0.0, 0.5, 1.0], [0.0, 0.0, 1.0]);
        let point = |[i, j]: [usize; 2]| {
            let (s, t) = (once[i], once[j]);
            let square = twice[i] + twice[j] + 1.0 + 2.0 * (s * t - s - t);
            DVec3::new(s + t - 1.0, square, s - t)
        };
        let net = (0..9).map(|k| point([k / 3, k % 3])).collect();
        let knots = || KnotVector::bezier(2).unwrap();
        let sheet = NurbsSurface::new(knots(), knots(), net, None).unwrap();
        let (set, _) = PatchSet::new(&[sheet]).unwrap();
        let patch = &set.pieces()[0].patch;
        for away in [-1.0, 1.0] {
            let along = away * DVec3::NEG_Z;
            let ray = RayFrame::new(&Ray::new(away * DVec3::new(0.0, 0.0, 5.0), along).unwrap());
            let problem = whole(patch, &ray, patch.error_bound(ray.magnitude));
            let (mut solver, mut found) = (ExactSolver::default(), Vec::new());
            solver.solve(&problem, &mut found);
            assert!(solver.boxes > u64::from(BUDGET), "{} boxes", solver.boxes);
            let evidence: Vec<_> = found.iter().map(|found| found.evidence()).collect();
            let open = evidence.iter().filter_map(|evidence| evidence.open_range());
            let [from, to] = open.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], [a, b]| {
                [from.min(a), to.max(b)]
            });
            // The line runs from z = −1 to z = 1, that is, from 4 to 6 along the ray.
            assert!(from <= 4.0 + 1e-6 && to >= 6.0 - 1e-6, "{evidence:?}");
            assert!(from > 4.0 - 1e-6 && to < 6.0 + 1e-6, "{evidence:?}");
        }
    }

    /// A net of `(x(s), t − ½, 0)` with the slope of `x` nearly constant near ½, and small: moved by
    /// no more than the error, it falls there, so the surface it may have come from is met three
    /// times, though the computed one is met once. That is no proof of one root.
    #[test]
    fn coefficients_that_may_be_off_prove_no_single_root() {
        const DEGREE: usize = 24;
        // Half of the error bound of points: see `DISCARDED`.
        let error = 0.045;
        // Differences times the degree, which add up to the degree: those in the middle are the
        // smallest for which Krawczyk's test is made.
        let is_outer = |i: usize| !(6..DEGREE - 6).contains(&i);
        let (inner, outer) = (0.12, 1.88);
        let (mut computed, mut x) = (vec![-0.5], -0.5);
        for i in 0..DEGREE {
            x += if is_outer(i) { outer } else { inner } / DEGREE as f64;
            computed.push(x);
        }
        assert!((x - 0.5).abs() < 1e-14);
        // Falling in the middle, and odd about it: so it has a root on either side of it, too.
        let sign = |i: usize| (2.0 * i as f64 - DEGREE as f64).clamp(-1.0, 1.0);
        let moved = (0..=DEGREE).map(|i| computed[i] - error * sign(i));
        let mut casteljau: Vec<f64> = moved.collect();
        let aside = 0.53;
        while casteljau.len() > 1 {
            casteljau = casteljau.windows(2).map(|w| w[0] + aside * (w[1] - w[0])).collect();
        }
        assert!(casteljau[0] < -1e-3, "{casteljau:?}");

        let points = computed.iter().flat_map(|&x| [-0.5, 0.5].map(|y| DVec3::new(x, y, 0.0)));
        let [u, v] = [DEGREE, 1].map(|degree| KnotVector::bezier(degree).unwrap());
        let sheet = NurbsSurface::new(u, v, points.collect(), None).unwrap();
        let (set, _) = PatchSet::new(&[sheet]).unwrap();
        let patch = &set.pieces()[0].patch;
        let ray = RayFrame::new(&Ray::new(DVec3::Z, DVec3::NEG_Z).unwrap());
        let solved = |error: f64| {
            let mut found = Vec::new();
            ExactSolver::default().solve(&whole(patch, &ray, error), &mut found);
            found
        };
        let [one] = solved(1e-12)[..] else { panic!("one root") };
        assert!(one.evidence().is_proof());
        let found = solved(2.0 * error);
        assert!(!found.is_empty() && !found.iter().any(|f| f.evidence().is_proof()), "{found:?}");
    }

    /// Rays that leave a long, thin cylinder at right angles to its axis, nearly along its surface
    /// (within about 3°): one clip tells where along the axis they are, to the last digit. All of
    /// these were doubtful when no root could be proved in what was left of a box.
    #[test]
    fn rays_at_right_angles_to_straight_lines_are_decided() {
        let line = [[5.0, 2.0], [6.0, 5.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let line = NurbsCurve::polyline(&line).unwrap();
        let style = TubeStyle { radius: 0.03, caps: Caps::Open, tolerance: None };
        let cylinder = tube(&line, &style).unwrap()[0].surface.clone();
        let bvh = SurfaceBvh::build(std::slice::from_ref(&cylinder));
        let bvh = bvh.unwrap();
        let mut tracer = bvh.tracer();
        for k in 0..70 {
            for v in [0.1, 0.37, 0.8] {
                let u = 0.129_007_5 + 1e-4 * f64::from(k);
                let normal = cylinder.normal(DVec2::new(u, v)).unwrap();
                let inward =
                    Ray::new(cylinder.point_at(DVec2::new(u, v)) + 0.5 * normal, -normal).unwrap();
                let hit = tracer.first_hit(&Query::primary(inward)).hit.unwrap();
                let onward = Ray::new(hit.point, DVec3::new(3.0, -1.0, 3.0)).unwrap();
                let cosine = normal.dot(onward.direction().normalize());
                assert!((0.0..0.055).contains(&cosine), "{cosine}");
                let answer = tracer.occluded(&Query::leaving(onward, &hit));
                assert!(!answer.occluded && !answer.doubtful, "({u}, {v}): {answer:?}");
            }
        }
    }
}
