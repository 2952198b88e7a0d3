//! One ray against one leaf, in f64 on the true surface.
//!
//! In the domain that the caller gives there is at most one root: in the widened leaf, where the
//! certificate holds for the ray, or in a part of it, where the ray's own proof does. So where
//! Newton's iteration converges, it has found this one root: a hit if the root lies in the leaf or
//! its slack; else the domain is proved to hold none. A root outside the piece by more than
//! `clearance` is a miss. Other roots outside the piece, or too near an end of the ray or the root
//! it starts on, are left to the scalar search, as is a ray whose iteration does not converge.

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x4};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3};

use super::jet::{Bernstein, NetSums, Powers};
use super::ray::{SingleHit, SingleRay};
use crate::intersect::wide::hit_place::HitPlace;
use crate::intersect::wide::reach::WITH_SLACK;
use crate::intersect::wide::search::convergence::{
    COARSEST, MOST_ROUNDED, MOST_STEPS, PART_OF_ERROR,
};
use crate::intersect::wide::surface::form::{Form, with_degrees, with_numbers};
use crate::intersect::wide::surface::power_lines::MOST_IN_LINE;
use crate::intersect::wide::surface::sums::OneNet;
use crate::intersect::wide::view::Fitted;
use crate::math::bernstein::MAX_DEGREE;
use crate::patch::Leaf;

/// What is searched for in a leaf, from where.
#[derive(Clone, Copy)]
pub(super) struct Search {
    /// The place that the search in f32 has found, in box coordinates.
    pub(super) near: [f32; 2],
    /// The domain with at most one root, in box coordinates.
    pub(super) domain: [[f64; 2]; 2],
    /// Error bound of a point's distance from the ray.
    pub(super) error: f64,
    /// See [`Guess::clearance`](super::ray::Guess::clearance).
    pub(super) clearance: f64,
}

/// The outcome for a ray and a leaf.
#[derive(Clone, Copy)]
pub(super) enum Outcome {
    /// The leaf is proved to be missed.
    Missed,
    /// There is one root, a hit.
    Hit,
    /// A root that the scalar search must judge.
    Undecided,
    /// A root on the piece that is only too near an end of the ray or its start: if trims cut it
    /// off, the leaf is missed, else the scalar search must judge it.
    AtEnd,
    /// Newton's iteration does not converge.
    NotFound,
}

/// Takes Newton's steps in f64 in a domain with at most one root. A hit is put into `found`, all
/// but its leaf: a returned hit would be copied, which stalls. Also returns the number of steps.
///
/// Everything is computed in homogeneous coordinates relative to the origin, `Y = X − o W`: where
/// `n · Y / W` is zero, so is `n · Y`, and no division by the weight is needed on the way.
#[inline(always)]
pub(super) fn finish<S: Simd>(
    simd: S,
    leaf: Fitted<'_>,
    surface: &OneNet<'_>,
    ray: &SingleRay<'_>,
    wanted: &Search,
    found: &mut SingleHit,
) -> (Outcome, u64) {
    // Forms are told apart here, not in the sums: otherwise, what the general degrees need for them
    // would be computed in advance for all.
    let form = Form::of(surface.patch);
    let degree = form.highest_degree();
    if form.by_powers && degree < 4 {
        with_degrees!(form, |P, Q, C| {
            finish_of::<S, Powers<P, Q, C>>(simd, leaf, surface, ray, wanted, found)
        })
    } else if form.by_powers {
        with_numbers!(form, |C| {
            finish_of::<S, Powers<0, 0, C, MOST_IN_LINE>>(simd, leaf, surface, ray, wanted, found)
        })
    } else if degree < 8 {
        with_numbers!(form, |C| {
            finish_of::<S, Bernstein<8, C>>(simd, leaf, surface, ray, wanted, found)
        })
    } else {
        with_numbers!(form, |C| {
            finish_of::<S, Bernstein<{ MAX_DEGREE + 1 }, C>>(
                simd, leaf, surface, ray, wanted, found,
            )
        })
    }
}

/// [`finish`] for one form of sums.
#[simd]
fn finish_of<S: Simd, F: NetSums<S>>(
    simd: S,
    fitted: Fitted<'_>,
    surface: &OneNet<'_>,
    ray: &SingleRay<'_>,
    &Search { near, domain, error, clearance }: &Search,
    found: &mut SingleHit,
) -> (Outcome, u64) {
    let leaf = fitted.leaf;
    let rect = Rectangle::of::<S, F>(leaf);
    let Rectangle { half, middle, inverse_half } = rect;
    let domain = [rect.range(0, domain[0]), rect.range(1, domain[1])];
    let columns = columns(simd, ray);
    let minus_origin = -f64x4::from_slice(simd, &ray.frame.origin.extend(1.0).to_array());
    let bend = f64::from(leaf.fit_bend());

    let mut x = within(middle[0] + f64::from(near[0]) * half[0], domain[0]);
    let mut y = within(middle[1] + f64::from(near[1]) * half[1], domain[1]);
    let most_steps = u64::from(MOST_STEPS);
    for step in 1..=most_steps {
        let sums = F::at(simd, surface, x, y);
        // In the ray's coordinates.
        let [at, a, b] = sums.map(|sum| seen(relative(sum, minus_origin), &columns));
        let determinant = a[0] * b[1] - a[1] * b[0];
        let inverse = 1.0 / determinant;
        let step_x = (at[0] * b[1] - at[1] * b[0]) * inverse;
        let step_y = (a[0] * at[1] - a[1] * at[0]) * inverse;
        let (new_x, new_y) = (x - step_x, y - step_y);

        let weight = sums[0][3];
        let inside = new_x == within(new_x, domain[0]) && new_y == within(new_y, domain[1]);
        let box_step = [step_x * inverse_half[0], step_y * inverse_half[1]];
        let longest = box_step[0].abs().max(box_step[1].abs());
        if inside && has_converged([at, a, b], inverse, bend * longest * longest, error, weight) {
            let within_slack = |new: f64, k: usize| (new - middle[k]).abs() <= WITH_SLACK * half[k];
            if !(within_slack(new_x, 0) && within_slack(new_y, 1)) {
                return (Outcome::Missed, step);
            }
            // The weight follows the same tangent plane as what is divided by it.
            let divisor = weight - sums[1][3] * step_x - sums[2][3] * step_y;
            let z = (at[2] - a[2] * step_x - b[2] * step_y) / divisor;
            // At a pole tangents vanish, and those nearby say nothing about them.
            let tangents = if ray.asks_where() || leaf.has_pole() {
                Tangents::of(F::at(simd, surface, new_x, new_y), 1.0 / weight)
            } else {
                Tangents::after(fitted, sums, box_step, inverse_half)
            };
            let root = FoundRoot { xy: [new_x, new_y], half, z, tangents };
            return (judge::<S, F>(simd, &root, ray, error, clearance, found), step);
        }
        // Steps stay within the domain; NaN becomes a bound.
        x = within(new_x, domain[0]);
        y = within(new_y, domain[1]);
    }
    (Outcome::NotFound, most_steps)
}

/// A leaf's rectangle in the parameters of the sums.
#[derive(Clone, Copy)]
struct Rectangle {
    /// Half its sides, and one over that.
    half: [f64; 2],
    inverse_half: [f64; 2],
    middle: [f64; 2],
}

impl Rectangle {
    #[inline(always)]
    fn of<S: Simd, F: NetSums<S>>(leaf: &Leaf) -> Self {
        let [[s0, s1], [t0, t1]] = leaf.rect();
        let half = [0.5 * F::SIDE * (s1 - s0), 0.5 * F::SIDE * (t1 - t0)];
        let middle = |sum: f64| F::START + 0.5 * F::SIDE * sum;
        let middle = [middle(s0 + s1), middle(t0 + t1)];
        Self { half, inverse_half: [1.0 / half[0], 1.0 / half[1]], middle }
    }

    /// The range of the `k`-th parameter that a range of box coordinates is.
    #[inline(always)]
    fn range(&self, k: usize, [low, high]: [f64; 2]) -> [f64; 2] {
        [self.middle[k] + low * self.half[k], self.middle[k] + high * self.half[k]]
    }
}

/// Whether a point `W (S − o)` is within the error, or will be after a step; `at`, `a` and `b` are
/// the point and its tangents in the ray's coordinates, `inverse` is one over their determinant.
///
/// With the distances `f` from the ray's planes, the step `h` solves `W f + (W f)' h = 0`, that is
/// `f + f' h = −(W' h / W) f`. What it leaves of `f` is that, and what the tangent plane of `S`
/// leaves, no more than `bent`. The former is no more than `bent`, either, but for a part as small
/// as `W' h / W` itself: `|f|` is about `|f' h|`, and the bound `M` of the bend, by Leibniz's rule,
/// is no less than the product of those of the slopes of `S` and `W`, over the weight
/// ([`FitError`](crate::patch::FitError)). Rounding of the step leaves some, too.
#[inline(always)]
fn has_converged(
    [at, a, b]: [[f64; 3]; 3],
    inverse: f64,
    bent: f64,
    error: f64,
    weight: f64,
) -> bool {
    let squared = |of: [f64; 3]| of[0] * of[0] + of[1] * of[1];
    let (residual, most) = (squared(at), error * error * weight * weight);
    let rounded = squared(a) * inverse * (squared(b) * inverse) * residual;
    residual <= most || bent <= PART_OF_ERROR * error && rounded <= MOST_ROUNDED * most
}

/// The surface at a place, by the parameters of the sums.
struct Tangents {
    point: DVec3,
    along_x: DVec3,
    along_y: DVec3,
    cross: DVec3,
}

impl Tangents {
    /// From `X, W` and their derivatives there, and one over the weight at a place close by.
    ///
    /// The tangents are `(W X_x − X W_x) / W²`. To divide by the weight at the place itself they
    /// would have to wait for it. By the other one, a last small step away, both are too long by
    /// one factor: neither the normal nor the angle to the ray changes, only how fine parameters
    /// seem, where a factor of four does not matter.
    #[inline(always)]
    fn of<S: Simd>(sums: [f64x4<S>; 3], inverse_nearby: f64) -> Self {
        let simd = sums[0].simd;
        let all = |number: f64| f64x4::splat(simd, number);
        // Not by its square, which may be too large or too small for a number.
        let [weight, weight_x, weight_y] = sums.map(|sum| all(sum[3] * inverse_nearby));
        let point = sums[0] * all(1.0 / sums[0][3]);
        let along_x = (weight * sums[1] - weight_x * sums[0]) * all(inverse_nearby);
        let along_y = (weight * sums[2] - weight_y * sums[0]) * all(inverse_nearby);
        let vector = |v: f64x4<S>| DVec3::new(v[0], v[1], v[2]);
        let [along_x, along_y] = [vector(along_x), vector(along_y)];
        let cross = along_x.cross(along_y);
        Self { point: vector(point), along_x, along_y, cross }
    }

    /// From the sums before a last small step: the tangents follow the second derivatives, by box
    /// coordinates, in the middle of the leaf's approximation. The point is the one before the step:
    /// rays that ask for any hit do not ask where it is.
    #[inline(always)]
    fn after<S: Simd>(
        Fitted { leaf, weight }: Fitted<'_>,
        sums: [f64x4<S>; 3],
        [step_x, step_y]: [f64; 2],
        inverse_half: [f64; 2],
    ) -> Self {
        let mut tangents = Self::of(sums, 1.0 / sums[0][3]);
        let [xx, xy, yy] = leaf.second_derivatives(weight);
        tangents.along_x -= (xx * step_x + xy * step_y) * inverse_half[0];
        tangents.along_y -= (xy * step_x + yy * step_y) * inverse_half[1];
        tangents.cross = tangents.along_x.cross(tangents.along_y);
        tangents
    }
}

/// Where Newton's iteration has converged.
struct FoundRoot {
    /// The parameters of the sums.
    xy: [f64; 2],
    /// Half the leaf's sides, in these parameters.
    half: [f64; 2],
    /// The distance along the ray.
    z: f64,
    tangents: Tangents,
}

/// Judges whether a root of the leaf is a hit, which is then put into `found`; of a root at an end
/// of the ray, its place is.
///
/// The rules are those of
/// [`Converged::verdict`](crate::intersect::wide::search::newton::Converged::verdict), but that
/// - roots off the piece by more than `clearance` are judged, too: as misses. There, `newton` has
///   dropped them before;
/// - the secant is not capped. It exceeds `1/ε` only for rays along the surface to within rounding:
///   the error along them is larger then, or infinite, and more is left to the scalar search;
/// - whether parameters are fine enough is asked of all roots; of its own, a certificate has shown
///   it.
#[inline(always)]
fn judge<S: Simd, F: NetSums<S>>(
    simd: S,
    root: &FoundRoot,
    ray: &SingleRay<'_>,
    error: f64,
    clearance: f64,
    found: &mut SingleHit,
) -> Outcome {
    let &FoundRoot { xy, half, z, ref tangents } = root;
    let Tangents { point, along_x, along_y, cross } = tangents;
    let size = cross.length();
    // The quotient does not wait for the root.
    let secant = size * (1.0 / cross.dot(ray.frame.axis).abs());
    let z_error = error * secant;
    let reach = ray.start_reach(z_error);
    let [z_min, z_max] = ray.frame.z_range;
    let st = DVec2::from_array(xy.map(|x| (x - F::START) / F::SIDE));
    let on_piece = (0.0..=1.0).contains(&st.x) && (0.0..=1.0).contains(&st.y);
    if !on_piece {
        let [x, y] = [F::SIDE * beyond(st.x) / half[0], F::SIDE * beyond(st.y) / half[1]];
        if x.max(y) > clearance {
            return Outcome::Missed;
        }
    }
    let clear_of_start = ray.start.from.is_none() || z.abs() > reach;
    let clear = (z - z_min).abs() > reach && (z - z_max).abs() > reach && clear_of_start;
    // Rounding of a parameter must be small compared with the error: with a certificate, it is.
    let speed = F::SIDE * (along_x.abs().element_sum() + along_y.abs().element_sum());
    let fine = COARSEST * speed <= error;
    if !(on_piece && fine) {
        return Outcome::Undecided;
    }
    found.place = HitPlace { st, z, z_error, ..found.place };
    if !clear {
        // Without a normal, nothing says how far the root may be off. False for NaN.
        let has_normal = size > 0.0 && reach < f64::INFINITY;
        return if has_normal { Outcome::AtEnd } else { Outcome::Undecided };
    }
    if !(z > z_min && z < z_max) {
        return Outcome::Missed;
    }
    found.point = *point;
    found.set_normal(simd, *cross, size);
    Outcome::Hit
}

/// The columns of the matrix that takes a vector to the ray's coordinates.
#[inline(always)]
fn columns<S: Simd>(simd: S, ray: &SingleRay<'_>) -> [f64x4<S>; 3] {
    let [n1, n2] = ray.frame.normals;
    let axis = ray.frame.axis;
    [
        f64x4::from_slice(simd, &[n1.x, n2.x, axis.x, 0.0]),
        f64x4::from_slice(simd, &[n1.y, n2.y, axis.y, 0.0]),
        f64x4::from_slice(simd, &[n1.z, n2.z, axis.z, 0.0]),
    ]
}

/// A homogeneous vector relative to the origin, of which the opposite is given.
#[inline(always)]
fn relative<S: Simd>(v: f64x4<S>, minus_origin: f64x4<S>) -> f64x4<S> {
    f64x4::splat(v.simd, v[3]).mul_add(minus_origin, v)
}

/// A vector in the ray's coordinates.
#[inline(always)]
fn seen<S: Simd>(v: f64x4<S>, columns: &[f64x4<S>; 3]) -> [f64; 3] {
    let simd = v.simd;
    let xy = columns[1].mul_add(f64x4::splat(simd, v[1]), columns[0] * f64x4::splat(simd, v[0]));
    let xyz = columns[2].mul_add(f64x4::splat(simd, v[2]), xy);
    [xyz[0], xyz[1], xyz[2]]
}

/// How far `s` lies outside the range from 0 to 1; not above zero inside.
#[inline(always)]
fn beyond(s: f64) -> f64 {
    (-s).max(s - 1.0)
}

/// The number, or the nearest bound; the lower one for NaN.
#[inline(always)]
fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    let raised = if x > low { x } else { low };
    if raised < high { raised } else { high }
}
