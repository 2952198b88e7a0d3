//! Where in a pixel, a lens or a light a sample falls: Owen-scrambled Sobol points.

use std::array::from_fn;
use std::sync::LazyLock;

use sobol_burley::parts::{owen_scramble_rev, sobol_rev};

use crate::math::SplitMix;

/// Samples after which the sequence is seeded afresh: the length of the Sobol sequence
/// the direction numbers in use are made for (16 bits).
const SEQUENCE: u32 = 1 << 16;

/// The unscrambled points of numbers of which only the upper or only the lower byte is not zero, by
/// that byte. That of any number is the sum without carry (exclusive or) of those of its bytes.
///
/// All bits are in reverse order, those of numbers after that of 16 bits, as the scrambling wants
/// them.
static SOBOL: LazyLock<[[[u32; 2]; 256]; 2]> = LazyLock::new(|| {
    [24, 16].map(|shift| from_fn(|byte| [0, 1].map(|axis| sobol_rev((byte as u32) << shift, axis))))
});

/// Low-discrepancy sample points, a pure function of (seed, pixel, sample index,
/// dimension): no state, so neither threads nor the order of work can change a picture.
///
/// Each pixel has its own sequence, shuffled and Owen-scrambled by a hash (Burley,
/// "Practical Hash-based Owen Scrambling", JCGT 2020). Every two dimensions are
/// stratified together; pairs are independent of each other (padding).
///
/// The sequences are 65,536 samples long. Sample 65,536 begins the next one, scrambled
/// independently: further samples go on improving the picture, the longest strata
/// merely no longer span the two sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    seed: u64,
}

/// What two dimensions of a sample are used for. Numbers, once used, keep their
/// meaning, so that pictures stay the same when others are added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Dimensions {
    /// The place in the pixel.
    Film = 0,
}

impl Sampler {
    /// The points that belong to a seed.
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Two numbers in `[0, 1)` for one sample of one pixel.
    pub fn sample(&self, pixel: [u32; 2], index: u32, dimensions: Dimensions) -> [f64; 2] {
        self.of_pixel(pixel, dimensions).sample(index)
    }

    /// The points of one pixel: quicker for many samples of it.
    pub(super) fn of_pixel(&self, pixel: [u32; 2], dimensions: Dimensions) -> PixelSampler {
        let place = u64::from(pixel[0]) << 32 | u64::from(pixel[1]);
        let key = mix(mix(self.seed) ^ place);
        PixelSampler { key, dimensions, run: 0, sequence: Sequence::new(key, 0, dimensions) }
    }
}

/// The sample points of one pixel.
pub(super) struct PixelSampler {
    key: u64,
    dimensions: Dimensions,
    /// Which sequence is at hand.
    run: u32,
    sequence: Sequence,
}

impl PixelSampler {
    /// As [`Sampler::sample`].
    #[inline]
    pub(super) fn sample(&mut self, index: u32) -> [f64; 2] {
        let run = index / SEQUENCE;
        if run != self.run {
            (self.run, self.sequence) = (run, Sequence::new(self.key, run, self.dimensions));
        }
        self.sequence.point(index % SEQUENCE)
    }
}

/// A scrambled sequence: random words that say how.
struct Sequence {
    /// For the order of its points.
    order: u32,
    /// For their coordinates.
    places: [u32; 2],
}

impl Sequence {
    fn new(key: u64, run: u32, dimensions: Dimensions) -> Self {
        let mut words = SplitMix::new(key ^ (u64::from(run) << 32 | dimensions as u64));
        let (first, second) = (words.word(), words.word());
        Self { order: (first >> 32) as u32, places: [first as u32, (second >> 32) as u32] }
    }

    /// The point of a number below [`SEQUENCE`].
    #[inline]
    fn point(&self, index: u32) -> [f64; 2] {
        let [upper, lower] = &*SOBOL;
        let shuffled = owen_scramble_rev(index.reverse_bits(), self.order);
        let (a, b) = (upper[(shuffled >> 24) as usize], lower[(shuffled >> 16 & 0xff) as usize]);
        from_fn(|axis| {
            let scrambled = owen_scramble_rev(a[axis] ^ b[axis], self.places[axis]);
            f64::from(scrambled.reverse_bits()) / (1u64 << 32) as f64
        })
    }
}

/// Spreads every bit of a word over all others, one to one.
///
/// The first word of the stream with that seed, not the finaliser alone, so that 0 does not stay 0.
fn mix(word: u64) -> u64 {
    SplitMix::new(word).word()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn film(seed: u64, pixel: [u32; 2], index: u32) -> [f64; 2] {
        Sampler::new(seed).sample(pixel, index, Dimensions::Film)
    }

    /// How many of the `rows × columns` boxes of the unit square hold a point.
    fn boxes_met(points: &[[f64; 2]], columns: u32, rows: u32) -> usize {
        let box_of =
            |p: &[f64; 2]| ((p[0] * f64::from(columns)) as u32, (p[1] * f64::from(rows)) as u32);
        points.iter().map(box_of).collect::<HashSet<_>>().len()
    }

    #[test]
    fn every_elementary_box_holds_one_point() {
        // A (0, 2)-sequence: each aligned run of 2^k points meets each of the 2^k boxes
        // of every shape 2^i × 2^(k − i) once, in whichever pixel, after any seed.
        for (seed, pixel) in [(0, [0, 0]), (7, [1023, 5]), (u64::MAX, [9, 65_535])] {
            for start in [0, 64, SEQUENCE - 64, SEQUENCE, 5 * SEQUENCE + 128] {
                let points: Vec<_> = (start..start + 64).map(|i| film(seed, pixel, i)).collect();
                for k in 0..=6 {
                    let met = boxes_met(&points, 1 << k, 64 >> k);
                    assert_eq!(met, 64, "seed {seed}, pixel {pixel:?}, start {start}, shape {k}");
                }
            }
        }
    }

    #[test]
    fn points_lie_in_the_unit_square_and_average_to_its_middle() {
        let mut sum = [0.0; 2];
        for index in 0..4096 {
            for (sum, value) in sum.iter_mut().zip(film(3, [17, 4], index)) {
                assert!((0.0..1.0).contains(&value));
                *sum += value / 4096.0;
            }
        }
        // Stratified into 4096 intervals, a mean is off by at most 1/4096, mostly far less.
        assert!(sum.iter().all(|mean| (mean - 0.5).abs() < 1.0 / 4096.0), "{sum:?}");
    }

    #[test]
    fn each_key_has_points_of_its_own() {
        let base = film(1, [3, 4], 5);
        assert_eq!(base, film(1, [3, 4], 5));
        for other in [film(2, [3, 4], 5), film(1, [4, 3], 5), film(1, [3, 4], 6)] {
            assert_ne!(base, other);
        }
        // The same place in the next sequence is a new point.
        assert_ne!(base, film(1, [3, 4], 5 + SEQUENCE));
        // Neighbouring pixels are independent: the first points of 32 × 32 pixels fall
        // all over the square. Of 1024 random points in 1024 boxes 647 ± 11 are met.
        let first: Vec<_> = (0..1024).map(|i| film(0, [i % 32, i / 32], 0)).collect();
        let met = boxes_met(&first, 32, 32);
        assert!((600..700).contains(&met), "{met} boxes met");
    }

    /// The points of all numbers as the library gives them, without their scrambling.
    #[test]
    fn bytes_of_numbers_add_up_to_sobol_points() {
        for index in (0..SEQUENCE).step_by(7) {
            let reversed = index.reverse_bits();
            let [upper, lower] = &*SOBOL;
            let (a, b) =
                (upper[(reversed >> 24) as usize], lower[(reversed >> 16 & 0xff) as usize]);
            for axis in 0..2 {
                assert_eq!(a[axis] ^ b[axis], sobol_rev(reversed, axis as u32), "{index}");
            }
        }
    }

    #[test]
    fn a_pixel_s_points_do_not_depend_on_their_order() {
        let sampler = Sampler::new(5);
        let mut pixel = sampler.of_pixel([2, 9], Dimensions::Film);
        for index in [7, 0, SEQUENCE + 3, 2 * SEQUENCE, 7, u32::MAX, 1] {
            assert_eq!(pixel.sample(index), sampler.sample([2, 9], index, Dimensions::Film));
        }
    }

    #[test]
    fn the_largest_index_works() {
        let point = film(0, [0, 0], u32::MAX);
        assert!(point.iter().all(|x| (0.0..1.0).contains(x)));
    }
}
