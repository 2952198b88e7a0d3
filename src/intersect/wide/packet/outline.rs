//! Bounds shared by the rays of a packet, computed from the rays as they are given: enough to see
//! that most packets of a picture's background meet nothing, before anything else is computed for
//! them.

use fearless_simd::{Simd, SimdBase, f64x8};
use fearless_simd_macros::simd;
use glam::DVec3;

use crate::intersect::Shot;
use crate::intersect::wide::box_ray::BLUR;
use crate::intersect::wide::frames::{END_SPARE, shift_to_scene};
use crate::intersect::wide::lane_rays::PacketBounds;
use crate::intersect::wide::view::BvhView;
use crate::math::PLAIN_SQUARES;

/// The largest coordinate of moved origins for the work in f32, in scaled coordinates.
const FARTHEST_MOVED: f32 = 4.0;

/// Rounding error of an `f32` that was rounded from a number of size one or two; for size four, and
/// after one more operation, it is at most four times that.
const ROUNDED: f32 = f32::EPSILON;

/// No point of a scene is as far as this from its middle, in scaled coordinates, all of which are
/// at most one ([`ScaledFrame`](crate::patch::ScaledFrame)), nor is any point within rounding of
/// the scene.
const BESIDE: f64 = 1.75;

/// What is known of some rays.
pub(super) enum Outline {
    /// Nothing: the rays have too little in common, or lie where rounding counts.
    Unknown,
    /// All lines through the rays miss the whole scene.
    Beside,
    /// Their bounds, and the largest of their ends in scaled coordinates.
    Bounds(PacketBounds, f32),
}

/// Computes the bounds shared by all of these rays.
///
/// Everything is interval arithmetic on the ranges of the eight numbers of a ray. Unit directions
/// are the given ones over a length between the shortest and the longest that are possible; the
/// origins are moved towards the scene by one distance for all.
#[simd]
pub(super) fn outline<S: Simd, Q: Shot>(simd: S, shots: &[Q], view: &BvhView<'_>) -> Outline {
    let Some([low, high]) = hull(simd, shots) else { return Outline::Unknown };
    let (mut least, mut most) = (0.0, 0.0);
    for k in 3..6 {
        let size = low[k].max(-high[k]).max(0.0);
        least += size * size;
        most += low[k].abs().max(high[k].abs()).powi(2);
    }
    let alike = least > 0.25 * most && least > PLAIN_SQUARES.start && most < PLAIN_SQUARES.end;
    if !alike {
        return Outline::Unknown;
    }
    let (shortest, longest) = (least.sqrt(), most.sqrt());
    let (per_shortest, per_longest) = (1.0 / shortest, 1.0 / longest);

    let scaled = view.tree.frame();
    let mut middle = [0.0; 3];
    let mut square = 0.0;
    for k in 0..3 {
        middle[k] = (0.5 * (low[k] + high[k]) - scaled.center[k]) * scaled.scale;
        square += middle[k] * middle[k];
    }
    let magnitude = (0..3).map(|k| low[k].abs().max(high[k].abs())).fold(0.0, f64::max);
    if view.is_beyond_f32(magnitude) {
        return Outline::Unknown;
    }
    let unit =
        [0, 1, 2].map(|k| unit_range([low[3 + k], high[3 + k]], [per_shortest, per_longest]));
    let reach = [0, 1, 2].map(|k| 0.5 * (high[k] - low[k]) * scaled.scale);
    let along: f64 = (0..3).map(|k| middle[k] * (low[3 + k] + high[3 + k])).sum();
    let shift = shift_to_scene(square, along);

    let mut bounds = PacketBounds::default();
    for k in 0..3 {
        let [from, to] = unit[k];
        bounds.set_directions(k, from as f32 - ROUNDED, to as f32 + ROUNDED);
        let (moved_by_from, moved_by_to) = (shift * from, shift * to);
        let first = (middle[k] - reach[k] + moved_by_from.min(moved_by_to)) as f32;
        let last = (middle[k] + reach[k] + moved_by_from.max(moved_by_to)) as f32;
        let nearby = first > -FARTHEST_MOVED && last < FARTHEST_MOVED; // false for NaN
        if !nearby {
            let beside = least_distance(middle, reach, &unit) > BESIDE;
            return if beside { Outline::Beside } else { Outline::Unknown };
        }
        bounds.origin_min[k] = first - (BLUR + 4.0 * ROUNDED);
        bounds.origin_max[k] = last + (BLUR + 4.0 * ROUNDED);
    }
    let from = low[6] * if low[6] > 0.0 { shortest } else { longest };
    let to = high[7] * if high[7] > 0.0 { longest } else { shortest };
    bounds.nearest = (from * scaled.scale - shift) as f32 - END_SPARE;
    Outline::Bounds(bounds, (to * scaled.scale - shift) as f32 + END_SPARE)
}

/// The range of a component of unit vectors, from the ranges of that component of the vectors as
/// given and of one over their lengths.
fn unit_range([from, to]: [f64; 2], [per_shortest, per_longest]: [f64; 2]) -> [f64; 2] {
    [
        from * if from < 0.0 { per_shortest } else { per_longest },
        to * if to > 0.0 { per_shortest } else { per_longest },
    ]
}

/// How near to 0 lines may come that pass through points of a box, given by its middle and half
/// sides, with unit directions of these ranges.
///
/// With the middles `m` and `d`, and all else no farther from them than `r` and `e`, this is
/// `|(m + δ) × (d + ε)| ≥ |m × d| − |m| e − r`, since `d + ε` is a unit vector.
fn least_distance(middle: [f64; 3], reach: [f64; 3], unit: &[[f64; 2]; 3]) -> f64 {
    let [m, r] = [middle, reach].map(DVec3::from_array);
    let [from, to] = [0, 1].map(|end| DVec3::from_array(unit.map(|range| range[end])));
    let (d, e) = (0.5 * (from + to), 0.5 * (to - from));
    m.cross(d).length() - m.length() * e.length() - r.length()
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

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::Vec3Swizzles;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::level::dispatch;
    use crate::intersect::{Kernel, SurfaceBvh};
    use crate::math::Ray;
    use crate::math::testing::same_cases;

    /// The least and the largest coordinates of vectors.
    fn ranges(vectors: &[DVec3]) -> [[f64; 2]; 3] {
        let first = vectors[0];
        let (low, high) = vectors.iter().fold((first, first), |(a, b), v| (a.min(*v), b.max(*v)));
        [0, 1, 2].map(|k| [low[k], high[k]])
    }

    #[test]
    fn no_line_comes_nearer_than_is_said() {
        let vector = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
        let spread = || prop_oneof![Just(0.0), 0.0..0.01f64, 0.0..1.0f64];
        let bundle = (vector(), vector(), 0.1..20.0f64, spread(), spread());
        let others = prop::collection::vec((vector(), vector()), 1..20);
        proptest!(same_cases(256), |(bundle in bundle, others in others)| {
            let (origin, direction, away, origin_spread, direction_spread) = bundle;
            prop_assume!(direction.length() > 0.1);
            let lines = others.iter().map(|&(o, d)| {
                (away * origin + origin_spread * o, direction.normalize() + direction_spread * d)
            });
            let (origins, directions): (Vec<_>, Vec<_>) = lines.unzip();
            prop_assume!(directions.iter().all(|d| d.length() > 0.1));
            let lengths = directions.iter().map(|d| d.length());
            let longest = lengths.clone().fold(0.0, f64::max);
            let shortest = lengths.fold(f64::INFINITY, f64::min);
            let (o, d) = (ranges(&origins), ranges(&directions));
            let middle = o.map(|[from, to]| 0.5 * (from + to));
            let reach = o.map(|[from, to]| 0.5 * (to - from));
            let unit = d.map(|range| unit_range(range, [1.0 / shortest, 1.0 / longest]));
            let least = least_distance(middle, reach, &unit);
            let lines = origins.iter().zip(&directions);
            let nearest = lines.map(|(o, d)| o.cross(d.normalize()).length());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            prop_assert!(least <= nearest + 1e-13, "{least} of {nearest}");
            if origin_spread + direction_spread == 0.0 {
                prop_assert!(least >= nearest - 1e-13, "{least} of {nearest}");
            }
        });
    }

    /// Half the cube's side: its bounds in f32 are no larger than one.
    const HALF: f64 = 0.99;

    /// A cube whose corners are as far from the middle of the scene as anything can be.
    fn cube() -> SurfaceBvh {
        let knots = KnotVector::bezier(1).unwrap();
        let side = |normal: DVec3| {
            let (a, b) = (normal.zxy(), normal.yzx());
            let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
            let net = corners.map(|(s, t)| HALF * (normal + s * a + t * b)).to_vec();
            NurbsSurface::new(knots.clone(), knots.clone(), net, None).unwrap()
        };
        let sides = [DVec3::X, DVec3::Y, DVec3::Z].map(|normal| [side(normal), side(-normal)]);
        SurfaceBvh::build(&sides.concat()).unwrap()
    }

    #[test]
    fn what_aims_at_a_corner_is_not_beside_the_scene() {
        let bvh = cube();
        let vector = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
        let spread = || prop_oneof![0.0..0.01f64, 0.0..0.1f64, 0.0..2.0f64];
        let others = prop::collection::vec((vector(), vector(), 0.8..1.4f64), 1..64);
        let bundle = (vector(), vector(), 3.0..300.0f64, spread(), spread());
        let [beside, bounded] = [Cell::new(0), Cell::new(0)];
        let config = same_cases(600);
        proptest!(config, |(bundle in bundle, others in others, aside in 1.0..12.0f64)| {
            let (corner, direction, away, origin_spread, target_spread) = bundle;
            prop_assume!(direction.length() > 0.1);
            let corner = HALF * corner.signum();
            for aside in [1.0, aside] {
                let target = aside * corner;
                let eye = target - away * direction.normalize();
                let aimed = |o: DVec3, d: DVec3, length: f64| {
                    let origin = eye + origin_spread * o;
                    let towards = target + target_spread * d - origin;
                    Ray::new(origin, length * towards.normalize()).unwrap()
                };
                let mut rays = vec![aimed(DVec3::ZERO, DVec3::ZERO, 1.0)];
                rays.extend(others.iter().map(|&(o, d, length)| aimed(o, d, length)));
                for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                    let seen = dispatch!(level, simd => outline(simd, &rays, &bvh.view()));
                    let count = match seen {
                        Outline::Unknown => continue,
                        Outline::Beside => &beside,
                        Outline::Bounds(..) => &bounded,
                    };
                    count.set(count.get() + 1);
                    let misses = rays.iter().all(|ray| {
                        let (o, d) = (ray.origin(), ray.direction().normalize());
                        o.cross(d).length() > HALF * 3f64.sqrt()
                    });
                    prop_assert!(misses || !matches!(seen, Outline::Beside), "{rays:?}");
                }
            }
        });
        let [beside, bounded] = [beside, bounded].map(Cell::into_inner);
        assert!(beside > 20 && bounded > 10, "{beside} and {bounded}");
    }
}
