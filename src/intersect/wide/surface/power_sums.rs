//! Evaluates the true surface at some places, in f64, by powers about the middle of its pieces
//! (Horner): the jets of [`jets`](super::jets) in less than half as many operations, for degrees up
//! to seven.

use fearless_simd::Simd;
use fearless_simd_macros::simd;

use super::form::{Form, with_degrees};
use super::sums::{Jets, Net, Sums, in_space};
use crate::intersect::wide::vectors::Reals;

/// [`jets`](super::jets::jets), with unrolled loops for the most common degrees.
#[simd]
pub(super) fn jets<S: Simd, V: Reals<S>, T: Net<S, V>, const SECOND: bool>(
    simd: S,
    net: &T,
    form: Form,
    st: &[V; 2],
) -> Jets<V> {
    let degree = form.degree();
    with_degrees!(form, |P, Q, C| jets_of::<S, V, T, SECOND, P, Q, C>(simd, net, degree, st))
}

/// [`jets`] for degrees `P` and `Q`, zero standing for any, and `C` components: four for rational
/// surfaces, else three.
#[simd]
fn jets_of<
    S: Simd,
    V: Reals<S>,
    T: Net<S, V>,
    const SECOND: bool,
    const P: usize,
    const Q: usize,
    const C: usize,
>(
    simd: S,
    net: &T,
    degree: [usize; 2],
    st: &[V; 2],
) -> Jets<V> {
    let [p, q] = if P == 0 { degree } else { [P, Q] };
    let one = V::splat(simd, 1.0);
    let [x, y] = [st[0] + st[0] - one, st[1] + st[1] - one];
    let zero = [V::splat(simd, 0.0); C];
    // `by_xx` and `by_yy` are half the second derivatives, as in Horner's scheme.
    let [mut value, mut by_x, mut by_y, mut by_xx, mut by_xy, mut by_yy] = [zero; 6];
    for i in (0..=p).rev() {
        let row = net.row(i, C * (q + 1));
        let (mut sum, mut slope, mut bend) = (T::control::<C>(simd, &row, q), zero, zero);
        for j in (0..q).rev() {
            let control = T::control::<C>(simd, &row, j);
            for c in 0..C {
                if SECOND {
                    bend[c] = next(bend[c], y, slope[c], q - 1 - j, 2);
                }
                slope[c] = next(slope[c], y, sum[c], q - 1 - j, 1);
                sum[c] = sum[c].mul_add(y, control[c]);
            }
        }
        for c in 0..C {
            if i == p {
                (value[c], by_y[c], by_yy[c]) = (sum[c], slope[c], bend[c]);
                continue;
            }
            if SECOND {
                by_xx[c] = next(by_xx[c], x, by_x[c], p - 1 - i, 2);
                by_xy[c] = next(by_xy[c], x, by_y[c], p - 1 - i, 1);
                by_yy[c] = by_yy[c].mul_add(x, bend[c]);
            }
            by_x[c] = next(by_x[c], x, value[c], p - 1 - i, 1);
            value[c] = value[c].mul_add(x, sum[c]);
            by_y[c] = by_y[c].mul_add(x, slope[c]);
        }
    }
    // In `x` and `y` the unit square has sides of two.
    let of = |factor| V::splat(simd, factor);
    let (two, four, eight) = (of(2.0), of(4.0), of(8.0));
    for c in 0..C {
        (by_x[c], by_y[c]) = (by_x[c] * two, by_y[c] * two);
        (by_xx[c], by_xy[c], by_yy[c]) = (by_xx[c] * eight, by_xy[c] * four, by_yy[c] * eight);
    }
    in_space::<S, V, T, SECOND, C>(
        simd,
        net,
        &Sums { value, first: [by_x, by_y], second: [by_xx, by_xy, by_yy] },
    )
}

/// The next sum of a derivative in Horner's scheme, after `step` steps, from `lower`, the sum of
/// one order less. At first the sum is zero, so nothing is multiplied.
#[inline(always)]
fn next<S: Simd, V: Reals<S>>(sum: V, x: V, lower: V, step: usize, order: usize) -> V {
    if step + 1 < order {
        sum
    } else if step + 1 == order {
        lower
    } else {
        sum.mul_add(x, lower)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use fearless_simd::{SimdBase, f64x8};
    use glam::{DVec2, DVec3, DVec4};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::surface::jets;
    use crate::intersect::wide::surface::spline_net::RecentNets;
    use crate::intersect::wide::surface::sums::OneNet;
    use crate::math::bernstein::{self, Basis};
    use crate::math::testing::same_cases;
    use crate::patch::{PatchSet, TensorPatch};

    /// A net of some degrees, more or less wild, perhaps elevated once: its points are within one of
    /// the origin, its weights within a factor.
    fn nets() -> impl Strategy<Value = NurbsSurface> {
        (plain_nets(), any::<[bool; 2]>()).prop_map(|(net, elevated)| {
            let [in_u, in_v] = elevated.map(usize::from);
            net.elevated_u(in_u).unwrap().elevated_v(in_v).unwrap()
        })
    }

    fn plain_nets() -> impl Strategy<Value = NurbsSurface> {
        let weights = prop_oneof![Just(1.0), 1.0..15.9f64];
        let degrees = (1usize..=8, 1usize..=8, weights, prop_oneof![Just(1.0), 0.0..0.3f64]);
        degrees.prop_flat_map(|(p, q, factor, wildness)| {
            let point = prop::array::uniform4(-1.0..1.0f64);
            prop::collection::vec(point, (p + 1) * (q + 1)).prop_filter_map(
                "no area",
                move |points| {
                    let control = points.iter().enumerate().map(|(k, &[x, y, z, w])| {
                        let place = |i: usize, p: usize| 2.0 * i as f64 / p as f64 - 1.0;
                        let flat = DVec3::new(place(k / (q + 1), p), place(k % (q + 1), q), 0.0);
                        let weight = f64::powf(factor, 0.5 * (1.0 + wildness * w));
                        (weight * flat.lerp(DVec3::new(x, y, z), wildness)).extend(weight)
                    });
                    let [u, v] = [p, q].map(|degree| KnotVector::bezier(degree).unwrap());
                    NurbsSurface::from_homogeneous(u, v, control.collect::<Vec<DVec4>>()).ok()
                },
            )
        })
    }

    /// The largest differences from the scalar code: of points, of first derivatives, and of second
    /// ones relative to their size.
    fn off(patch: &TensorPatch, places: &[DVec2; 8]) -> [f64; 3] {
        let mut most = [0f64; 3];
        for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
            let mut nets = RecentNets::default();
            dispatch!(level, simd => {
                let mut st = [f64x8::splat(simd, 0.0); 2];
                for lane in 0..8 {
                    (st[0][lane], st[1][lane]) = (places[lane].x, places[lane].y);
                }
                let net = OneNet { patch, net: nets.net_of(simd, 0, patch) };
                let form = Form::of(patch);
                let jets = jets::jets::<_, _, _, true>(simd, &net, form, &st);
                let firsts = jets::jets::<_, _, _, false>(simd, &net, form, &st);
                assert_eq!(bits(&jets.point), bits(&firsts.point));
                assert_eq!(jets.first.each_ref().map(bits), firsts.first.each_ref().map(bits));
                for (lane, &place) in places.iter().enumerate() {
                    let vector = |v: [f64x8<_>; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
                    let truth = patch.derivatives(place);
                    let firsts = [truth.du, truth.dv];
                    let seconds = [truth.duu, truth.duv, truth.dvv];
                    // Second derivatives are the larger the more the weights differ.
                    let largest = seconds.iter().map(|v| v.length()).fold(1.0, f64::max);
                    most[0] = most[0].max(vector(jets.point).distance(truth.point));
                    for k in 0..2 {
                        most[1] = most[1].max(vector(jets.first[k]).distance(firsts[k]));
                    }
                    for k in 0..3 {
                        let off = vector(jets.second[k]).distance(seconds[k]);
                        most[2] = most[2].max(off / largest);
                    }
                }
            });
        }
        most
    }

    fn weight(surface: &NurbsSurface, place: DVec2) -> f64 {
        let [p, q] = [surface.knots_u(), surface.knots_v()].map(KnotVector::degree);
        let (in_s, in_t): (Basis, Basis) =
            (bernstein::basis(p, place.x), bernstein::basis(q, place.y));
        let control = surface.control().iter().enumerate();
        control.map(|(k, c)| in_s[k / (q + 1)] * in_t[k % (q + 1)] * c.w).sum()
    }

    fn bits<S: Simd>(vector: &[f64x8<S>; 3]) -> [[u64; 8]; 3] {
        vector.map(|lanes| std::array::from_fn(|lane| lanes[lane].to_bits()))
    }

    #[test]
    fn jets_are_those_of_the_scalar_code() {
        let place = (-0.02..1.02f64, -0.02..1.02f64).prop_map(|(s, t)| DVec2::new(s, t));
        let places = prop::array::uniform8(place);
        // Of degrees up to three, and of higher ones.
        let by_powers = [Cell::new(0), Cell::new(0)];
        let lowered = Cell::new(0);
        let config = ProptestConfig { max_shrink_iters: 200, ..same_cases(600) };
        proptest!(config, |(surface in nets(), places in places)| {
            // The bounds are those of points on the piece, whose weight is no less than the least
            // weight of the control points; outside the piece it may vanish.
            let least = surface.control().iter().map(|c| c.w).fold(f64::INFINITY, f64::min);
            let places = places.map(|place| {
                let heavy = weight(&surface, place) >= least;
                if heavy { place } else { place.clamp(DVec2::ZERO, DVec2::ONE) }
            });
            let (set, _) = PatchSet::new(&[surface]).unwrap();
            let patch = &set.pieces()[0].patch;
            let [p, q] = patch.degree();
            prop_assert!(!patch.sums_by_powers() || p.max(q) <= 7);
            let counted = &by_powers[usize::from(p.max(q) > 3)];
            counted.set(counted.get() + u32::from(patch.sums_by_powers()));
            lowered.set(lowered.get() + u32::from(patch.sums_degree() != [p, q]));
            let [point, first, second] = off(patch, &places);
            // Both have errors; half of the promise is left for other things.
            let bound = patch.error_bound(0.0);
            prop_assert!(point <= 0.5 * bound, "{:e} of {:e}", point, bound);
            prop_assert!(first <= 200.0 * bound, "{:e} of {:e}", first, bound);
            prop_assert!(second <= 2e4 * bound, "{:e} of {:e}", second, bound);
        });
        let [low, high] = by_powers.map(Cell::into_inner);
        assert!(low > 40 && high > 100, "{low} and {high} of 600");
        assert!(lowered.get() > 100, "{} of 600", lowered.get());
    }
}
