//! Random words that are the same on every machine.

/// A stream of random words: SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom
/// number generators"), a counter whose steps are mixed. Any seed will do.
#[derive(Clone, Debug)]
pub struct SplitMix {
    state: u64,
}

impl SplitMix {
    /// 2⁶⁴ divided by the golden ratio, made odd: the step of the counter (Steele et al.).
    pub const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next word; all 64 bits are random.
    pub fn word(&mut self) -> u64 {
        self.state = self.state.wrapping_add(Self::STEP);
        Self::mix(self.state)
    }

    /// The next number, uniform in `[0, 1)`: a multiple of 2⁻⁵³.
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The finaliser, one to one: each bit of the result depends on each bit of the argument. 0
    /// stays 0.
    pub fn mix(word: u64) -> u64 {
        let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^ (word >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers that other implementations give for this seed.
    #[test]
    fn the_stream_is_that_of_split_mix_64() {
        let mut stream = SplitMix::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(expected.map(|_: u64| stream.word()), expected);
    }
}
