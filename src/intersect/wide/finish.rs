//! Eight rays against one leaf, in f64 on the true surface.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x8, mask64x8};
use fearless_simd_macros::simd;

use super::packet::Packet;
use super::search::load3d;
use crate::math::bernstein::MAX_DEGREE;
use crate::patch::{LEAF_SLACK, Leaf, Piece, TensorPatch, WIDENING};

/// Steps in f64: one or two are usual after the search in f32.
const MOST_STEPS: usize = 4;

/// A leaf, its piece, and which leaf it is.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) leaf: &'a Leaf,
    pub(super) piece: &'a Piece,
    pub(super) index: u32,
    /// Half the second derivative's bound by box coordinates; see the search record.
    pub(super) bend: f64,
}

/// Eight lanes' Jacobian data.
struct Jets<S: Simd> {
    point: [f64x8<S>; 3],
    ds: [f64x8<S>; 3],
    dt: [f64x8<S>; 3],
}

/// Newton's steps in f64 for rays `base … base + 7`, of which `wanted` take part, from a
/// start in box coordinates; hits nearer than those known are put into the packet.
///
/// All of these rays are certified: they meet the widened leaf at most once. So a lane that
/// converges has found its one root: it is a hit if it lies in the leaf or its slack, else
/// the leaf is proved to be missed. Returns the lanes the scalar search must look at: those
/// that did not converge, and those whose hit lies outside the piece or too near an end of
/// the ray.
#[simd]
pub(super) fn finish<S: Simd>(
    simd: S,
    target: &Target<'_>,
    packet: &mut Packet,
    base: usize,
    wanted: mask64x8<S>,
    start: (f64x8<S>, f64x8<S>),
) -> u64 {
    let [s_range, t_range] = target.leaf.rect;
    let splat = |x: f64| f64x8::splat(simd, x);
    let half = |range: [f64; 2]| splat(0.5 * (range[1] - range[0]));
    let middle = |range: [f64; 2]| splat(0.5 * (range[0] + range[1]));
    let (half_s, half_t) = (half(s_range), half(t_range));
    let mut s = start.0.mul_add(half_s, middle(s_range));
    let mut t = start.1.mul_add(half_t, middle(t_range));

    let origin = load3d(simd, &packet.origin, base);
    let axis = load3d(simd, &packet.axis, base);
    let n1 = load3d(simd, &packet.normals[0], base);
    let n2 = load3d(simd, &packet.normals[1], base);
    let magnitude = f64x8::from_slice(simd, &packet.magnitude[base..base + 8]);
    let patch = &target.piece.patch;
    let error = splat(patch.residual_factor()) * magnitude.max(splat(patch.magnitude()));
    let dot = |n: &[f64x8<S>; 3], v: &[f64x8<S>; 3]| {
        n[0].mul_add(v[0], n[1].mul_add(v[1], n[2] * v[2]))
    };

    let zero = splat(0.0);
    let mut open = wanted;
    let mut found = simd.splat_mask64x8(false);
    let (mut root_s, mut root_t, mut z) = (zero, zero, zero);
    let mut point = [zero; 3];
    let mut cross = [zero; 3];
    let bend = splat(target.bend);
    for _ in 0..MOST_STEPS {
        let jets = jets(simd, patch, s, t);
        let from_origin = [0, 1, 2].map(|i| jets.point[i] - origin[i]);
        let (f1, f2) = (dot(&n1, &from_origin), dot(&n2, &from_origin));
        let (a1, a2) = (dot(&n1, &jets.ds), dot(&n2, &jets.ds));
        let (b1, b2) = (dot(&n1, &jets.dt), dot(&n2, &jets.dt));
        let inverse = splat(1.0) / (a1 * b2 - a2 * b1);
        let step_s = (f1 * b2 - f2 * b1) * inverse;
        let step_t = (a1 * f2 - a2 * f1) * inverse;

        // Converged where the residual is within the error, or will be after this step: what
        // a step leaves is at most `bend · step²`. The step itself is taken along the
        // tangent plane, also for the point.
        let largest = (step_s.abs() / half_s).max(step_t.abs() / half_t);
        let left = bend * largest * largest;
        let residual = f1.mul_add(f1, f2 * f2);
        let done = residual.simd_le(error * error) | left.simd_le(error * splat(0.25));
        let new = done & open;
        let new_s = s - step_s;
        let new_t = t - step_t;
        root_s = new.select(new_s, root_s);
        root_t = new.select(new_t, root_t);
        let mut along = zero;
        for i in 0..3 {
            let moved = jets.point[i] - jets.ds[i] * step_s - jets.dt[i] * step_t;
            point[i] = new.select(moved, point[i]);
            along = axis[i].mul_add(moved - origin[i], along);
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let normal = jets.ds[j] * jets.dt[k] - jets.ds[k] * jets.dt[j];
            cross[i] = new.select(normal, cross[i]);
        }
        z = new.select(along, z);
        found = found | new;
        open = open & !new;
        if open.all_false() {
            break;
        }
        // Steps stay within what the certificate covers; NaN becomes a bound.
        let more = splat(2.0 * WIDENING + 1.0);
        s = new_s.max(middle(s_range) - half_s * more).min(middle(s_range) + half_s * more);
        t = new_t.max(middle(t_range) - half_t * more).min(middle(t_range) + half_t * more);
    }

    // The leaf and its slack.
    let reach = splat(1.0 + 2.0 * LEAF_SLACK);
    let inside = (root_s - middle(s_range)).abs().simd_le(half_s * reach)
        & (root_t - middle(t_range)).abs().simd_le(half_t * reach);
    found = found & inside;

    // Roots outside the piece, and those too near an end of the ray, are judged elsewhere.
    let (low, high) = (splat(0.0), splat(1.0));
    let on_piece = root_s.simd_ge(low) & root_s.simd_le(high) & root_t.simd_ge(low) & root_t.simd_le(high);
    let z_min = f64x8::from_slice(simd, &packet.z_min[base..base + 8]);
    let best = f64x8::from_slice(simd, &packet.z[base..base + 8]);
    let size = dot(&cross, &cross).sqrt();
    let cosine = dot(&cross, &axis).abs() / size;
    let z_error = error / cosine * splat(2.0);
    let clear = z.simd_ge(z_min + z_error) | z.simd_le(z_min - z_error);
    let apart = z.simd_ge(best + z_error) | z.simd_le(best - z_error);
    let judged = found & (!on_piece | !clear | !apart);
    let hit = found & !judged & z.simd_gt(z_min) & z.simd_lt(best);

    if hit.any_true() {
        let put = |lanes: &mut [f64], value: f64x8<S>| {
            let old = f64x8::from_slice(simd, lanes);
            hit.select(value, old).store_slice(lanes);
        };
        put(&mut packet.z[base..base + 8], z);
        put(&mut packet.s[base..base + 8], root_s);
        put(&mut packet.t[base..base + 8], root_t);
        for i in 0..3 {
            put(&mut packet.point[i][base..base + 8], point[i]);
            put(&mut packet.cross[i][base..base + 8], cross[i]);
        }
        let mut lanes = hit.to_bitmask();
        while lanes != 0 {
            let k = base + lanes.trailing_zeros() as usize;
            packet.leaf[k] = target.index;
            packet.shorten(k);
            lanes &= lanes - 1;
        }
    }
    (open | judged).to_bitmask()
}

/// The true surface and its first derivatives at eight places: the same sums as
/// [`TensorPatch::jet`], with unrolled loops for the degrees met most.
#[simd]
fn jets<S: Simd>(simd: S, patch: &TensorPatch, s: f64x8<S>, t: f64x8<S>) -> Jets<S> {
    match patch.degree() {
        [3, 3] => jets_of::<S, 3, 3>(simd, patch, s, t),
        [2, 2] => jets_of::<S, 2, 2>(simd, patch, s, t),
        [2, 1] => jets_of::<S, 2, 1>(simd, patch, s, t),
        [1, 2] => jets_of::<S, 1, 2>(simd, patch, s, t),
        [1, 1] => jets_of::<S, 1, 1>(simd, patch, s, t),
        _ => jets_of::<S, 0, 0>(simd, patch, s, t),
    }
}

/// [`jets`] for degrees `P` and `Q`; zero stands for any degree.
#[simd]
fn jets_of<S: Simd, const P: usize, const Q: usize>(
    simd: S,
    patch: &TensorPatch,
    s: f64x8<S>,
    t: f64x8<S>,
) -> Jets<S> {
    let [p, q] = if P == 0 { patch.degree() } else { [P, Q] };
    let (bs, ds) = basis(simd, p, s);
    let (bt, dt) = basis(simd, q, t);
    let zero = f64x8::splat(simd, 0.0);
    let mut value = [zero; 4];
    let mut along_s = [zero; 4];
    let mut along_t = [zero; 4];
    let rational = patch.is_rational();
    let components = if rational { 4 } else { 3 };
    for i in 0..=p {
        let row = &patch.control()[i * (q + 1)..(i + 1) * (q + 1)];
        for c in 0..components {
            let (mut sum, mut slope) = (zero, zero);
            for (j, control) in row.iter().enumerate() {
                let control = f64x8::splat(simd, control[c]);
                sum = bt[j].mul_add(control, sum);
                slope = dt[j].mul_add(control, slope);
            }
            value[c] = bs[i].mul_add(sum, value[c]);
            along_s[c] = ds[i].mul_add(sum, along_s[c]);
            along_t[c] = bs[i].mul_add(slope, along_t[c]);
        }
    }
    let weight = if rational { value[3] } else { f64x8::splat(simd, patch.control()[0].w) };
    let inverse = f64x8::splat(simd, 1.0) / weight;
    let point = [0, 1, 2].map(|i| value[i] * inverse);
    let tangent = |along: &[f64x8<S>; 4]| {
        if rational {
            [0, 1, 2].map(|i| (along[i] - along[3] * point[i]) * inverse)
        } else {
            [0, 1, 2].map(|i| along[i] * inverse)
        }
    };
    Jets { ds: tangent(&along_s), dt: tangent(&along_t), point }
}

/// Bernstein functions and their derivatives: those of one degree less, then the recurrence.
#[simd]
fn basis<S: Simd>(
    simd: S,
    degree: usize,
    t: f64x8<S>,
) -> ([f64x8<S>; MAX_DEGREE + 1], [f64x8<S>; MAX_DEGREE + 1]) {
    let zero = f64x8::splat(simd, 0.0);
    let one = f64x8::splat(simd, 1.0);
    let rest = one - t;
    let mut lower = [zero; MAX_DEGREE + 1];
    let mut power = one;
    let mut binomial = 1.0;
    for i in 0..degree {
        lower[i] = power * f64x8::splat(simd, binomial);
        power = power * t;
        binomial = binomial * (degree - 1 - i) as f64 / (i + 1) as f64;
    }
    power = one;
    for i in (0..degree).rev() {
        lower[i] = lower[i] * power;
        power = power * rest;
    }
    let mut values = [zero; MAX_DEGREE + 1];
    let mut slopes = [zero; MAX_DEGREE + 1];
    let p = f64x8::splat(simd, degree as f64);
    for i in 0..=degree {
        let (before, here) =
            (if i > 0 { lower[i - 1] } else { zero }, if i < degree { lower[i] } else { zero });
        values[i] = rest.mul_add(here, t * before);
        slopes[i] = p * (before - here);
    }
    (values, slopes)
}
