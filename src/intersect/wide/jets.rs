//! The true surface at eight places, in f64: the same sums as [`TensorPatch::jet`], lane by lane;
//! of one patch, or of eight patches of the same degrees.

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x8};
use fearless_simd_macros::simd;

use crate::math::bernstein::{MAX_DEGREE, binomials};
use crate::patch::{PieceNet, TensorPatch};

/// The control net of a patch in every lane.
pub(super) trait Net<S: Simd> {
    /// A row of it.
    type Row<'a>
    where
        Self: 'a;

    /// The degrees, and whether a control point has four numbers, its weight last, or three.
    fn form(&self) -> ([usize; 2], bool);

    /// The weight of all control points, where they have three numbers; `None` if it is one.
    fn weight(&self, simd: S) -> Option<f64x8<S>>;

    /// The first numbers, so many, of the row of the `i`-th Bernstein function of `s`.
    fn row(&self, i: usize, length: usize) -> Self::Row<'_>;

    /// One of its control points, of `C` numbers.
    fn control<'a, const C: usize>(simd: S, row: &Self::Row<'a>, j: usize) -> [f64x8<S>; C]
    where
        Self: 'a;
}

/// One patch for all lanes, and its net.
#[derive(Clone, Copy)]
pub(super) struct OneNet<'a> {
    pub(super) patch: &'a TensorPatch,
    pub(super) net: PieceNet<'a>,
}

impl<S: Simd> Net<S> for OneNet<'_> {
    type Row<'a>
        = &'a [f64]
    where
        Self: 'a;

    #[inline(always)]
    fn form(&self) -> ([usize; 2], bool) {
        (self.patch.degree(), self.patch.is_rational())
    }

    #[inline(always)]
    fn weight(&self, simd: S) -> Option<f64x8<S>> {
        let weight = self.patch.weight().filter(|&weight| weight != 1.0)?;
        Some(f64x8::splat(simd, weight))
    }

    #[inline(always)]
    fn row(&self, i: usize, length: usize) -> Self::Row<'_> {
        &self.net.row(i)[..length]
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
pub(super) struct Jets<S: Simd> {
    pub(super) point: [f64x8<S>; 3],
    pub(super) ds: [f64x8<S>; 3],
    pub(super) dt: [f64x8<S>; 3],
}

/// The true surface and its first derivatives at eight places: the same sums as
/// [`TensorPatch::jet`], with unrolled loops and little scratch memory for the degrees met
/// most.
#[simd]
pub(super) fn jets<S: Simd, T: Net<S>>(simd: S, net: &T, st: &[f64x8<S>; 2]) -> Jets<S> {
    match net.form() {
        ([3, 3], true) => jets_of::<S, T, 3, 3, 4, 4>(simd, net, st),
        ([3, 3], false) => jets_of::<S, T, 3, 3, 4, 3>(simd, net, st),
        ([2, 2], true) => jets_of::<S, T, 2, 2, 4, 4>(simd, net, st),
        ([2, 1], true) => jets_of::<S, T, 2, 1, 4, 4>(simd, net, st),
        ([1, 2], true) => jets_of::<S, T, 1, 2, 4, 4>(simd, net, st),
        ([1, 1], false) => jets_of::<S, T, 1, 1, 4, 3>(simd, net, st),
        ([p, q], true) if p.max(q) < 8 => jets_of::<S, T, 0, 0, 8, 4>(simd, net, st),
        ([p, q], false) if p.max(q) < 8 => jets_of::<S, T, 0, 0, 8, 3>(simd, net, st),
        (_, true) => jets_of::<S, T, 0, 0, { MAX_DEGREE + 1 }, 4>(simd, net, st),
        (_, false) => jets_of::<S, T, 0, 0, { MAX_DEGREE + 1 }, 3>(simd, net, st),
    }
}

/// [`jets`] for degrees `P` and `Q`, zero standing for any degree below `N`, and `C`
/// components: four for rational surfaces, else three.
#[simd]
fn jets_of<S: Simd, T: Net<S>, const P: usize, const Q: usize, const N: usize, const C: usize>(
    simd: S,
    net: &T,
    st: &[f64x8<S>; 2],
) -> Jets<S> {
    let [p, q] = if P == 0 { net.form().0 } else { [P, Q] };
    let (bs, ds) = basis::<S, N>(simd, p, st[0]);
    let (bt, dt) = basis::<S, N>(simd, q, st[1]);
    let zero = f64x8::splat(simd, 0.0);
    let mut value = [zero; C];
    let mut along_s = [zero; C];
    let mut along_t = [zero; C];
    for i in 0..=p {
        let row = net.row(i, C * (q + 1));
        let (mut sum, mut slope) = ([zero; C], [zero; C]);
        for j in 0..=q {
            let control = T::control::<C>(simd, &row, j);
            for c in 0..C {
                sum[c] = bt[j].mul_add(control[c], sum[c]);
                slope[c] = dt[j].mul_add(control[c], slope[c]);
            }
        }
        for c in 0..C {
            value[c] = bs[i].mul_add(sum[c], value[c]);
            along_s[c] = ds[i].mul_add(sum[c], along_s[c]);
            along_t[c] = bs[i].mul_add(slope[c], along_t[c]);
        }
    }
    let mut jets = Jets { point: [zero; 3], ds: [zero; 3], dt: [zero; 3] };
    let weight = if C == 3 { net.weight(simd) } else { Some(value[C - 1]) };
    let Some(weight) = weight else {
        for i in 0..3 {
            (jets.point[i], jets.ds[i], jets.dt[i]) = (value[i], along_s[i], along_t[i]);
        }
        return jets;
    };
    let inverse = f64x8::splat(simd, 1.0) / weight;
    for i in 0..3 {
        jets.point[i] = value[i] * inverse;
        if C == 4 {
            along_s[i] -= along_s[C - 1] * jets.point[i];
            along_t[i] -= along_t[C - 1] * jets.point[i];
        }
        jets.ds[i] = along_s[i] * inverse;
        jets.dt[i] = along_t[i] * inverse;
    }
    jets
}

/// The true surface at eight places: the point of [`jets`], but for rounding.
#[simd]
pub(super) fn points<S: Simd, T: Net<S>>(simd: S, net: &T, st: &[f64x8<S>; 2]) -> [f64x8<S>; 3] {
    match net.form() {
        ([3, 3], true) => points_of::<S, T, 3, 3, 4, 4>(simd, net, st),
        ([3, 3], false) => points_of::<S, T, 3, 3, 4, 3>(simd, net, st),
        ([2, 2], true) => points_of::<S, T, 2, 2, 4, 4>(simd, net, st),
        ([2, 1], true) => points_of::<S, T, 2, 1, 4, 4>(simd, net, st),
        ([1, 2], true) => points_of::<S, T, 1, 2, 4, 4>(simd, net, st),
        ([1, 1], false) => points_of::<S, T, 1, 1, 4, 3>(simd, net, st),
        ([p, q], true) if p.max(q) < 8 => points_of::<S, T, 0, 0, 8, 4>(simd, net, st),
        ([p, q], false) if p.max(q) < 8 => points_of::<S, T, 0, 0, 8, 3>(simd, net, st),
        (_, true) => points_of::<S, T, 0, 0, { MAX_DEGREE + 1 }, 4>(simd, net, st),
        (_, false) => points_of::<S, T, 0, 0, { MAX_DEGREE + 1 }, 3>(simd, net, st),
    }
}

/// [`points`] for degrees and components as in [`jets_of`].
#[simd]
fn points_of<S: Simd, T: Net<S>, const P: usize, const Q: usize, const N: usize, const C: usize>(
    simd: S,
    net: &T,
    st: &[f64x8<S>; 2],
) -> [f64x8<S>; 3] {
    let [p, q] = if P == 0 { net.form().0 } else { [P, Q] };
    let (bs, _) = basis::<S, N>(simd, p, st[0]);
    let (bt, _) = basis::<S, N>(simd, q, st[1]);
    let zero = f64x8::splat(simd, 0.0);
    let mut value = [zero; C];
    for i in 0..=p {
        let row = net.row(i, C * (q + 1));
        let mut sum = [zero; C];
        for j in 0..=q {
            let control = T::control::<C>(simd, &row, j);
            for c in 0..C {
                sum[c] = bt[j].mul_add(control[c], sum[c]);
            }
        }
        for c in 0..C {
            value[c] = bs[i].mul_add(sum[c], value[c]);
        }
    }
    let weight = if C == 3 { net.weight(simd) } else { Some(value[C - 1]) };
    let Some(weight) = weight else { return [value[0], value[1], value[2]] };
    let inverse = f64x8::splat(simd, 1.0) / weight;
    [value[0] * inverse, value[1] * inverse, value[2] * inverse]
}

/// Bernstein functions and their derivatives: those of one degree less, then the recurrence.
#[simd]
fn basis<S: Simd, const N: usize>(
    simd: S,
    degree: usize,
    t: f64x8<S>,
) -> ([f64x8<S>; N], [f64x8<S>; N]) {
    let zero = f64x8::splat(simd, 0.0);
    let one = f64x8::splat(simd, 1.0);
    let rest = one - t;
    let mut lower = [zero; N];
    let mut power = one;
    let binomials = binomials(degree - 1);
    for i in 0..degree {
        lower[i] = power * f64x8::splat(simd, binomials[i]);
        power *= t;
    }
    power = one;
    for i in (0..degree).rev() {
        lower[i] *= power;
        power *= rest;
    }
    let mut values = [zero; N];
    let mut slopes = [zero; N];
    let p = f64x8::splat(simd, degree as f64);
    values[0] = rest * lower[0];
    slopes[0] = p * -lower[0];
    for i in 1..degree {
        let (before, here) = (lower[i - 1], lower[i]);
        values[i] = rest.mul_add(here, t * before);
        slopes[i] = p * (before - here);
    }
    values[degree] = t * lower[degree - 1];
    slopes[degree] = p * lower[degree - 1];
    (values, slopes)
}
