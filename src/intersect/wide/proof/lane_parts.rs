//! Parts of a leaf, each for one of sixteen rays, as a structure of arrays.

use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u8x64, u32x16};

use crate::intersect::tree::nodes::LANES;

/// A tag holds the lane in its lowest bits and, above them, how often the leaf was halved.
const LANE_BITS: u32 = LANES.trailing_zeros();

/// The indices of the lanes.
const PLACES: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Sixteen parts of a leaf, each with the lane of a ray, in box coordinates.
#[derive(Clone, Copy)]
pub(crate) struct PartSixteen<S: Simd> {
    pub middle: [f32x16<S>; 2],
    pub(super) half: [f32x16<S>; 2],
    tags: u32x16<S>,
}

impl<S: Simd> PartSixteen<S> {
    /// The same part for every lane, at the lane's place.
    #[inline(always)]
    pub(super) fn all(simd: S, middle: [f32; 2], half: [f32; 2]) -> Self {
        Self {
            middle: [f32x16::splat(simd, middle[0]), f32x16::splat(simd, middle[1])],
            half: [f32x16::splat(simd, half[0]), f32x16::splat(simd, half[1])],
            tags: u32x16::from_slice(simd, &PLACES),
        }
    }

    /// The rectangles widened to `reach` half sides.
    #[inline(always)]
    pub(crate) fn widened(&self, simd: S, reach: f32) -> [[f32x16<S>; 2]; 2] {
        let reach = f32x16::splat(simd, reach);
        let ([x, y], [half_x, half_y]) = (self.middle, self.half);
        let (reach_x, reach_y) = (half_x * reach, half_y * reach);
        [[x - reach_x, x + reach_x], [y - reach_y, y + reach_y]]
    }

    /// The two halves of each part, cut across the longer side, for the lengths of the leaves' half
    /// sides.
    #[inline(always)]
    pub(super) fn halved(&self, simd: S, lengths: [f32x16<S>; 2]) -> [Self; 2] {
        let [x, y] = self.half;
        let second = (y * lengths[1]).simd_gt(x * lengths[0]);
        let (zero, half) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 0.5));
        let quarters = [x * half, y * half];
        let (by_x, by_y) = (second.select(zero, quarters[0]), second.select(quarters[1], zero));
        let half = [second.select(x, quarters[0]), second.select(quarters[1], y)];
        let tags = self.tags + u32x16::splat(simd, 1 << LANE_BITS);
        let [middle_x, middle_y] = self.middle;
        [
            Self { middle: [middle_x - by_x, middle_y - by_y], half, tags },
            Self { middle: [middle_x + by_x, middle_y + by_y], half, tags },
        ]
    }

    /// The parts that come from this many halvings, or more.
    #[inline(always)]
    pub(super) fn halved_so_often(&self, simd: S, times: u32) -> mask32x16<S> {
        self.tags.simd_ge(u32x16::splat(simd, times << LANE_BITS))
    }

    /// The lane of the part in a place.
    #[inline(always)]
    pub(super) fn lane(&self, place: usize) -> usize {
        self.tags[place] as usize % LANES
    }

    /// The byte indices that gather the numbers of the parts' lanes from a vector of lanes.
    #[inline(always)]
    pub(super) fn bytes_of_lanes(&self, simd: S) -> u8x64<S> {
        bytes_of(simd, self.tags & u32x16::splat(simd, LANES as u32 - 1))
    }
}

/// The byte indices of the four-byte numbers at these places of a vector.
#[inline(always)]
pub(crate) fn bytes_of<S: Simd>(simd: S, places: u32x16<S>) -> u8x64<S> {
    (places * u32x16::splat(simd, 0x0404_0404) + u32x16::splat(simd, 0x0302_0100)).to_bytes()
}

/// A stack of parts.
#[derive(Debug, Default)]
pub(super) struct LaneParts {
    count: usize,
    /// Each has room for at least `LANES` numbers more than `count`.
    middle: [Vec<f32>; 2],
    half: [Vec<f32>; 2],
    tags: Vec<u32>,
}

impl LaneParts {
    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.make_room();
    }

    /// Pushes the parts whose bit is set.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, parts: &PartSixteen<S>, chosen: mask32x16<S>) {
        let at = self.count..self.count + LANES;
        for k in 0..2 {
            parts.middle[k].compress(chosen).store_slice(&mut self.middle[k][at.clone()]);
            parts.half[k].compress(chosen).store_slice(&mut self.half[k][at.clone()]);
        }
        parts.tags.compress(chosen).store_slice(&mut self.tags[at]);
        self.count += chosen.to_bitmask().count_ones() as usize;
        self.make_room();
    }

    fn make_room(&mut self) {
        let room = self.count + LANES;
        if self.tags.len() < room {
            for numbers in self.middle.iter_mut().chain(&mut self.half) {
                numbers.resize(2 * room, 0.0);
            }
            self.tags.resize(2 * room, 0);
        }
    }

    /// Takes out the last sixteen parts, or as many as there are; also returns a bit for each of
    /// them.
    #[inline(always)]
    pub(super) fn pop<S: Simd>(&mut self, simd: S) -> Option<(PartSixteen<S>, u32)> {
        if self.count == 0 {
            return None;
        }
        let taken = self.count.min(LANES);
        self.count -= taken;
        let at = self.count..self.count + LANES;
        let ([middle_x, middle_y], [half_x, half_y]) = (&self.middle, &self.half);
        let parts = PartSixteen {
            middle: [
                f32x16::from_slice(simd, &middle_x[at.clone()]),
                f32x16::from_slice(simd, &middle_y[at.clone()]),
            ],
            half: [
                f32x16::from_slice(simd, &half_x[at.clone()]),
                f32x16::from_slice(simd, &half_y[at.clone()]),
            ],
            tags: u32x16::from_slice(simd, &self.tags[at]),
        };
        Some((parts, u32::MAX >> (u32::BITS - taken as u32)))
    }

    /// Takes out a part for each lane that has any, and puts it at its lane's place; also returns
    /// the bits of these lanes.
    ///
    /// Of a lane's parts, the one with the least middle is taken: so the order does not depend on
    /// the other lanes.
    #[inline(always)]
    pub(super) fn pop_by_lane<S: Simd>(&mut self, simd: S) -> Option<(PartSixteen<S>, u32)> {
        if self.count == 0 {
            return None;
        }
        let mut chosen = [usize::MAX; LANES];
        for place in 0..self.count {
            let of_lane = &mut chosen[self.tags[place] as usize % LANES];
            if *of_lane == usize::MAX || self.middle_of(place) < self.middle_of(*of_lane) {
                *of_lane = place;
            }
        }
        let (mut middle, mut half, mut tags) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2], [0; LANES]);
        let (mut lanes, mut left) = (0, 0);
        for place in 0..self.count {
            let tag = self.tags[place];
            let lane = tag as usize % LANES;
            let is_chosen = chosen[lane] == place;
            for k in 0..2 {
                let (middle_k, half_k) = (self.middle[k][place], self.half[k][place]);
                if is_chosen {
                    (middle[k][lane], half[k][lane]) = (middle_k, half_k);
                } else {
                    (self.middle[k][left], self.half[k][left]) = (middle_k, half_k);
                }
            }
            if is_chosen {
                tags[lane] = tag;
                lanes |= 1 << lane;
            } else {
                self.tags[left] = tag;
                left += 1;
            }
        }
        self.count = left;
        let parts = PartSixteen {
            middle: [f32x16::from_slice(simd, &middle[0]), f32x16::from_slice(simd, &middle[1])],
            half: [f32x16::from_slice(simd, &half[0]), f32x16::from_slice(simd, &half[1])],
            tags: u32x16::from_slice(simd, &tags),
        };
        Some((parts, lanes))
    }

    fn middle_of(&self, place: usize) -> [f32; 2] {
        [self.middle[0][place], self.middle[1][place]]
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::math::bits::set_bits;

    /// The lanes, middles and half sides of parts whose bit is set.
    fn told<S: Simd>(parts: &PartSixteen<S>, chosen: u32) -> Vec<(usize, [f32; 2], [f32; 2])> {
        let numbers = |of: &[f32x16<S>; 2], place: usize| [of[0][place], of[1][place]];
        let part = |k| (parts.lane(k), numbers(&parts.middle, k), numbers(&parts.half, k));
        set_bits(chosen).map(part).collect()
    }

    fn halves_are_kept_for_their_lanes<S: Simd>(simd: S) {
        let mut parts = LaneParts::default();
        parts.clear();
        let whole = PartSixteen::all(simd, [0.0; 2], [1.0; 2]);
        let [low, high] = whole.halved(simd, [1.0, 2.0].map(|length| f32x16::splat(simd, length)));
        // The second side is the longer one.
        assert_eq!(told(&low, 1 << 5), [(5, [0.0, -0.5], [1.0, 0.5])]);
        let of = |bits: u64| mask32x16::from_bitmask(simd, bits);
        parts.push(&high, of(0b10_1000));
        parts.push(&low, of(0b10_0000));
        assert!(low.halved_so_often(simd, 1).all_true());
        assert!(low.halved_so_often(simd, 2).all_false());

        // Each lane's least part first, in the place of the lane.
        let (first, lanes) = parts.pop_by_lane(simd).unwrap();
        let [below, above] = [[0.0, -0.5], [0.0, 0.5]];
        let half = [1.0, 0.5];
        assert_eq!(told(&first, lanes), [(3, above, half), (5, below, half)]);
        assert_eq!(lanes, 0b10_1000);
        let (second, lanes) = parts.pop_by_lane(simd).unwrap();
        assert_eq!((told(&second, lanes), lanes), (vec![(5, above, half)], 0b10_0000));
        assert!(parts.pop_by_lane(simd).is_none());

        // More than sixteen parts come out in two calls, the last ones first.
        parts.push(&high, of(0xffff));
        parts.push(&low, of(0b1001));
        let (last, taken) = parts.pop(simd).unwrap();
        assert_eq!(taken, 0xffff);
        assert_eq!(told(&last, 0b11 << 14), [(0, below, half), (3, below, half)]);
        let (rest, taken) = parts.pop(simd).unwrap();
        assert_eq!(told(&rest, taken), [(0, above, half), (1, above, half)]);
        assert!(parts.pop(simd).is_none());

        // A vector's lanes, by part.
        let numbers = f32x16::from_fn(simd, |lane| lane as f32);
        let gathered = numbers.swizzle_dyn(last.bytes_of_lanes(simd));
        assert!((0..LANES).all(|place| gathered[place] == last.lane(place) as f32));
    }

    #[test]
    fn stacks_keep_parts_and_lanes_together() {
        dispatch!(Kernel::best_level(), simd => halves_are_kept_for_their_lanes(simd));
        #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
        if let Some(simd) = fearless_simd::Level::new().as_avx2() {
            halves_are_kept_for_their_lanes(simd);
        }
    }
}
