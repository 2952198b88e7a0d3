//! Random numbers that depend on what they are for, not on the order in which they are drawn.

use std::f64::consts::TAU;

use glam::DVec3;
use nurbray::math::SplitMix;

/// A stream of random numbers, fixed by a seed, a stream and an index.
///
/// Every ray of an audit has a stream of its own, so that the rays are the same on any number of
/// threads.
#[derive(Clone, Debug)]
pub(crate) struct Random {
    words: SplitMix,
}

impl Random {
    /// The stream for these three numbers.
    pub(crate) fn new(seed: u64, stream: u64, index: u64) -> Self {
        let mix = SplitMix::mix;
        let seed = mix(mix(mix(seed) ^ stream.wrapping_mul(SplitMix::STEP)) ^ index);
        Self { words: SplitMix::new(seed) }
    }

    fn next(&mut self) -> u64 {
        self.words.word()
    }

    /// Uniform in `[0, 1)`, a multiple of 2⁻⁵³.
    pub(crate) fn unit(&mut self) -> f64 {
        self.words.unit()
    }

    /// Uniform in `[a, b)`.
    pub(crate) fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    /// `10^x` with `x` uniform in `[a, b)`.
    pub(crate) fn power_of_ten(&mut self, a: f64, b: f64) -> f64 {
        10f64.powf(self.between(a, b))
    }

    /// One of `0, 1, …, count − 1`; 0 when there is none.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// Yes or no.
    pub(crate) fn coin(&mut self) -> bool {
        self.next() >> 63 == 1
    }

    /// −1 or 1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.coin() { 1.0 } else { -1.0 }
    }

    /// A unit vector, uniform on the sphere (by Archimedes: its z is uniform).
    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_is_fixed_by_its_three_numbers() {
        let draw = |a, b, c| Random::new(a, b, c).next();
        assert_eq!(draw(1, 2, 3), draw(1, 2, 3));
        let streams = [draw(0, 0, 0), draw(1, 0, 0), draw(0, 1, 0), draw(0, 0, 1)];
        for (i, a) in streams.iter().enumerate() {
            assert!(streams[..i].iter().all(|b| a != b));
        }
    }

    #[test]
    fn directions_are_uniform_unit_vectors() {
        let count = 20_000;
        let mut mean = DVec3::ZERO;
        let mut squares = DVec3::ZERO;
        for index in 0..count {
            let d = Random::new(7, 0, index).direction();
            assert!((d.length() - 1.0).abs() < 1e-15);
            mean += d / count as f64;
            squares += d * d / count as f64;
        }
        // A mean of n numbers of variance 1/3 is off by less than 5 / sqrt(3 n) = 0.02.
        assert!(mean.abs().max_element() < 0.02, "{mean}");
        assert!((squares - 1.0 / 3.0).abs().max_element() < 0.02, "{squares}");
    }

    #[test]
    fn numbers_stay_in_their_range() {
        let mut random = Random::new(1, 1, 1);
        for _ in 0..1000 {
            assert!(random.below(3) < 3);
            assert!((2.0..5.0).contains(&random.between(2.0, 5.0)));
        }
        assert_eq!(random.below(0), 0);
    }
}
