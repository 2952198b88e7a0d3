//! Decides which hits of a leaf the trims of its surface keep.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use fearless_simd_macros::simd;
use glam::DVec2;

use super::hit_place::HitPlace;
use super::reach::WIDENED;
use super::vectors::lane_bits;
use super::view::BvhView;
use crate::geometry::trim::{self, Side, WINDOW_REACH, WINDOW_SPARE, WindowCurve};
use crate::intersect::roots::reach::{TRIM_REACH, TRIM_SPARE, trim_reach};
use crate::patch::{FIT_DOMAIN, Leaf};

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
const _: () = assert!(WIDENED + WINDOW_SPARE < WINDOW_REACH);
const _: () = assert!(WINDOW_REACH <= FIT_DOMAIN);

/// What rounding of sixteen places to f32, and of what is computed of them, adds to how far they
/// may be off: some ten units of 2⁻²⁴, for coordinates of about one.
const SPARE_OF_F32: f32 = 6e-7;

/// Sixteen places on a leaf, and by how much they may be off, in box coordinates.
pub(super) struct Places<S: Simd> {
    pub(super) at: [f32x16<S>; 2],
    pub(super) reach: [f32x16<S>; 2],
}

/// [`trim::is_kept`] for sixteen places, a bit each: those that the window keeps, and those of the
/// ones `asked` for about which it tells. The first bits mean nothing where the others are not set.
///
/// Neighbouring rays are beside most curves, all in the same way: so curves are asked about their
/// rectangles first.
#[simd]
pub(super) fn kept_in_window<S: Simd>(
    simd: S,
    window: &[WindowCurve],
    places: &Places<S>,
    asked: u32,
) -> [u32; 2] {
    let splat = |x: f32| f32x16::splat(simd, x);
    let [x, y] = places.at;
    let (zero, one) = (splat(0.0), splat(1.0));
    let spare = splat(WINDOW_SPARE as f32 + SPARE_OF_F32);
    let [reach_x, reach_y] = places.reach.map(|reach| reach + spare);
    let most = splat(WINDOW_REACH as f32);
    let is_seen = (x.abs() + reach_x).simd_le(most) & (y.abs() + reach_y).simd_le(most);
    let others = !(mask32x16::from_bitmask(simd, u64::from(asked)) & is_seen);
    let ([left_x, right_x], [low_y, high_y]) =
        ([x - reach_x, x + reach_x], [y - reach_y, y + reach_y]);
    let [mut is_odd, mut decided] = [mask32x16::splat(simd, false), is_seen];
    for curve in window {
        let [[left_end, right_end], [low, high]] = [curve.x.map(splat), curve.y.map(splat)];
        // Rays from within reach towards larger u do not cross it.
        let uncrossed = high_y.simd_lt(low) | low_y.simd_gt(high) | left_x.simd_gt(right_end);
        if (uncrossed | others).all_true() {
            continue;
        }
        let is_left = right_x.simd_lt(left_end);
        let is_level = low.simd_le(y) & y.simd_lt(high);
        let apart = uncrossed | is_left;
        if (apart | others).all_true() {
            is_odd ^= is_level & is_left;
            continue;
        }
        let [across_x, across_y] = curve.across.map(splat);
        let [along_x, along_y] = curve.along.map(splat);
        let place = along_x.mul_add(x, along_y.mul_add(y, splat(curve.start))).max(zero).min(one);
        let bow = splat(curve.bend) * place * (one - place);
        let value = across_x.mul_add(x, across_y * y) - bow;
        let [spread_x, spread_y] = curve.spread.map(splat);
        let spread = spread_x.mul_add(reach_x, spread_y * reach_y);
        let [least, largest] = curve.band.map(splat);
        let left = (value - spread).simd_gt(largest);
        let right = (value + spread).simd_lt(least);
        decided &= apart | left | right;
        is_odd ^= is_level & apart.select(is_left, left);
    }
    let decided = if window.is_empty() { 0 } else { lane_bits(decided) & asked };
    [lane_bits(is_odd), decided]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::intersect::tree::nodes::LANES;
    use crate::math::SplitMix;
    use crate::math::bits::{has, set_bits};

    #[test]
    fn sixteen_places_are_kept_as_one_is() {
        let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
        let loops = [0.4, 0.3].map(|r| TrimLoop::circle(DVec2::splat(0.5), r).unwrap());
        let trims = Trims::new(domain, Kept::Odd, &loops).unwrap();
        let mut random = SplitMix::new(17);
        let (mut counts, mut left) = ([0; 3], 0);
        for k in 0..3000 {
            let center = DVec2::new(random.unit(), random.unit());
            let half = 0.2 * random.unit();
            let window = trims.window(&UvBox::about(center, DVec2::splat(half)), DVec2::ZERO);
            let mut sixteen = |size: f64| -> [f32; LANES] {
                std::array::from_fn(|_| (size * (2.0 * random.unit() - 1.0)) as f32)
            };
            let at = [sixteen(1.08), sixteen(1.08)];
            let mut reach = [sixteen(1e-2), sixteen(1e-4)].map(|lanes| lanes.map(f32::abs));
            if k % 5 == 0 {
                (reach[0][1], reach[1][2]) = (f32::NAN, f32::INFINITY);
            }
            let asked = [0xffff, 0x00ff, 0x5a3c][k % 3];
            let said = dispatch!(Kernel::best_level(), simd => {
                let lanes = |of: [[f32; LANES]; 2]| of.map(|of| f32x16::from_slice(simd, &of));
                let places = Places { at: lanes(at), reach: lanes(reach) };
                kept_in_window(simd, &window, &places, asked).map(u64::from)
            });
            for lane in set_bits(asked) {
                let [at, reach] = [at, reach]
                    .map(|of| DVec2::new(f64::from(of[0][lane]), f64::from(of[1][lane])));
                let one = trim::is_kept(&window, at, reach);
                let [kept, decided] = said.map(|bits| has(bits, lane));
                let lanes = decided.then_some(kept);
                // In f32 a little more is left open.
                assert!(lanes == one || lanes.is_none(), "{at} of {window:?}");
                left += u32::from(lanes != one);
                counts[one.map_or(2, usize::from)] += 1;
            }
        }
        assert!(counts.iter().all(|count| *count > 6000) && left < 10, "{counts:?}, {left}");
    }
}
