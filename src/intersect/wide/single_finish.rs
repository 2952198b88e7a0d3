//! One ray against one leaf, in f64 on the true surface.
//!
//! The ray is certified: it meets the widened leaf at most once. So where Newton's iteration
//! converges it has found the one root: a hit if that lies in the leaf or its slack, else the
//! leaf is proved to be missed. Roots outside the piece, or too near an end of the ray or the
//! root it starts on, are left to the scalar search, as is what does not converge.

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x4};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec4};

use super::single_ray::{REACH, SingleHit, SingleRay};
use crate::math::bernstein::MAX_DEGREE;
use crate::math::rounding::UNIT_ROUNDOFF;
use crate::patch::{Leaf, TensorPatch};

/// Steps in f64: one or two are usual after the search in f32.
const MOST_STEPS: u64 = 4;

/// How much of the promised error a last step may leave behind.
const PART_OF_ERROR: f64 = 0.125;

/// Parameters are rounded by half a unit. What that moves a point by may be a quarter of the
/// promised error, for the sum of both speeds times this.
pub(super) const COARSEST: f64 = 2.0 * UNIT_ROUNDOFF;

/// What became of a ray and a leaf.
pub(super) enum Outcome {
    /// Proved to be missed.
    Missed,
    /// The one root there is.
    Hit(SingleHit),
    /// A root that the scalar search must judge.
    Undecided,
    /// Newton's iteration does not converge.
    NotFound,
}

/// Newton's steps in f64 from a start in box coordinates, in a domain where there is one root
/// at most; `error` is how far a point may be from the ray. Also returns the number of steps.
///
/// All is done in homogeneous coordinates relative to the origin, `Y = X − o W`: where
/// `n · Y / W` is zero, so is `n · Y`, and the weight need not be divided by on the way.
#[simd]
pub(super) fn finish<S: Simd>(
    simd: S,
    leaf: &Leaf,
    patch: &TensorPatch,
    ray: &SingleRay<'_>,
    task: ([f32; 2], [[f64; 2]; 2], f64),
) -> (Outcome, u64) {
    // Told apart here, not in the sums: what the general degrees need for them would be worked
    // out in advance for all.
    match patch.degree() {
        [3, 3] => finish_of::<S, 3, 3, 4>(simd, leaf, patch, ray, task),
        [2, 2] => finish_of::<S, 2, 2, 4>(simd, leaf, patch, ray, task),
        [2, 1] => finish_of::<S, 2, 1, 4>(simd, leaf, patch, ray, task),
        [1, 2] => finish_of::<S, 1, 2, 4>(simd, leaf, patch, ray, task),
        [1, 1] => finish_of::<S, 1, 1, 4>(simd, leaf, patch, ray, task),
        [p, q] if p.max(q) < 8 => finish_of::<S, 0, 0, 8>(simd, leaf, patch, ray, task),
        _ => finish_of::<S, 0, 0, { MAX_DEGREE + 1 }>(simd, leaf, patch, ray, task),
    }
}

/// [`finish`] for degrees `P` and `Q`, zero standing for any degree below `N`.
#[simd]
fn finish_of<S: Simd, const P: usize, const Q: usize, const N: usize>(
    simd: S,
    leaf: &Leaf,
    patch: &TensorPatch,
    ray: &SingleRay<'_>,
    (start, domain, error): ([f32; 2], [[f64; 2]; 2], f64),
) -> (Outcome, u64) {
    let [s_range, t_range] = leaf.rect();
    let (half_s, half_t) = (0.5 * (s_range[1] - s_range[0]), 0.5 * (t_range[1] - t_range[0]));
    let (mid_s, mid_t) = (0.5 * (s_range[0] + s_range[1]), 0.5 * (t_range[0] + t_range[1]));
    let mut x = within(f64::from(start[0]), domain[0]);
    let mut y = within(f64::from(start[1]), domain[1]);
    let columns = columns(simd, ray);
    let origin = f64x4::from_slice(simd, &ray.frame.origin.extend(1.0).to_array());
    let bend = f64::from(leaf.fit_bend());

    for step in 1..=MOST_STEPS {
        let (s, t) = (mid_s + x * half_s, mid_t + y * half_t);
        let sums = sums::<S, P, Q, N>(simd, patch, s, t);
        // In the ray's coordinates, by box coordinate.
        let at = seen(relative(sums[0], origin), &columns);
        let a = seen(relative(sums[1], origin) * f64x4::splat(simd, half_s), &columns);
        let b = seen(relative(sums[2], origin) * f64x4::splat(simd, half_t), &columns);
        let inverse = 1.0 / (a[0] * b[1] - a[1] * b[0]);
        let step_x = (at[0] * b[1] - at[1] * b[0]) * inverse;
        let step_y = (a[0] * at[1] - a[1] * at[0]) * inverse;
        let (new_x, new_y) = (x - step_x, y - step_y);

        // Converged where the residual is within the error, or will be after this step: the
        // bend bounds what the tangent plane leaves of it.
        let longest = step_x.abs().max(step_y.abs());
        let weight = sums[0][3];
        let close = at[0] * at[0] + at[1] * at[1] <= error * error * weight * weight;
        let inside = new_x == within(new_x, domain[0]) && new_y == within(new_y, domain[1]);
        if inside && (close || bend * longest * longest <= PART_OF_ERROR * error) {
            if !(new_x.abs() <= REACH && new_y.abs() <= REACH) {
                return (Outcome::Missed, step);
            }
            let st = DVec2::new(s - step_x * half_s, t - step_y * half_t);
            let weights = [weight, sums[1][3] * half_s, sums[2][3] * half_t];
            let step_of = DVec2::new(step_x, step_y);
            let found = Converged { st, half: [half_s, half_t], step: step_of, weights, at, a, b };
            return (judge(&found, ray, error), step);
        }
        // Steps stay within the domain; NaN becomes a bound.
        x = within(new_x, domain[0]);
        y = within(new_y, domain[1]);
    }
    (Outcome::NotFound, MOST_STEPS)
}

/// Where Newton's iteration has converged.
struct Converged {
    /// After the last step.
    st: DVec2,
    /// Half the leaf's sides.
    half: [f64; 2],
    /// The last step, in box coordinates.
    step: DVec2,
    /// The weight before it and its derivatives by box coordinates; and the homogeneous sums as
    /// the ray sees them.
    weights: [f64; 3],
    at: [f64; 3],
    a: [f64; 3],
    b: [f64; 3],
}

/// Whether a root of the leaf is a hit.
#[inline(always)]
fn judge(found: &Converged, ray: &SingleRay<'_>, error: f64) -> Outcome {
    let Converged { st, half, step, weights, at, a, b } = found;
    // What is left of the distance is taken off along the tangent plane.
    let [weight, along_x, along_y] = weights;
    let moved = weight - along_x * step.x - along_y * step.y;
    let z = (at[2] - a[2] * step.x - b[2] * step.y) / moved;

    // Errors along the ray grow with the angle: the tangents less their part along the ray.
    let (wx, wy) = (along_x / weight, along_y / weight);
    let across = [a[2] - wx * at[2], b[2] - wy * at[2]];
    let cross = [
        a[1] * across[1] - across[0] * b[1],
        across[0] * b[0] - a[0] * across[1],
        a[0] * b[1] - a[1] * b[0],
    ];
    let size = (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).sqrt();
    let z_error = error * size / cross[2].abs();
    let reach = ray.start_reach(z_error);
    let [z_min, z_max] = ray.frame.z_range;
    let on_piece = (0.0..=1.0).contains(&st.x) && (0.0..=1.0).contains(&st.y);
    let clear = (z - z_min).abs() > reach && (z - z_max).abs() > reach && z.abs() > reach;
    // Rounding of a parameter must be small against the error: no certificate has looked at it.
    let speed = |tangent: &[f64; 3], along: f64| tangent[0].abs() + tangent[1].abs() + along.abs();
    let speed = speed(a, across[0]) * half[1] + speed(b, across[1]) * half[0];
    let fine = COARSEST * speed <= error * weight * half[0] * half[1];
    if !(on_piece && clear && fine) {
        return Outcome::Undecided;
    }
    if !(z > z_min && z < z_max) {
        return Outcome::Missed;
    }
    Outcome::Hit(SingleHit { leaf: 0, z, z_error, st: *st })
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

/// A homogeneous vector relative to the origin.
#[inline(always)]
fn relative<S: Simd>(v: f64x4<S>, origin: f64x4<S>) -> f64x4<S> {
    v - origin * f64x4::splat(v.simd, v[3])
}

/// A vector in the ray's coordinates.
#[inline(always)]
fn seen<S: Simd>(v: f64x4<S>, columns: &[f64x4<S>; 3]) -> [f64; 3] {
    let simd = v.simd;
    let xy = columns[1].mul_add(f64x4::splat(simd, v[1]), columns[0] * f64x4::splat(simd, v[0]));
    let xyz = columns[2].mul_add(f64x4::splat(simd, v[2]), xy);
    [xyz[0], xyz[1], xyz[2]]
}

/// `X, W` and their derivatives by `s` and by `t`: the same sums as in [`TensorPatch::jet`],
/// lanes for the coordinates.
#[inline(always)]
fn sums<S: Simd, const P: usize, const Q: usize, const N: usize>(
    simd: S,
    patch: &TensorPatch,
    s: f64,
    t: f64,
) -> [f64x4<S>; 3] {
    let [p, q] = if P == 0 { patch.degree() } else { [P, Q] };
    let (bs, ds) = basis::<N>(p, s);
    let (bt, dt) = basis::<N>(q, t);
    let zero = f64x4::splat(simd, 0.0);
    let (mut value, mut along_s, mut along_t) = (zero, zero, zero);
    for i in 0..=p {
        let row = patch.row(i);
        let (mut sum, mut slope) = (zero, zero);
        for j in 0..=q {
            let control = load(simd, row[j]);
            sum = control.mul_add(f64x4::splat(simd, bt[j]), sum);
            slope = control.mul_add(f64x4::splat(simd, dt[j]), slope);
        }
        value = sum.mul_add(f64x4::splat(simd, bs[i]), value);
        along_s = sum.mul_add(f64x4::splat(simd, ds[i]), along_s);
        along_t = slope.mul_add(f64x4::splat(simd, bs[i]), along_t);
    }
    [value, along_s, along_t]
}

#[inline(always)]
fn load<S: Simd>(simd: S, control: DVec4) -> f64x4<S> {
    f64x4::from_slice(simd, &control.to_array())
}

/// Bernstein functions and their derivatives: those of one degree less, then the recurrence.
#[inline(always)]
fn basis<const N: usize>(degree: usize, t: f64) -> ([f64; N], [f64; N]) {
    let rest = 1.0 - t;
    let mut lower = [0.0; N];
    let mut power = 1.0;
    let mut binomial = 1.0;
    for i in 0..degree {
        lower[i] = power * binomial;
        power *= t;
        binomial *= (degree - 1 - i) as f64 / (i + 1) as f64;
    }
    power = 1.0;
    for i in (0..degree).rev() {
        lower[i] *= power;
        power *= rest;
    }
    let p = degree as f64;
    let mut values = [0.0; N];
    let mut slopes = [0.0; N];
    values[0] = rest * lower[0];
    slopes[0] = -p * lower[0];
    for i in 1..degree {
        values[i] = rest * lower[i] + t * lower[i - 1];
        slopes[i] = p * (lower[i - 1] - lower[i]);
    }
    values[degree] = t * lower[degree - 1];
    slopes[degree] = p * lower[degree - 1];
    (values, slopes)
}

/// The number, or the nearest bound; the lower one for NaN.
#[inline(always)]
fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    let raised = if x > low { x } else { low };
    if raised < high { raised } else { high }
}
