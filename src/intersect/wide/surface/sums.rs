//! What all ways to evaluate surfaces in lanes share: nets, sums over them, points from sums.

use fearless_simd::{Simd, SimdBase, f64x8};

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
