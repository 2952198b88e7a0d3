//! For tests of many random cases.

use proptest::test_runner::{Config, RngSeed};

/// This many random cases, the same in every run: for tests that also count how often the tested
/// case occurs, which must not depend on luck.
pub(crate) fn same_cases(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(0x5eed), ..Config::default() }
}
