//! Decides which hits of a leaf the trims of its surface keep.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f64x8, mask64x8};
use fearless_simd_macros::simd;
use glam::DVec2;

use super::hit_place::HitPlace;
use super::view::BvhView;
use crate::geometry::trim::{self, Side, WINDOW_REACH, WINDOW_SPARE, WindowCurve};
use crate::intersect::roots::borders::{TRIM_REACH, TRIM_SPARE, trim_reach};
use crate::patch::{FIT_DOMAIN, Leaf, WIDENING};

/// How near a trim edge must be, in either parameter, in units of the error times an upper bound of
/// how much of the parameter there is to a unit of length, such as the sum of both tangents'
/// lengths over the length of their cross product: see [`trim_reach`].
pub(super) const EDGE_REACH: f64 = TRIM_SPARE * TRIM_REACH;

/// Whether a root of a leaf that a trim curve passes through is kept; `None` at an edge, where the
/// scalar search must judge it.
#[inline(never)]
pub(super) fn trims_keep(found: &HitPlace, view: &BvhView<'_>) -> Option<bool> {
    let window = view.windows.of(found.leaf);
    let leaf = &view.leaves[found.leaf as usize];
    window_keeps(window, leaf, found).or_else(|| {
        let piece = view.piece_of(found.leaf);
        let reach = TRIM_SPARE * trim_reach(&piece.patch.jet(found.st), found.z_error);
        match piece.side(found.st, reach) {
            Side::Inside => Some(true),
            Side::Outside => Some(false),
            Side::Edge { .. } => None,
        }
    })
}

/// Whether a root is kept, as far as the leaf's window tells. The place may be off by no more than
/// [`Leaf::stretch`] allows, which is no less than [`trim_reach`] says but for rounding, and
/// [`TRIM_SPARE`] covers that. Where nothing is known of it, as at poles, the window does not tell.
fn window_keeps(window: &[WindowCurve], leaf: &Leaf, found: &HitPlace) -> Option<bool> {
    if window.is_empty() {
        return None;
    }
    let lengths = DVec2::from_array(leaf.half_side_lengths().map(f64::from));
    let reach = EDGE_REACH * found.z_error * f64::from(leaf.stretch()) / lengths;
    trim::is_kept(window, leaf.box_coordinates(found.st), reach)
}

/// The window reaches farther than places on a leaf for which anything is proved, but not as far as
/// what is known of the leaf.
const _: () = assert!(1.0 + 2.0 * WIDENING + WINDOW_SPARE < WINDOW_REACH);
const _: () = assert!(WINDOW_REACH <= FIT_DOMAIN);

/// Eight places on a leaf, and by how much they may be off, in box coordinates.
pub(super) struct Places<S: Simd> {
    pub(super) at: [f64x8<S>; 2],
    pub(super) reach: [f64x8<S>; 2],
}

/// The lanes that a window keeps, and those for which it tells: [`trim::is_kept`] for eight places.
#[simd]
pub(super) fn kept_in_window<S: Simd>(
    simd: S,
    window: &[WindowCurve],
    places: &Places<S>,
) -> [mask64x8<S>; 2] {
    let splat = |x: f32| f64x8::splat(simd, f64::from(x));
    let [x, y] = places.at;
    let [reach_x, reach_y] = places.reach.map(|reach| reach + f64x8::splat(simd, WINDOW_SPARE));
    let most = f64x8::splat(simd, WINDOW_REACH);
    let is_seen = (x.abs() + reach_x).simd_le(most) & (y.abs() + reach_y).simd_le(most);
    let [mut is_odd, mut decided] = [simd.splat_mask64x8(false), is_seen];
    for curve in window {
        let [[left_end, right_end], [low, high]] = [curve.x.map(splat), curve.y.map(splat)];
        let apart = (x + reach_x).simd_lt(left_end)
            | (x - reach_x).simd_gt(right_end)
            | (y + reach_y).simd_lt(low)
            | (y - reach_y).simd_gt(high);
        let [across_x, across_y] = curve.across.map(splat);
        let offset = across_x.mul_add(x, across_y * y);
        let spread = across_x.abs().mul_add(reach_x, across_y.abs() * reach_y);
        let [least, largest] = curve.band.map(splat);
        let left = (offset - spread).simd_gt(largest);
        let right = (offset + spread).simd_lt(least);
        decided &= apart | left | right;
        let is_level = low.simd_le(y) & y.simd_lt(high);
        is_odd ^= is_level & apart.select(x.simd_lt(left_end), left);
    }
    [is_odd, decided & simd.splat_mask64x8(!window.is_empty())]
}

#[cfg(test)]
mod tests {
    use fearless_simd::SimdMask;

    use super::*;
    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::math::SplitMix;
    use crate::math::bits::has;

    #[test]
    fn eight_places_are_kept_as_one_is() {
        let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
        let loops = [0.4, 0.3].map(|r| TrimLoop::circle(DVec2::splat(0.5), r).unwrap());
        let trims = Trims::new(domain, Kept::Odd, &loops).unwrap();
        let mut random = SplitMix::new(17);
        let mut counts = [0; 3];
        for k in 0..3000 {
            let center = DVec2::new(random.unit(), random.unit());
            let half = 0.2 * random.unit();
            let window = trims.window(&UvBox::about(center, DVec2::splat(half)), DVec2::ZERO);
            let mut eight = |size: f64| -> [f64; 8] {
                std::array::from_fn(|_| size * (2.0 * random.unit() - 1.0))
            };
            let at = [eight(1.08), eight(1.08)];
            let mut reach = [eight(1e-2), eight(1e-4)].map(|lanes| lanes.map(f64::abs));
            if k % 5 == 0 {
                (reach[0][1], reach[1][2]) = (f64::NAN, f64::INFINITY);
            }
            let said = dispatch!(Kernel::best_level(), simd => {
                let lanes = |of: [[f64; 8]; 2]| of.map(|of| f64x8::from_slice(simd, &of));
                let places = Places { at: lanes(at), reach: lanes(reach) };
                kept_in_window(simd, &window, &places).map(|lanes| lanes.to_bitmask())
            });
            for lane in 0..8 {
                let [at, reach] = [at, reach].map(|of| DVec2::new(of[0][lane], of[1][lane]));
                let one = trim::is_kept(&window, at, reach);
                let [kept, decided] = said.map(|bits| has(bits, lane));
                assert_eq!(decided.then_some(kept), one, "{at} of {window:?}");
                counts[one.map_or(2, usize::from)] += 1;
            }
        }
        assert!(counts.iter().all(|count| *count > 3000), "{counts:?}");
    }
}
