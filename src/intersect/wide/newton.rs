//! Newton's iteration on the true surface, in f64, eight lanes at a time: of eight rays and one
//! leaf, or of eight pairs of a ray and a leaf.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x8, mask64x8};
use fearless_simd_macros::simd;

use super::distances::Approximate;
use super::jets::Jets;
use super::search::dot_d;
use super::single_finish::COARSEST;
use super::single_ray::WITH_SLACK;

/// Steps in f64 with the surface's own tangents: one is usual.
const MOST_STEPS: usize = 4;

/// How much of the promised error a last step may leave behind.
pub(super) const PART_OF_ERROR: f64 = 0.125;

/// A bound of how far the normal may turn in the last step, in radians. It is some times as large
/// as the turn itself, of which the approximation's second derivatives, linear over the leaf,
/// leave a hundredth or so.
const MOST_TURN: f64 = 1e-9;

/// Eight leaves, one a lane, and the surfaces that they approximate.
pub(super) trait Leaves<S: Simd> {
    /// Points and first derivatives.
    fn jets(&self, simd: S, st: &[f64x8<S>; 2]) -> Jets<S>;

    /// The points alone.
    fn points(&self, simd: S, st: &[f64x8<S>; 2]) -> [f64x8<S>; 3];

    /// Half the sides of their rectangles, one over that, and their middles.
    fn half(&self, simd: S) -> [f64x8<S>; 2];
    fn per_half(&self, simd: S) -> [f64x8<S>; 2];
    fn middle(&self, simd: S) -> [f64x8<S>; 2];

    /// Where there is one root at most: from and to in `s`, then in `t`.
    fn domain(&self, simd: S) -> [f64x8<S>; 4];

    /// See [`FitError`](crate::patch::FitError).
    fn bend(&self, simd: S) -> f64x8<S>;

    /// Whether normals are asked for; else those that are found do for error bounds only.
    fn asks_normals(&self) -> bool;

    /// A coordinate of the approximation's second derivatives at a place, both in box coordinates:
    /// twice by the first, by both, twice by the second.
    fn second(&self, simd: S, axis: usize, place: [f64x8<S>; 2]) -> [f64x8<S>; 3];

    /// How far beyond a side of the piece a root must lie, in box coordinates, for all of the piece in the
    /// domain to be missed; infinite where nothing is known.
    fn clearance<R: Rays<S>>(&self, simd: S, rays: &R) -> f64x8<S>;

    /// The lanes whose next step surely leads away from the leaf, so that it is missed.
    fn surely_away<R: Rays<S>>(&self, simd: S, rays: &R, step: &Step<S>) -> mask64x8<S>;
}

/// Eight rays. What is asked for is read when it is: there are not enough registers to hold it.
pub(super) trait Rays<S: Simd> {
    fn origin(&self, simd: S) -> [f64x8<S>; 3];

    /// The unit directions.
    fn axis(&self, simd: S) -> [f64x8<S>; 3];

    /// The normals of two planes through each ray.
    fn normals(&self, simd: S) -> [[f64x8<S>; 3]; 2];

    /// How far a point may be from the ray.
    fn error(&self) -> f64x8<S>;

    /// The distances of points from the planes.
    #[inline(always)]
    fn distances(&self, simd: S, point: [f64x8<S>; 3]) -> [f64x8<S>; 2] {
        let (origin, [n1, n2]) = (self.origin(simd), self.normals(simd));
        let from = [point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]];
        [dot_d(n1, from), dot_d(n2, from)]
    }
}

/// A step of the iteration, before it is taken.
#[derive(Clone, Copy)]
pub(super) struct Step<S: Simd> {
    /// From where, and by how much it goes back.
    pub(super) at: [f64x8<S>; 2],
    pub(super) by: [f64x8<S>; 2],
    /// The distances from the ray's planes there.
    pub(super) distances: [f64x8<S>; 2],
}

/// Where the iteration has converged.
#[derive(Clone, Copy)]
pub(super) struct Converged<S: Simd> {
    /// The lanes that have.
    pub(super) found: mask64x8<S>,
    /// Those that should have.
    pub(super) open: mask64x8<S>,
    pub(super) st: [f64x8<S>; 2],
    /// How far along the ray.
    pub(super) z: f64x8<S>,
    pub(super) point: [f64x8<S>; 3],
    /// `S_s × S_t`, and no less than the sum of the lengths of `S_s` and `S_t`.
    pub(super) cross: [f64x8<S>; 3],
    pub(super) speed: f64x8<S>,
    /// One over the determinant of the tangents in the ray's planes.
    inverse_det: f64x8<S>,
    /// Steps taken, over all lanes.
    pub(super) steps: u32,
}

/// Where a step from a place leads, and what is known of it.
#[derive(Clone, Copy)]
struct Landed<S: Simd> {
    /// The lanes that have converged there.
    done: mask64x8<S>,
    st: [f64x8<S>; 2],
    step: Step<S>,
    /// As in [`Converged`].
    z: f64x8<S>,
    point: [f64x8<S>; 3],
    cross: [f64x8<S>; 3],
    speed: f64x8<S>,
    inverse_det: f64x8<S>,
}

/// Newton's steps for the `wanted` lanes, from what the search in f32 has found.
///
/// All of these rays have one root at most in the domain. So a lane that converges has found its
/// one root: it is `found` if it lies in the leaf or its slack, else that part of the leaf is
/// proved to be missed; so it is where the root lies so far beyond a side of the piece that no point of the
/// piece is within the error (`clearance`), and where a step surely leads away, which is asked where the leaf's
/// certificate speaks of the ray (`certified`).
///
/// The first step takes the true surface's point but the approximation's tangents: it leaves
/// about 1e-11 half sides, for little more than half of what a step with its own tangents costs.
#[inline(always)] // what goes in and out are dozens of vectors
pub(super) fn newton<S: Simd, T: Leaves<S>, R: Rays<S>>(
    simd: S,
    leaves: &T,
    rays: &R,
    (wanted, certified): (mask64x8<S>, bool),
    near: &Approximate<f64x8<S>>,
) -> Converged<S> {
    let at = first_step(simd, leaves, rays, near);
    // As a rule the next step is the last, for all lanes.
    let landed = land(simd, leaves, rays, &at);
    let mut root = Converged {
        found: landed.done & wanted,
        open: !landed.done & wanted,
        st: landed.st,
        z: landed.z,
        point: landed.point,
        cross: landed.cross,
        speed: landed.speed,
        inverse_det: landed.inverse_det,
        steps: 2 * wanted.to_bitmask().count_ones(),
    };
    if root.open.any_true() {
        // Copies: whose address is known to others is kept in memory, even where they are not asked.
        let so_far = (root, landed);
        let later = go_on(simd, leaves, rays, &so_far, certified);
        root = later;
    }

    // The leaf and its slack.
    let ([half_s, half_t], [middle_s, middle_t]) = (leaves.half(simd), leaves.middle(simd));
    let reach = f64x8::splat(simd, WITH_SLACK);
    root.found &= (root.st[0] - middle_s).abs().simd_le(half_s * reach)
        & (root.st[1] - middle_t).abs().simd_le(half_t * reach);
    if (root.found & !on_piece(simd, root.st)).any_true() {
        let st = root.st;
        root.found &= !beyond_piece(simd, leaves, rays, &st);
    }
    root
}

/// The places on the piece.
#[inline(always)]
fn on_piece<S: Simd>(simd: S, [s, t]: [f64x8<S>; 2]) -> mask64x8<S> {
    let (low, high) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
    s.simd_ge(low) & s.simd_le(high) & t.simd_ge(low) & t.simd_le(high)
}

/// The roots that lie so far beyond a side of the piece that it is missed there.
#[cold]
#[simd]
fn beyond_piece<S: Simd, T: Leaves<S>, R: Rays<S>>(
    simd: S,
    leaves: &T,
    rays: &R,
    [s, t]: &[f64x8<S>; 2],
) -> mask64x8<S> {
    let high = f64x8::splat(simd, 1.0);
    let [sides_s, sides_t] = leaves.per_half(simd);
    let over_s = (-*s).max(*s - high) * sides_s;
    let over_t = (-*t).max(*t - high) * sides_t;
    over_s.max(over_t).simd_gt(leaves.clearance(simd, rays))
}

/// The step with the approximation's tangents.
#[simd]
fn first_step<S: Simd, T: Leaves<S>, R: Rays<S>>(
    simd: S,
    leaves: &T,
    rays: &R,
    near: &Approximate<f64x8<S>>,
) -> [f64x8<S>; 2] {
    let ([half_s, half_t], [middle_s, middle_t]) = (leaves.half(simd), leaves.middle(simd));
    let place = [near.x.mul_add(half_s, middle_s), near.y.mul_add(half_t, middle_t)];
    let st = within(place, leaves.domain(simd));
    let [f1, f2] = rays.distances(simd, leaves.points(simd, &st));
    let [[xx, xy], [yx, yy]] = near.inverse;
    let place =
        [st[0] - half_s * xx.mul_add(f1, xy * f2), st[1] - half_t * yx.mul_add(f1, yy * f2)];
    within(place, leaves.domain(simd))
}

/// Steps stay where there is one root at most; NaN becomes a bound.
#[inline(always)]
fn within<S: Simd>([s, t]: [f64x8<S>; 2], domain: [f64x8<S>; 4]) -> [f64x8<S>; 2] {
    [s.max(domain[0]).min(domain[1]), t.max(domain[2]).min(domain[3])]
}

/// A step with the surface's own tangents.
#[inline(always)]
fn land<S: Simd, T: Leaves<S>, R: Rays<S>>(
    simd: S,
    leaves: &T,
    rays: &R,
    st: &[f64x8<S>; 2],
) -> Landed<S> {
    let jets = leaves.jets(simd, st);
    let [s, t] = *st;
    let [f1, f2] = rays.distances(simd, jets.point);
    let [n1, n2] = rays.normals(simd);
    let (a1, a2) = (dot_d(n1, jets.ds), dot_d(n2, jets.ds));
    let (b1, b2) = (dot_d(n1, jets.dt), dot_d(n2, jets.dt));
    let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
    let inverse_det = one / (a1 * b2 - a2 * b1);
    let step_s = (f1 * b2 - f2 * b1) * inverse_det;
    let step_t = (a1 * f2 - a2 * f1) * inverse_det;
    let new_s = s - step_s;
    let new_t = t - step_t;
    // The normal after the step.
    let ([half_s, half_t], [sides_s, sides_t]) = (leaves.half(simd), leaves.per_half(simd));
    let (move_x, move_y) = (step_s * sides_s, step_t * sides_t);
    let mut tangents = [jets.ds, jets.dt];
    if leaves.asks_normals() {
        let [middle_s, middle_t] = leaves.middle(simd);
        let place = [(s - middle_s) * sides_s, (t - middle_t) * sides_t];
        for i in 0..3 {
            let [xx, xy, yy] = leaves.second(simd, i, place);
            tangents[0][i] -= xx.mul_add(move_x, xy * move_y) * sides_s;
            tangents[1][i] -= xy.mul_add(move_x, yy * move_y) * sides_t;
        }
    }
    let mut cross = [zero; 3];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        cross[i] = tangents[0][j] * tangents[1][k] - tangents[0][k] * tangents[1][j];
    }

    // Converged where the residual is within the error; or will be after this step, which
    // the bend bounds, as it does the turn of the normal.
    let error = rays.error();
    let residual = f1.mul_add(f1, f2 * f2);
    let close = residual.simd_le(error * error);
    let longest = move_x.abs().max(move_y.abs());
    let bent = leaves.bend(simd) * longest;
    let (speed_s, speed_t) = (sum_of_sizes(jets.ds), sum_of_sizes(jets.dt));
    let least = error * f64x8::splat(simd, PART_OF_ERROR);
    let mut straight = (bent * longest).simd_le(least);
    if leaves.asks_normals() {
        let sides = half_s * speed_s + half_t * speed_t;
        let turn = (bent + bent) * sides;
        let least_turn = f64x8::splat(simd, MOST_TURN) * half_s * half_t;
        straight &= (turn * turn).simd_le(least_turn * least_turn * dot_d(cross, cross));
    }
    let domain = leaves.domain(simd);
    let inside = new_s.simd_ge(domain[0])
        & new_s.simd_le(domain[1])
        & new_t.simd_ge(domain[2])
        & new_t.simd_le(domain[3]);

    // What is left of the distance is taken off along the tangent plane.
    let (origin, axis) = (rays.origin(simd), rays.axis(simd));
    let (mut point, mut z) = (jets.point, zero);
    for i in 0..3 {
        point[i] = jets.point[i] - jets.ds[i] * step_s - jets.dt[i] * step_t;
        z = axis[i].mul_add(point[i] - origin[i], z);
    }
    Landed {
        // False for NaN, which nothing is known of.
        done: (close | straight) & inside,
        st: [new_s, new_t],
        step: Step { at: [s, t], by: [step_s, step_t], distances: [f1, f2] },
        z,
        point,
        cross,
        speed: speed_s + speed_t,
        inverse_det,
    }
}

/// The steps that follow, for lanes that are still open.
#[cold]
#[simd]
fn go_on<S: Simd, T: Leaves<S>, R: Rays<S>>(
    simd: S,
    leaves: &T,
    rays: &R,
    so_far: &(Converged<S>, Landed<S>),
    certified: bool,
) -> Converged<S> {
    let (mut root, mut landed) = *so_far;
    for step in 1..=MOST_STEPS {
        if certified {
            root.open &= !leaves.surely_away(simd, rays, &landed.step);
        }
        if step == MOST_STEPS || root.open.all_false() {
            break;
        }
        root.steps += root.open.to_bitmask().count_ones();
        landed = land(simd, leaves, rays, &within(landed.st, leaves.domain(simd)));
        let new = landed.done & root.open;
        for k in 0..2 {
            root.st[k] = new.select(landed.st[k], root.st[k]);
        }
        for i in 0..3 {
            root.point[i] = new.select(landed.point[i], root.point[i]);
            root.cross[i] = new.select(landed.cross[i], root.cross[i]);
        }
        root.z = new.select(landed.z, root.z);
        root.speed = new.select(landed.speed, root.speed);
        root.inverse_det = new.select(landed.inverse_det, root.inverse_det);
        root.found |= new;
        root.open &= !new;
    }
    root
}

/// The part of a ray that hits count on, of eight rays.
#[derive(Clone, Copy)]
pub(super) struct Ends<S: Simd> {
    /// From and to.
    pub(super) z: [f64x8<S>; 2],
    /// How far the roots that rays start on may be off, if any start on one.
    pub(super) from_error: Option<f64x8<S>>,
}

/// What is to be said of roots that were found.
#[derive(Clone, Copy)]
pub(super) struct Verdict<S: Simd> {
    /// The length of `S_s × S_t`.
    pub(super) size: f64x8<S>,
    /// How far `z` may be off.
    pub(super) z_error: f64x8<S>,
    /// Those the scalar search must judge.
    pub(super) judged: mask64x8<S>,
    /// Those within the ray's range.
    pub(super) acceptable: mask64x8<S>,
    /// How near an end or another hit a root is too near to be told apart.
    pub(super) near_end: f64x8<S>,
}

impl<S: Simd> Converged<S> {
    /// Roots just outside the piece, and those too near the ray's ends, are judged elsewhere.
    #[inline(always)]
    pub(super) fn verdict(
        &self,
        simd: S,
        ends: &Ends<S>,
        error: f64x8<S>,
        certified: bool,
    ) -> Verdict<S> {
        let (found, z) = (self.found, self.z);
        // One over the cosine is `|a × b| / det`.
        let size = dot_d(self.cross, self.cross).sqrt();
        let steepest = f64x8::splat(simd, 1.0 / f64::EPSILON);
        let z_error = error * (size * self.inverse_det.abs()).min(steepest);
        let mut near_end = z_error + z_error;
        let mut clear = found;
        if let Some(from_error) = ends.from_error {
            near_end += from_error;
            clear = z.abs().simd_gt(near_end);
        }
        let [z_min, z_max] = ends.z;
        clear &= (z.simd_ge(z_min + near_end) | z.simd_le(z_min - near_end))
            & (z.simd_le(z_max - near_end) | z.simd_ge(z_max + near_end));
        let mut judged = found & (!on_piece(simd, self.st) | !clear);
        if !certified {
            // Rounding of a parameter must be small against the error: no certificate has looked at it.
            judged |= found & !(f64x8::splat(simd, COARSEST) * self.speed).simd_le(error);
        }
        let acceptable = found & !judged & z.simd_gt(z_min);
        Verdict { size, z_error, judged, acceptable, near_end }
    }
}

/// The sum of the components' sizes: no less than the length.
#[inline(always)]
fn sum_of_sizes<S: Simd>([x, y, z]: [f64x8<S>; 3]) -> f64x8<S> {
    x.abs() + y.abs() + z.abs()
}
