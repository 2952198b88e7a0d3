//! What all ways to evaluate surfaces in lanes share: nets, sums over them, points from sums.

use fearless_simd::Simd;

use crate::intersect::wide::vectors::Reals;
use crate::patch::{PieceNet, TensorPatch};

/// The control net of each lane's patch.
pub(crate) trait Net<S: Simd, V: Reals<S>> {
    /// A row of the net.
    type Row<'a>
    where
        Self: 'a;

    /// The weight of all control points, where these have three numbers; `None` if the weight is 1.
    fn weight(&self, simd: S) -> Option<V>;

    /// The first `length` numbers of the row of the `i`-th Bernstein function of `s`, or the `i`-th
    /// power.
    fn row(&self, i: usize, length: usize) -> Self::Row<'_>;

    /// A control point of the row, of `C` numbers.
    fn control<'a, const C: usize>(simd: S, row: &Self::Row<'a>, j: usize) -> [V; C]
    where
        Self: 'a;
}

/// One patch for all lanes, and the net for its sums.
#[derive(Clone, Copy)]
pub(crate) struct OneNet<'a> {
    pub patch: &'a TensorPatch,
    pub net: PieceNet<'a>,
}

impl<S: Simd, V: Reals<S>> Net<S, V> for OneNet<'_> {
    type Row<'a>
        = &'a [f64]
    where
        Self: 'a;

    #[inline(always)]
    fn weight(&self, simd: S) -> Option<V> {
        let weight = self.patch.weight().filter(|&weight| weight != 1.0)?;
        Some(V::splat(simd, weight))
    }

    #[inline(always)]
    fn row(&self, i: usize, length: usize) -> Self::Row<'_> {
        self.net.numbers_from(i, length)
    }

    #[inline(always)]
    fn control<'a, const C: usize>(simd: S, row: &Self::Row<'a>, j: usize) -> [V; C]
    where
        Self: 'a,
    {
        let numbers = &row[C * j..C * (j + 1)];
        let mut control = [V::splat(simd, 0.0); C];
        for c in 0..C {
            control[c] = V::splat(simd, numbers[c]);
        }
        control
    }
}

/// Points, a lane each, and the derivatives there.
pub(crate) struct Jets<V> {
    pub point: [V; 3],
    /// `S_s`, `S_t`.
    pub first: [[V; 3]; 2],
    /// `S_ss`, `S_st`, `S_tt`, if they are wanted.
    pub second: [[V; 3]; 3],
}

/// Sums of `C` components and their derivatives: by `s`, `t`, `ss`, `st`, `tt`.
pub(super) struct Sums<V, const C: usize> {
    pub(super) value: [V; C],
    pub(super) first: [[V; C]; 2],
    pub(super) second: [[V; C]; 3],
}

/// Converts sums to points and derivatives, by the quotient rule: `S_s = (X_s − S W_s) / W`,
/// `S_st = (X_st − S_s W_t − S_t W_s − S W_st) / W`.
#[inline(always)]
pub(super) fn in_space<S: Simd, V: Reals<S>, T: Net<S, V>, const SECOND: bool, const C: usize>(
    simd: S,
    net: &T,
    &Sums { value, first: [s, t], second: [ss, st, tt] }: &Sums<V, C>,
) -> Jets<V> {
    let zero = [V::splat(simd, 0.0); 3];
    let mut jets = Jets { point: zero, first: [zero; 2], second: [zero; 3] };
    let (point, [along_s, along_t], [by_ss, by_st, by_tt]) =
        (&mut jets.point, &mut jets.first, &mut jets.second);
    if C == 4 {
        let inverse = V::splat(simd, 1.0) / value[C - 1];
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
        let inverse = V::splat(simd, 1.0) / weight;
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
