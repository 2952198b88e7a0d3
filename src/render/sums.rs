//! Sums over samples that come out the same however the samples are split.

use std::ops::Range;

use thiserror::Error;

/// For many values at once (pixels × channels), the sum over a range of samples, kept so
/// that two neighbouring ranges can be joined *bit for bit*: the sum of A..B joined with
/// that of B..C is the sum of A..C.
///
/// Floating-point addition is not associative, so running totals cannot do this. Instead
/// the order of additions is fixed once for all ranges by a binary tree over the sample
/// indices: the block of level `k` at a multiple of `2^k` is the sum of its two halves.
/// A range is held as its largest whole blocks, of which there is one for `0..2^k` and
/// at most `2 log₂ n` for any range; joining two ranges merely completes blocks. As a
/// bonus, errors grow with `log₂ n` only (pairwise summation, Higham 1993), and nothing
/// is assumed about magnitudes, as fixed-point totals would.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SampleSums {
    samples: Range<u32>,
    values: usize,
    blocks: Vec<Block>,
    /// Buffers of blocks that were joined, to be used again.
    spare: Vec<Vec<f64>>,
}

/// The sum over the `2^level` samples from `first` on, a multiple of `2^level`.
#[derive(Clone, Debug, PartialEq)]
struct Block {
    first: u32,
    level: u32,
    sums: Vec<f64>,
}

/// The memory for sums could not be allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{bytes} bytes for the sums of the samples are more than can be had")]
pub(super) struct OutOfMemory {
    pub(super) bytes: u128,
}

impl SampleSums {
    /// Sums of `values` values over no samples yet; the first sample will be number `start`.
    pub(super) fn empty(start: u32, values: usize) -> Self {
        Self { samples: start..start, values, blocks: Vec::new(), spare: Vec::new() }
    }

    /// Zeros for a range of samples, to be filled by [`SampleSums::copy_from`].
    pub(super) fn zeros(samples: Range<u32>, values: usize) -> Result<Self, OutOfMemory> {
        let mut blocks = Vec::new();
        for (first, level) in whole_blocks(samples.clone()) {
            let mut sums = Vec::new();
            let bytes = values as u128 * size_of::<f64>() as u128;
            sums.try_reserve_exact(values).map_err(|_| OutOfMemory { bytes })?;
            sums.resize(values, 0.0);
            blocks.push(Block { first, level, sums });
        }
        Ok(Self { samples, values, blocks, spare: Vec::new() })
    }

    /// The samples summed.
    pub(super) fn samples(&self) -> Range<u32> {
        self.samples.clone()
    }

    /// Resets to no samples, of this many values, keeping the memory.
    pub(super) fn restart(&mut self, start: u32, values: usize) {
        self.spare.extend(self.blocks.drain(..).map(|block| block.sums));
        (self.samples, self.values) = (start..start, values);
    }

    /// Adds the next sample: `fill` writes its values into zeros.
    pub(super) fn push(&mut self, fill: impl FnOnce(&mut [f64])) {
        let mut sums = self.spare.pop().unwrap_or_default();
        sums.clear();
        sums.resize(self.values, 0.0);
        fill(&mut sums);
        self.push_block(Block { first: self.samples.end, level: 0, sums });
        self.samples.end += 1;
    }

    /// Joins the range that follows this one. The number of values must be the same.
    pub(super) fn append(&mut self, next: Self) {
        debug_assert_eq!((self.samples.end, self.values), (next.samples.start, next.values));
        for block in next.blocks {
            self.push_block(block);
        }
        self.samples.end = next.samples.end;
        self.spare.clear();
    }

    /// Adds a block after the last and completes every block that it is the end of.
    fn push_block(&mut self, block: Block) {
        self.blocks.push(block);
        while let [.., left, right] = self.blocks.as_mut_slice() {
            let halves = left.level == right.level && left.first.is_multiple_of(2 << left.level);
            if !halves {
                return;
            }
            for (sum, other) in left.sums.iter_mut().zip(&right.sums) {
                *sum += other;
            }
            left.level += 1;
            self.spare.extend(self.blocks.pop().map(|block| block.sums));
        }
    }

    /// Copies `count` values from place `from` of sums over the same samples to place `to`.
    pub(super) fn copy_from(&mut self, other: &Self, from: usize, to: usize, count: usize) {
        debug_assert_eq!(self.samples, other.samples);
        for (block, source) in self.blocks.iter_mut().zip(&other.blocks) {
            block.sums[to..to + count].copy_from_slice(&source.sums[from..from + count]);
        }
    }

    /// The mean of one value over the samples.
    pub(super) fn mean(&self, value: usize) -> f64 {
        let sum: f64 = self.blocks.iter().map(|block| block.sums[value]).sum();
        sum / f64::from(self.samples.end - self.samples.start)
    }
}

/// The largest whole blocks `(first, level)` a range of samples consists of.
fn whole_blocks(samples: Range<u32>) -> impl Iterator<Item = (u32, u32)> {
    let mut first = samples.start;
    std::iter::from_fn(move || {
        let left = samples.end - first;
        // The largest power of two that fits and that `first` is a multiple of.
        let level = left.checked_ilog2()?.min(first.trailing_zeros());
        let block = (first, level);
        first += 1 << level;
        Some(block)
    })
}

/// How many blocks a range of samples is held in.
pub(super) fn block_count(samples: Range<u32>) -> usize {
    whole_blocks(samples).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value that a running total would round differently in each grouping.
    fn value(sample: u32) -> f64 {
        let x = f64::from(sample) + 0.1;
        x.sin() * 10_f64.powi((sample * 7 % 33) as i32 - 16)
    }

    fn sum(samples: Range<u32>) -> SampleSums {
        let mut sums = SampleSums::empty(samples.start, 1);
        for sample in samples {
            sums.push(|values| values[0] = value(sample));
        }
        sums
    }

    #[test]
    fn any_split_of_any_range_gives_the_same_bits() {
        for (start, end) in [(0, 1), (0, 64), (0, 37), (3, 77), (5, 6), (63, 65), (17, 128)] {
            let whole = sum(start..end);
            assert_eq!(whole.blocks.len(), block_count(start..end));
            for middle in start + 1..end {
                let mut joined = sum(start..middle);
                joined.append(sum(middle..end));
                assert_eq!(joined.mean(0).to_bits(), whole.mean(0).to_bits());
                assert_eq!(joined.blocks, whole.blocks, "{start}..{middle}..{end}");
            }
        }
    }

    #[test]
    fn blocks_are_few() {
        assert_eq!(whole_blocks(0..64).collect::<Vec<_>>(), [(0, 6)]);
        assert_eq!(whole_blocks(3..8).collect::<Vec<_>>(), [(3, 0), (4, 2)]);
        assert_eq!(block_count(0..u32::MAX), 32);
        assert_eq!(block_count(1..u32::MAX), 62);
        assert_eq!(block_count(9..9), 0);
    }

    #[test]
    fn sums_of_any_magnitude_are_accurate() {
        for scale in [1e-300, 1e-8, 1.0, 1e8, 1e300] {
            let mut sums = SampleSums::empty(0, 2);
            for _ in 0..1000 {
                sums.push(|values| values.copy_from_slice(&[0.1 * scale, -scale]));
            }
            assert!((sums.mean(0) / (0.1 * scale) - 1.0).abs() < 1e-15);
            assert!((sums.mean(1) / -scale - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn zeros_take_copies_of_parts() {
        let tile = sum(5..12);
        let mut film = SampleSums::zeros(5..12, 3).unwrap();
        film.copy_from(&tile, 0, 1, 1);
        assert_eq!([film.mean(0), film.mean(1), film.mean(2)], [0.0, tile.mean(0), 0.0]);
        let refused = SampleSums::zeros(0..1, usize::MAX / 2);
        assert!(matches!(refused, Err(OutOfMemory { .. })));
    }

    #[test]
    fn memory_is_used_again() {
        let mut sums = sum(0..8);
        sums.restart(2, 1);
        assert_eq!(sums.samples(), 2..2);
        sums.push(|values| {
            assert_eq!(values, [0.0]);
            values[0] = 1.5;
        });
        assert_eq!(sums.mean(0), 1.5);
    }
}
