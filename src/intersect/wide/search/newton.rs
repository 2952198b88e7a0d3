//! Newton's iteration on the true surface, in f64, lane by lane: for some rays and one leaf, or for
//! some pairs of a ray and a leaf.

use fearless_simd::{Select, Simd, SimdMask};
use fearless_simd_macros::simd;

use super::convergence::{COARSEST, MOST_ROUNDED, MOST_STEPS, PART_OF_ERROR};
use crate::intersect::hit::SPARE;
use crate::intersect::wide::reach::WITH_SLACK;
use crate::intersect::wide::surface::sums::Jets;
use crate::intersect::wide::vectors::{Reals, cross_d, dot_d, sum_of_sizes};
use crate::patch::LEAF_SLACK;

/// The largest accepted bound, in radians, of the normal's error after a last step; above it the
/// normal is evaluated where the step led. With 1e-10 normals were seen to be off by 1.2e-11.
const MOST_TURN: f64 = 5e-12;

/// The longest step, in half sides, of which anything is claimed: in longer ones rounding of second
/// derivatives might count. In flat leaves, which are not searched in f32, a start in the leaf's box
/// is off by as much as the box is wider than the leaf: by the slack, which is a part of a whole
/// side.
const LONGEST_STEP: f64 = 4e-3;
const _: () = assert!(LONGEST_STEP > 2.0 * LEAF_SLACK);

/// A leaf for each lane, and the surfaces that they approximate.
pub(crate) trait Leaves<S: Simd, V: Reals<S>> {
    /// Points, first and second derivatives.
    fn jets(&self, simd: S, st: &[V; 2]) -> Jets<V>;

    /// Points and first derivatives only.
    fn tangents(&self, simd: S, st: &[V; 2]) -> Jets<V>;

    /// Half the sides of the leaves' rectangles, one over that, and their middles.
    fn half(&self, simd: S) -> [V; 2];
    fn per_half(&self, simd: S) -> [V; 2];
    fn middle(&self, simd: S) -> [V; 2];

    /// The domain with at most one root: from and to in `s`, then in `t`.
    fn domain(&self, simd: S) -> [V; 4];

    /// `M` and `T` of [`FitError`](crate::patch::FitError).
    fn bend(&self, simd: S) -> V;
    fn third(&self, simd: S) -> V;

    /// Error bounds of points on the surfaces themselves, whatever the rays.
    fn own_error(&self, simd: S) -> V;

    /// Whether points and normals are asked for; otherwise what is found of them only serves error
    /// bounds.
    fn asks_places(&self) -> bool;

    /// How far beyond a side of the piece, in box coordinates, a root must lie for all of the piece
    /// in the domain to be missed; infinite where nothing is known.
    fn clearance<R: Rays<S, V>>(&self, simd: S, rays: &R) -> V;

    /// The lanes whose next step surely leads away from the leaf, so that the leaf is missed; none
    /// where no certificate shows that.
    fn surely_away<R: Rays<S, V>>(&self, simd: S, rays: &R, step: &Step<V>) -> V::Mask;
}

/// A ray for each lane. Data are read when they are asked for: there are not enough registers to hold them.
pub(crate) trait Rays<S: Simd, V: Reals<S>> {
    fn origin(&self, simd: S) -> [V; 3];

    /// The unit directions.
    fn axis(&self, simd: S) -> [V; 3];

    /// The normals of two planes through each ray.
    fn normals(&self, simd: S) -> [[V; 3]; 2];

    /// Error bound of a point's distance from the ray.
    fn error(&self) -> V;

    /// The distances of points from the planes.
    #[inline(always)]
    fn distances(&self, simd: S, point: [V; 3]) -> [V; 2] {
        let (origin, [n1, n2]) = (self.origin(simd), self.normals(simd));
        let from = [point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]];
        [dot_d(n1, from), dot_d(n2, from)]
    }
}

/// A step of the iteration, by first derivatives alone.
#[derive(Clone, Copy)]
pub(crate) struct Step<V> {
    /// Where it starts, and by how much it goes back.
    pub at: [V; 2],
    pub by: [V; 2],
    /// The distances from the ray's planes where it starts.
    pub distances: [V; 2],
}

/// Where the iteration has converged.
#[derive(Clone, Copy)]
pub(crate) struct Converged<S: Simd, V: Reals<S>> {
    /// The lanes that have converged.
    pub found: V::Mask,
    /// The lanes that should have converged but have not.
    pub unconverged: V::Mask,
    /// The lanes whose points and normals are known.
    known: V::Mask,
    pub st: [V; 2],
    /// The distance along the ray.
    pub z: V,
    pub point: [V; 3],
    /// `S_s × S_t`, and an upper bound of the sum of the lengths of `S_s` and `S_t`.
    pub cross: [V; 3],
    pub speed: V,
    /// One over the determinant of the tangents in the ray's planes.
    pub inverse_det: V,
    /// Steps taken, over all lanes.
    pub steps: u32,
}

/// Where a step from a place leads, and what is known of it.
#[derive(Clone, Copy)]
struct Landed<S: Simd, V: Reals<S>> {
    /// The lanes that have converged there, and those whose points and normals are known.
    done: V::Mask,
    known: V::Mask,
    st: [V; 2],
    step: Step<V>,
    /// As in [`Converged`].
    z: V,
    point: [V; 3],
    cross: [V; 3],
    speed: V,
    inverse_det: V,
}

/// Takes Newton's steps for the `wanted` lanes, from what the search in f32 has found.
///
/// Each of these rays has at most one root in the domain. So a lane that converges has found its
/// one root. It is `found` if the root lies in the leaf or its slack; else that part of the leaf is
/// proved to be missed. That part is also missed where the root lies so far beyond a side of the
/// piece that no point of the piece is within the error (`clearance`), and where a step surely
/// leads away (`surely_away`).
///
/// Steps use second derivatives, too (Chebyshev's method): they leave the third power of their
/// length, and as the search in f32 ends within about 1e-5 half sides (in flat leaves the bend is
/// small instead), as a rule the first step is the last. (One step with first derivatives alone, and
/// another from where it leads, take longer than one with both.)
#[inline(always)] // what goes in and out are dozens of vectors
pub(crate) fn newton<S: Simd, V: Reals<S>, T: Leaves<S, V>, R: Rays<S, V>>(
    simd: S,
    leaves: &T,
    rays: &R,
    wanted: V::Mask,
    [x, y]: &[V; 2],
) -> Converged<S, V> {
    let ([half_s, half_t], [middle_s, middle_t]) = (leaves.half(simd), leaves.middle(simd));
    let place = [x.mul_add(half_s, middle_s), y.mul_add(half_t, middle_t)];
    let at = within(place, leaves.domain(simd));
    let landed = land(simd, leaves, rays, &at);
    let mut root = Converged {
        found: landed.done & wanted,
        unconverged: !landed.done & wanted,
        known: landed.known,
        st: landed.st,
        z: landed.z,
        point: landed.point,
        cross: landed.cross,
        speed: landed.speed,
        inverse_det: landed.inverse_det,
        steps: wanted.to_bitmask().count_ones(),
    };
    if root.unconverged.any_true() {
        // Copies: a variable whose address is passed on is kept in memory, even where the function
        // is not called.
        let so_far = (root, landed);
        let later = go_on(simd, leaves, rays, &so_far);
        root = later;
    }

    // The leaf and its slack.
    let reach = V::splat(simd, WITH_SLACK);
    root.found &= (root.st[0] - middle_s).abs().simd_le(half_s * reach)
        & (root.st[1] - middle_t).abs().simd_le(half_t * reach);
    if (root.found & !on_piece(simd, root.st)).any_true() {
        let st = root.st;
        root.found &= !beyond_piece(simd, leaves, rays, &st);
    }
    let unknown = root.found & !root.known;
    if leaves.asks_places() && unknown.any_true() {
        let st = root.st;
        let [point, cross] = looked_at(simd, leaves, &st);
        for i in 0..3 {
            root.point[i] = unknown.select(point[i], root.point[i]);
            root.cross[i] = unknown.select(cross[i], root.cross[i]);
        }
    }
    root
}

/// Points and `S_s × S_t` at some places.
#[cold]
#[simd]
fn looked_at<S: Simd, V: Reals<S>, T: Leaves<S, V>>(
    simd: S,
    leaves: &T,
    st: &[V; 2],
) -> [[V; 3]; 2] {
    let Jets { point, first: [ds, dt], .. } = leaves.tangents(simd, st);
    [point, cross_d(ds, dt)]
}

/// The places that lie on the piece.
#[inline(always)]
fn on_piece<S: Simd, V: Reals<S>>(simd: S, [s, t]: [V; 2]) -> V::Mask {
    let (low, high) = (V::splat(simd, 0.0), V::splat(simd, 1.0));
    s.simd_ge(low) & s.simd_le(high) & t.simd_ge(low) & t.simd_le(high)
}

/// The roots that lie so far beyond a side of the piece that the piece is missed there.
#[cold]
#[simd]
fn beyond_piece<S: Simd, V: Reals<S>, T: Leaves<S, V>, R: Rays<S, V>>(
    simd: S,
    leaves: &T,
    rays: &R,
    [s, t]: &[V; 2],
) -> V::Mask {
    let high = V::splat(simd, 1.0);
    let [sides_s, sides_t] = leaves.per_half(simd);
    let over_s = (-*s).max(*s - high) * sides_s;
    let over_t = (-*t).max(*t - high) * sides_t;
    over_s.max(over_t).simd_gt(leaves.clearance(simd, rays))
}

/// Moves places into the domain with at most one root; NaN becomes a bound, or stays: then nothing
/// converges.
#[inline(always)]
fn within<S: Simd, V: Reals<S>>([s, t]: [V; 2], domain: [V; 4]) -> [V; 2] {
    [s.max(domain[0]).min(domain[1]), t.max(domain[2]).min(domain[3])]
}

/// Takes a step from a place.
///
/// With the distances `f` there, their first derivatives `J` and second ones `H`, the step leads
/// back by `h + e`, where `J h = f` and `J e = ½ H[h, h]`. Let `d` be no less than the sizes of
/// both together. What is left of the distances is then `H[h, e] + ½ H[e, e]` (at most
/// `2 M d |e|`), what second derivatives leave of the surface (at most `T d³`), and the rounding
/// error of the step ([`MOST_ROUNDED`]). Of both tangents together, as they are taken along the
/// step, `2 M |e| + 3 T d²` is left. ([`FitError`](crate::patch::FitError) defines `M` and `T`.)
/// What is left of one tangent turns the normal by its part along the normal, times the length of
/// the other tangent, over their cross product.
#[inline(always)]
fn land<S: Simd, V: Reals<S>, T: Leaves<S, V>, R: Rays<S, V>>(
    simd: S,
    leaves: &T,
    rays: &R,
    st: &[V; 2],
) -> Landed<S, V> {
    let Jets { point: start, first: [ds, dt], second: [dss, dst, dtt] } = leaves.jets(simd, st);
    let [s, t] = *st;
    let [f1, f2] = rays.distances(simd, start);
    let [n1, n2] = rays.normals(simd);
    let (a1, a2) = (dot_d(n1, ds), dot_d(n2, ds));
    let (b1, b2) = (dot_d(n1, dt), dot_d(n2, dt));
    let inverse_det = V::splat(simd, 1.0) / (a1 * b2 - a2 * b1);
    let slopes = [[a1, a2], [b1, b2]];

    // Converged where the residual is within the error, or will be after this step, as far as
    // rounding allows. (A step from a place that is within the error leaves next to nothing of the
    // residual: the step is no longer than half the leaf's slack, and no certificate holds for rays
    // that are flatter than the surface turns along the step. A ray's own proof bounds both alike:
    // see `MOST_NOISE`.)
    let error = rays.error();
    let (residual, squared) = (f1.mul_add(f1, f2 * f2), error * error);
    let close = residual.simd_le(squared);
    let (along_s, along_t) = (a1.mul_add(a1, a2 * a2), b1.mul_add(b1, b2 * b2));
    let rounded = residual * (along_s * inverse_det) * (along_t * inverse_det);
    let well = rounded.simd_le(squared * V::splat(simd, MOST_ROUNDED));

    // The step by first derivatives, and what second ones add.
    let step = solved(slopes, inverse_det, [f1, f2]);
    let Turned { tangents, moved } = turned(simd, [ds, dt], [dss, dst, dtt], step);
    let more = solved(slopes, inverse_det, [dot_d(n1, moved), dot_d(n2, moved)]);
    let (all_s, all_t) = (step[0] + more[0], step[1] + more[1]);
    let (new_s, new_t) = (s - all_s, t - all_t);
    let cross = cross_d(tangents[0], tangents[1]);
    let Trusted { straight, known } = trusted(simd, leaves, [step, more], (tangents, cross), error);
    let domain = leaves.domain(simd);
    let inside = new_s.simd_ge(domain[0])
        & new_s.simd_le(domain[1])
        & new_t.simd_ge(domain[2])
        & new_t.simd_le(domain[3]);

    let (origin, axis) = (rays.origin(simd), rays.axis(simd));
    let (mut point, mut z) = (start, V::splat(simd, 0.0));
    for i in 0..3 {
        point[i] = start[i] - ds[i] * all_s - dt[i] * all_t + moved[i];
        z = axis[i].mul_add(point[i] - origin[i], z);
    }
    Landed {
        // False for NaN, of which nothing is known.
        done: (close | well & straight) & inside,
        known,
        st: [new_s, new_t],
        step: Step { at: [s, t], by: step, distances: [f1, f2] },
        z,
        point,
        cross,
        speed: sum_of_sizes(ds) + sum_of_sizes(dt),
        inverse_det,
    }
}

/// How the tangents turn along a step back.
struct Turned<V> {
    /// The tangents where the step leads.
    tangents: [[V; 3]; 2],
    /// How far their turning moves the point: `½ H[h, h]`.
    moved: [V; 3],
}

#[inline(always)]
fn turned<S: Simd, V: Reals<S>>(
    simd: S,
    mut tangents: [[V; 3]; 2],
    [dss, dst, dtt]: [[V; 3]; 3],
    [step_s, step_t]: [V; 2],
) -> Turned<V> {
    let half = V::splat(simd, 0.5);
    let (half_s, half_t) = (step_s * half, step_t * half);
    let mut moved = [V::splat(simd, 0.0); 3];
    for i in 0..3 {
        let turn_s = dss[i].mul_add(step_s, dst[i] * step_t);
        let turn_t = dst[i].mul_add(step_s, dtt[i] * step_t);
        tangents[0][i] -= turn_s;
        tangents[1][i] -= turn_t;
        moved[i] = turn_s.mul_add(half_s, turn_t * half_t);
    }
    Turned { tangents, moved }
}

/// How far second derivatives may be trusted: the lanes where what they leave of the distances is a
/// small part of the `error`, and those where what they leave of the point is a small part of the
/// surface's own error (the ray's is far larger if it comes from far away), and what they leave of
/// the normal next to nothing.
struct Trusted<S: Simd, V: Reals<S>> {
    straight: V::Mask,
    known: V::Mask,
}

/// Judges a step by first derivatives, what second ones add to it, and the tangents where both
/// lead.
#[inline(always)]
fn trusted<S: Simd, V: Reals<S>, T: Leaves<S, V>>(
    simd: S,
    leaves: &T,
    [step, more]: [[V; 2]; 2],
    ([along_s, along_t], cross): ([[V; 3]; 2], [V; 3]),
    error: V,
) -> Trusted<S, V> {
    let ([half_s, half_t], per_half) = (leaves.half(simd), leaves.per_half(simd));
    let more = half_sides(more, per_half);
    let longest = half_sides(step, per_half) + more;
    let (bend, third) = (leaves.bend(simd), leaves.third(simd) * longest * longest);
    let turned_back = (bend + bend) * more;
    let part = V::splat(simd, PART_OF_ERROR);
    let short = longest.simd_le(V::splat(simd, LONGEST_STEP));
    let left = longest * (turned_back + third);
    let straight = short & left.simd_le(error * part);
    let on_surface = short & left.simd_le(leaves.own_error(simd) * part);

    let off = third.mul_add(V::splat(simd, 3.0), turned_back);
    let (squared_s, squared_t) = (half_s * half_s, half_t * half_t);
    let longer = (squared_s * dot_d(along_s, along_s)).max(squared_t * dot_d(along_t, along_t));
    let most = V::splat(simd, MOST_TURN * MOST_TURN) * (squared_s * squared_t);
    let known = on_surface & (off * off * longer).simd_le(most * dot_d(cross, cross));
    Trusted { straight, known }
}

/// The solution of `J h = f`, with the columns of `J` and one over its determinant.
#[inline(always)]
fn solved<S: Simd, V: Reals<S>>(
    [[a1, a2], [b1, b2]]: [[V; 2]; 2],
    inverse_det: V,
    [f1, f2]: [V; 2],
) -> [V; 2] {
    [(f1 * b2 - f2 * b1) * inverse_det, (a1 * f2 - a2 * f1) * inverse_det]
}

/// The length of a step in half sides: the larger of its two components.
#[inline(always)]
fn half_sides<S: Simd, V: Reals<S>>([s, t]: [V; 2], [per_half_s, per_half_t]: [V; 2]) -> V {
    (s * per_half_s).abs().max((t * per_half_t).abs())
}

/// Takes the steps that follow, for lanes that have not converged.
#[cold]
#[simd]
fn go_on<S: Simd, V: Reals<S>, T: Leaves<S, V>, R: Rays<S, V>>(
    simd: S,
    leaves: &T,
    rays: &R,
    so_far: &(Converged<S, V>, Landed<S, V>),
) -> Converged<S, V> {
    let (mut root, mut landed) = *so_far;
    for step in 1..=MOST_STEPS {
        root.unconverged &= !leaves.surely_away(simd, rays, &landed.step);
        if step == MOST_STEPS || root.unconverged.all_false() {
            break;
        }
        root.steps += root.unconverged.to_bitmask().count_ones();
        landed = land(simd, leaves, rays, &within(landed.st, leaves.domain(simd)));
        let new = landed.done & root.unconverged;
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
        root.known = landed.known & new | root.known & !new;
        root.found |= new;
        root.unconverged &= !new;
    }
    root
}

/// The ranges of rays in which hits count.
#[derive(Clone, Copy)]
pub(crate) struct Ends<V> {
    /// From and to.
    pub z: [V; 2],
    /// Error bounds of the roots that rays start on, if any ray starts on one.
    pub from_error: Option<V>,
}

/// The judgement of roots that were found.
#[derive(Clone, Copy)]
pub(crate) struct Verdict<S: Simd, V: Reals<S>> {
    /// The length of `S_s × S_t`.
    pub size: V,
    /// Error bound of `z`.
    pub z_error: V,
    /// The roots that the scalar search must judge.
    pub undecided: V::Mask,
    /// Those of them that lie on the piece, and are only too near an end of the ray or its start:
    /// if trims cut them off, nothing is left to be judged.
    pub at_end: V::Mask,
    /// The roots beyond the beginning of the ray's range; the caller knows where it ends for now.
    pub acceptable: V::Mask,
    /// The distance along the ray within which a root cannot be told from an end or another hit.
    pub near_end: V,
}

impl<S: Simd, V: Reals<S>> Converged<S, V> {
    /// Evaluates the points and the normals at the places themselves.
    #[inline(always)]
    pub(crate) fn look<T: Leaves<S, V>>(&mut self, simd: S, leaves: &T) {
        let Jets { point, first: [ds, dt], .. } = leaves.tangents(simd, &self.st);
        (self.point, self.cross) = (point, cross_d(ds, dt));
    }

    /// Judges the roots. Those just outside the piece, or too near the ray's ends, are left to the
    /// scalar search.
    #[inline(always)]
    pub(crate) fn verdict(
        &self,
        simd: S,
        ends: &Ends<V>,
        error: V,
        certified: bool,
    ) -> Verdict<S, V> {
        let (found, z) = (self.found, self.z);
        // One over the cosine is `|a × b| / det`.
        let size = dot_d(self.cross, self.cross).sqrt();
        let steepest = V::splat(simd, 1.0 / f64::EPSILON);
        let z_error = error * (size * self.inverse_det.abs()).min(steepest);
        let mut near_end = z_error * V::splat(simd, SPARE);
        let mut clear = found;
        if let Some(from_error) = ends.from_error {
            near_end += from_error;
            clear = z.abs().simd_gt(near_end);
        }
        let [z_min, z_max] = ends.z;
        clear &= (z.simd_ge(z_min + near_end) | z.simd_le(z_min - near_end))
            & (z.simd_le(z_max - near_end) | z.simd_ge(z_max + near_end));
        let mut known = found & on_piece(simd, self.st);
        if !certified {
            // Rounding of a parameter must be small compared with the error; no certificate has
            // checked that.
            known &= (V::splat(simd, COARSEST) * self.speed).simd_le(error);
        }
        let undecided = found & !(known & clear);
        // Without a normal, nothing says how far the root may be off. False for NaN.
        let infinity = V::splat(simd, f64::INFINITY);
        let has_normal = size.simd_gt(V::splat(simd, 0.0)) & near_end.simd_lt(infinity);
        let at_end = known & !clear & has_normal;
        let acceptable = found & !undecided & z.simd_gt(z_min);
        Verdict { size, z_error, undecided, at_end, acceptable, near_end }
    }
}
