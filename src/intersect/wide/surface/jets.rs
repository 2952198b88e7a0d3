//! Evaluates the true surface at some places, in f64, lane by lane: of one patch, or of as many
//! patches of one form; by powers ([`power_sums`]), or by Bernstein functions like
//! [`TensorPatch::jet`](crate::patch::TensorPatch::jet).

use fearless_simd::Simd;
use fearless_simd_macros::simd;

use super::form::{Form, with_numbers};
use super::power_sums;
use super::sums::{Jets, Net, Sums, in_space};
use crate::intersect::wide::vectors::Reals;
use crate::math::bernstein::{MAX_DEGREE, binomials};

/// Evaluates the true surface and its first derivatives at some places, and with `SECOND` the
/// second ones, from a net.
#[inline(always)]
pub(crate) fn jets<S: Simd, V: Reals<S>, T: Net<S, V>, const SECOND: bool>(
    simd: S,
    net: &T,
    form: Form,
    st: &[V; 2],
) -> Jets<V> {
    if form.by_powers {
        power_sums::jets::<S, V, T, SECOND>(simd, net, form, st)
    } else if form.highest_degree() < 8 {
        by_bernstein::<S, V, T, SECOND, 8>(simd, net, form, st)
    } else {
        by_bernstein::<S, V, T, SECOND, { MAX_DEGREE + 1 }>(simd, net, form, st)
    }
}

/// The same by Bernstein functions of degrees below `N`. Each is a function of its own: they need
/// much stack, which takes time even where it is not used.
#[inline(never)]
#[simd]
fn by_bernstein<S: Simd, V: Reals<S>, T: Net<S, V>, const SECOND: bool, const N: usize>(
    simd: S,
    net: &T,
    form: Form,
    st: &[V; 2],
) -> Jets<V> {
    with_numbers!(form, |C| jets_of::<S, V, T, SECOND, N, C>(simd, net, form.degree(), st))
}

/// [`jets`] for any degree below `N` and `C` components: four for rational surfaces, else three.
#[simd]
fn jets_of<
    S: Simd,
    V: Reals<S>,
    T: Net<S, V>,
    const SECOND: bool,
    const N: usize,
    const C: usize,
>(
    simd: S,
    net: &T,
    [p, q]: [usize; 2],
    st: &[V; 2],
) -> Jets<V> {
    let [in_s, in_t] = [basis::<S, V, N>(simd, p, st[0]), basis::<S, V, N>(simd, q, st[1])];
    let zero = [V::splat(simd, 0.0); C];
    let mut sums = Sums { value: zero, first: [zero; 2], second: [zero; 3] };
    for i in 0..=p {
        let row = net.row(i, C * (q + 1));
        let [mut sum, mut slope, mut bend] = [zero; 3];
        for j in 0..=q {
            let control = T::control::<C>(simd, &row, j);
            for c in 0..C {
                sum[c] = in_t.values[j].mul_add(control[c], sum[c]);
                slope[c] = in_t.slopes[j].mul_add(control[c], slope[c]);
                if SECOND {
                    bend[c] = in_t.bends[j].mul_add(control[c], bend[c]);
                }
            }
        }
        let (value, [along_s, along_t], [ss, st, tt]) =
            (&mut sums.value, &mut sums.first, &mut sums.second);
        for c in 0..C {
            value[c] = in_s.values[i].mul_add(sum[c], value[c]);
            along_s[c] = in_s.slopes[i].mul_add(sum[c], along_s[c]);
            along_t[c] = in_s.values[i].mul_add(slope[c], along_t[c]);
            if !SECOND {
                continue;
            }
            ss[c] = in_s.bends[i].mul_add(sum[c], ss[c]);
            st[c] = in_s.slopes[i].mul_add(slope[c], st[c]);
            tt[c] = in_s.values[i].mul_add(bend[c], tt[c]);
        }
    }
    in_space::<S, V, T, SECOND, C>(simd, net, &sums)
}

/// Bernstein functions, their first and second derivatives.
struct Basis<V, const N: usize> {
    values: [V; N],
    slopes: [V; N],
    bends: [V; N],
}

/// Bernstein functions of a degree and their derivatives, by the recurrence from the functions of
/// one degree less and two less.
#[simd]
fn basis<S: Simd, V: Reals<S>, const N: usize>(simd: S, degree: usize, t: V) -> Basis<V, N> {
    let (zero, one) = (V::splat(simd, 0.0), V::splat(simd, 1.0));
    let rest = one - t;
    let mut basis = Basis { values: [zero; N], slopes: [zero; N], bends: [zero; N] };
    let Basis { values, slopes, bends } = &mut basis;
    let mut lower = [zero; N];
    lower[0] = one;
    if degree > 1 {
        let (mut lowest, mut power) = ([zero; N], one);
        let binomials = binomials(degree - 2);
        for i in 0..degree - 1 {
            lowest[i] = power * V::splat(simd, binomials[i]);
            power *= t;
        }
        power = one;
        for i in (0..degree - 1).rev() {
            lowest[i] *= power;
            power *= rest;
        }
        let factor = V::splat(simd, (degree * (degree - 1)) as f64);
        let (mut before, mut two_before) = (zero, zero);
        for i in 0..=degree {
            let here = if i < degree - 1 { lowest[i] } else { zero };
            if i < degree {
                lower[i] = rest.mul_add(here, t * before);
            }
            bends[i] = factor * (two_before - (before + before) + here);
            (two_before, before) = (before, here);
        }
    }
    let p = V::splat(simd, degree as f64);
    let mut before = zero;
    for i in 0..=degree {
        let here = if i < degree { lower[i] } else { zero };
        values[i] = rest.mul_add(here, t * before);
        slopes[i] = p * (before - here);
        before = here;
    }
    basis
}
