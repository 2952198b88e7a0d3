//! What the rays of a packet have in common, read off them as they are given: enough to see that
//! most packets of a picture's background meet nothing, before anything else is found out of them.

use fearless_simd::{Simd, SimdBase, f64x8};
use fearless_simd_macros::simd;

use super::box_ray::BLUR;
use super::frames::{END_SPARE, PLAIN, shift_to_scene};
use super::packet::PacketBounds;
use super::scene::Scene;
use crate::intersect::Shot;

/// Where moved origins may be at most for the work in f32, in scaled coordinates.
const FARTHEST_MOVED: f32 = 4.0;

/// What an `f32` may be off by that was rounded from a number of size one or two; of size four, and
/// after one more operation, it is at most four times that.
const ROUNDED: f32 = f32::EPSILON;

/// Bounds of all rays, and the largest of their ends in scaled coordinates; `None` where they
/// have too little in common, or lie where rounding counts.
///
/// All is interval arithmetic on the ranges of the eight numbers of a ray. Unit directions are
/// those given over a length between the shortest and the longest there may be; the origins are
/// moved towards the scene by one distance for all.
#[simd]
pub(super) fn outline<S: Simd, Q: Shot>(
    simd: S,
    shots: &[Q],
    scene: &Scene<'_>,
) -> Option<(PacketBounds, f32)> {
    let [low, high] = hull(simd, shots)?;
    let (mut least, mut most) = (0.0, 0.0);
    for k in 3..6 {
        let size = low[k].max(-high[k]).max(0.0);
        least += size * size;
        most += low[k].abs().max(high[k].abs()).powi(2);
    }
    let alike = least > 0.25 * most && least > PLAIN && most < 1.0 / PLAIN;
    if !alike {
        return None;
    }
    let (shortest, longest) = (least.sqrt(), most.sqrt());
    let (per_shortest, per_longest) = (1.0 / shortest, 1.0 / longest);

    let frame = scene.tree.frame();
    let mut middle = [0.0; 3];
    let mut square = 0.0;
    for k in 0..3 {
        middle[k] = (0.5 * (low[k] + high[k]) - frame.center[k]) * frame.scale;
        square += middle[k] * middle[k];
    }
    let magnitude = (0..3).map(|k| low[k].abs().max(high[k].abs())).fold(0.0, f64::max);
    if scene.is_beyond_f32(magnitude) {
        return None;
    }
    let along: f64 = (0..3).map(|k| middle[k] * (low[3 + k] + high[3 + k])).sum();
    let shift = shift_to_scene(square, along);

    let mut bounds = PacketBounds::default();
    for k in 0..3 {
        let (from, to) = (low[3 + k], high[3 + k]);
        let from = from * if from < 0.0 { per_shortest } else { per_longest };
        let to = to * if to > 0.0 { per_shortest } else { per_longest };
        bounds.set_directions(k, from as f32 - ROUNDED, to as f32 + ROUNDED);
        let reach = 0.5 * (high[k] - low[k]) * frame.scale;
        let (moved_by_from, moved_by_to) = (shift * from, shift * to);
        let first = (middle[k] - reach + moved_by_from.min(moved_by_to)) as f32;
        let last = (middle[k] + reach + moved_by_from.max(moved_by_to)) as f32;
        let nearby = first > -FARTHEST_MOVED && last < FARTHEST_MOVED; // false for NaN
        if !nearby {
            return None;
        }
        bounds.origin_min[k] = first - (BLUR + 4.0 * ROUNDED);
        bounds.origin_max[k] = last + (BLUR + 4.0 * ROUNDED);
    }
    let from = low[6] * if low[6] > 0.0 { shortest } else { longest };
    let to = high[7] * if high[7] > 0.0 { longest } else { shortest };
    bounds.nearest = (from * frame.scale - shift) as f32 - END_SPARE;
    Some((bounds, (to * frame.scale - shift) as f32 + END_SPARE))
}

/// The least and the largest of each of the eight numbers of some rays; `None` without rays.
#[simd]
fn hull<S: Simd, Q: Shot>(simd: S, shots: &[Q]) -> Option<[[f64; 8]; 2]> {
    let first = f64x8::from_slice(simd, &shots.first()?.ray().to_array());
    // Four at a time: no minimum waits for the one before.
    let (mut low, mut high) = ([first; 4], [first; 4]);
    let mut fours = shots.chunks_exact(4);
    for four in &mut fours {
        for k in 0..4 {
            let ray = f64x8::from_slice(simd, &four[k].ray().to_array());
            (low[k], high[k]) = (low[k].min(ray), high[k].max(ray));
        }
    }
    for shot in fours.remainder() {
        let ray = f64x8::from_slice(simd, &shot.ray().to_array());
        (low[0], high[0]) = (low[0].min(ray), high[0].max(ray));
    }
    let low = low[0].min(low[1]).min(low[2].min(low[3]));
    let high = high[0].max(high[1]).max(high[2].max(high[3]));
    Some([low.into(), high.into()])
}
