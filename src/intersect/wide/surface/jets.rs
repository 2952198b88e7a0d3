//! Evaluates the true surface at eight places, in f64, lane by lane: of one patch, or of eight
//! patches of one form; by powers ([`power_sums`]), or by Bernstein functions like
//! [`TensorPatch::jet`].

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x8};
use fearless_simd_macros::simd;

use super::form::{Form, with_numbers};
use super::power_sums;
use crate::math::bernstein::{MAX_DEGREE, binomials};
use crate::patch::{PieceNet, TensorPatch};

/// The control net of each lane's patch.
pub(crate) trait Net<S: Simd> {
    /// A row of the net.
    type Row<'a>
    where
        Self: 'a;

    /// The weight of all control points, where these have three numbers; `None` if the weight is 1.
    fn weight(&self, simd: S) -> Option<f64x8<S>>;

    /// The first `length` numbers of the row of the `i`-th Bernstein function of `s`, or the `i`-th
    /// power.
    fn row(&self, i: usize, length: usize) -> Self::Row<'_>;

    /// A control point of the row, of `C` numbers.
    fn control<'a, const C: usize>(simd: S, row: &Self::Row<'a>, j: usize) -> [f64x8<S>; C]
    where
        Self: 'a;
}

/// One patch for all lanes, and the net for its sums.
#[derive(Clone, Copy)]
pub(crate) struct OneNet<'a> {
    pub patch: &'a TensorPatch,
    pub net: PieceNet<'a>,
}

impl<S: Simd> Net<S> for OneNet<'_> {
    type Row<'a>
        = &'a [f64]
    where
        Self: 'a;

    #[inline(always)]
    fn weight(&self, simd: S) -> Option<f64x8<S>> {
        let weight = self.patch.weight().filter(|&weight| weight != 1.0)?;
        Some(f64x8::splat(simd, weight))
    }

    #[inline(always)]
    fn row(&self, i: usize, length: usize) -> Self::Row<'_> {
        self.net.numbers_from(i, length)
    }

    #[inline(always)]
    fn control<'a, const C: usize>(simd: S, row: &Self::Row<'a>, j: usize) -> [f64x8<S>; C]
    where
        Self: 'a,
    {
        let numbers = &row[C * j..C * (j + 1)];
        let mut control = [f64x8::splat(simd, 0.0); C];
        for c in 0..C {
            control[c] = f64x8::splat(simd, numbers[c]);
        }
        control
    }
}

/// Points of eight lanes and the derivatives there.
pub(crate) struct Jets<S: Simd> {
    pub point: [f64x8<S>; 3],
    /// `S_s`, `S_t`.
    pub first: [[f64x8<S>; 3]; 2],
    /// `S_ss`, `S_st`, `S_tt`, if they are wanted.
    pub second: [[f64x8<S>; 3]; 3],
}

/// Sums of `C` components and their derivatives: by `s`, `t`, `ss`, `st`, `tt`.
pub(super) struct Sums<S: Simd, const C: usize> {
    pub(super) value: [f64x8<S>; C],
    pub(super) first: [[f64x8<S>; C]; 2],
    pub(super) second: [[f64x8<S>; C]; 3],
}

/// Evaluates the true surface and its first derivatives at eight places, and with `SECOND` the
/// second ones, from a net.
#[inline(always)]
pub(crate) fn jets<S: Simd, T: Net<S>, const SECOND: bool>(
    simd: S,
    (net, form): (&T, Form),
    st: &[f64x8<S>; 2],
) -> Jets<S> {
    if form.by_powers {
        power_sums::jets::<S, T, SECOND>(simd, (net, form), st)
    } else if form.highest_degree() < 8 {
        by_bernstein::<S, T, SECOND, 8>(simd, (net, form), st)
    } else {
        by_bernstein::<S, T, SECOND, { MAX_DEGREE + 1 }>(simd, (net, form), st)
    }
}

/// The same by Bernstein functions of degrees below `N`. Each is a function of its own: they need
/// much stack, which takes time even where it is not used.
#[inline(never)]
#[simd]
fn by_bernstein<S: Simd, T: Net<S>, const SECOND: bool, const N: usize>(
    simd: S,
    (net, form): (&T, Form),
    st: &[f64x8<S>; 2],
) -> Jets<S> {
    with_numbers!(form, |C| jets_of::<S, T, SECOND, N, C>(simd, (net, form.degree()), st))
}

/// [`jets`] for any degree below `N` and `C` components: four for rational surfaces, else three.
#[simd]
fn jets_of<S: Simd, T: Net<S>, const SECOND: bool, const N: usize, const C: usize>(
    simd: S,
    (net, [p, q]): (&T, [usize; 2]),
    st: &[f64x8<S>; 2],
) -> Jets<S> {
    let [in_s, in_t] = [basis::<S, N>(simd, p, st[0]), basis::<S, N>(simd, q, st[1])];
    let zero = [f64x8::splat(simd, 0.0); C];
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
    in_space::<S, T, SECOND, C>(simd, net, &sums)
}

/// Converts sums to points and derivatives, by the quotient rule: `S_s = (X_s − S W_s) / W`,
/// `S_st = (X_st − S_s W_t − S_t W_s − S W_st) / W`.
#[inline(always)]
pub(super) fn in_space<S: Simd, T: Net<S>, const SECOND: bool, const C: usize>(
    simd: S,
    net: &T,
    &Sums { value, first: [s, t], second: [ss, st, tt] }: &Sums<S, C>,
) -> Jets<S> {
    let zero = [f64x8::splat(simd, 0.0); 3];
    let mut jets = Jets { point: zero, first: [zero; 2], second: [zero; 3] };
    let (point, [along_s, along_t], [by_ss, by_st, by_tt]) =
        (&mut jets.point, &mut jets.first, &mut jets.second);
    if C == 4 {
        let inverse = f64x8::splat(simd, 1.0) / value[C - 1];
        let [ws, wt] = [s[C - 1] * inverse, t[C - 1] * inverse];
        let [wss, wst, wtt] = [ss[C - 1] * inverse, st[C - 1] * inverse, tt[C - 1] * inverse];
        let [ws2, wt2] = [ws + ws, wt + wt];
        for i in 0..3 {
            let at = value[i] * inverse;
            let along = [s[i] * inverse - ws * at, t[i] * inverse - wt * at];
            point[i] = at;
            (along_s[i], along_t[i]) = (along[0], along[1]);
            if !SECOND {
                continue;
            }
            by_ss[i] = ss[i] * inverse - wss * at - ws2 * along[0];
            by_st[i] = st[i] * inverse - wst * at - ws * along[1] - wt * along[0];
            by_tt[i] = tt[i] * inverse - wtt * at - wt2 * along[1];
        }
        return jets;
    }
    for i in 0..3 {
        point[i] = value[i];
        (along_s[i], along_t[i]) = (s[i], t[i]);
        if SECOND {
            (by_ss[i], by_st[i], by_tt[i]) = (ss[i], st[i], tt[i]);
        }
    }
    if let Some(weight) = net.weight(simd) {
        let inverse = f64x8::splat(simd, 1.0) / weight;
        for i in 0..3 {
            point[i] *= inverse;
            for along in &mut jets.first {
                along[i] *= inverse;
            }
            for along in &mut jets.second {
                along[i] *= inverse;
            }
        }
    }
    jets
}

/// Bernstein functions, their first and second derivatives.
struct Basis<S: Simd, const N: usize> {
    values: [f64x8<S>; N],
    slopes: [f64x8<S>; N],
    bends: [f64x8<S>; N],
}

/// Bernstein functions of a degree and their derivatives, by the recurrence from the functions of
/// one degree less and two less.
#[simd]
fn basis<S: Simd, const N: usize>(simd: S, degree: usize, t: f64x8<S>) -> Basis<S, N> {
    let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
    let rest = one - t;
    let mut basis = Basis { values: [zero; N], slopes: [zero; N], bends: [zero; N] };
    let Basis { values, slopes, bends } = &mut basis;
    let mut lower = [zero; N];
    lower[0] = one;
    if degree > 1 {
        let (mut lowest, mut power) = ([zero; N], one);
        let binomials = binomials(degree - 2);
        for i in 0..degree - 1 {
            lowest[i] = power * f64x8::splat(simd, binomials[i]);
            power *= t;
        }
        power = one;
        for i in (0..degree - 1).rev() {
            lowest[i] *= power;
            power *= rest;
        }
        let factor = f64x8::splat(simd, (degree * (degree - 1)) as f64);
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
    let p = f64x8::splat(simd, degree as f64);
    let mut before = zero;
    for i in 0..=degree {
        let here = if i < degree { lower[i] } else { zero };
        values[i] = rest.mul_add(here, t * before);
        slopes[i] = p * (before - here);
        before = here;
    }
    basis
}
