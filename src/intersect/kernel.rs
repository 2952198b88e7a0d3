//! Which code searches for hits.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::level::{self, Level};

/// Which code searches for hits. All give the same answers, to the stated accuracy; one kernel
/// gives the same bits on every processor of one architecture that can run it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kernel {
    /// The readable specification: one ray at a time in f64.
    Scalar,
    /// Many rays or many boxes at a time, with instructions that every processor of its
    /// architecture has.
    Portable,
    /// Many rays or many boxes at a time, with AVX2.
    Avx2,
    /// Many rays or many boxes at a time, with AVX-512.
    Avx512,
}

impl Kernel {
    /// Every kernel, the plainest first.
    pub const ALL: &'static [Self] = &[Self::Scalar, Self::Portable, Self::Avx2, Self::Avx512];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this processor can run it.
    pub fn is_available(self) -> bool {
        self == Self::Scalar || self.level().is_some()
    }

    /// The instructions it uses, if this processor has them; none for the scalar kernel.
    pub(super) fn level(self) -> Option<Level> {
        match self {
            Self::Scalar => None,
            Self::Portable => level::portable(),
            Self::Avx2 => level::avx2(),
            Self::Avx512 => level::avx512(),
        }
    }
}

#[cfg(test)]
impl Kernel {
    /// The instructions of the fastest kernel, for tests that any will do.
    pub(super) fn best_level() -> Level {
        Self::default().level().unwrap()
    }
}

impl Default for Kernel {
    /// The fastest this processor can run.
    fn default() -> Self {
        let fastest_first = Self::ALL.iter().rev();
        fastest_first.copied().find(|kernel| kernel.is_available()).unwrap_or(Self::Scalar)
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that no kernel has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown kernel \"{0}\"; known: scalar, portable, avx2, avx512")]
pub struct UnknownKernel(String);

impl FromStr for Kernel {
    type Err = UnknownKernel;

    fn from_str(name: &str) -> Result<Self, UnknownKernel> {
        let known = Self::ALL.iter().copied().find(|kernel| kernel.name() == name);
        known.ok_or_else(|| UnknownKernel(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn kernels_are_known_by_their_names() {
        for &kernel in Kernel::ALL {
            assert_eq!(kernel.name().parse(), Ok(kernel));
        }
        assert_eq!(Kernel::ALL.iter().collect::<HashSet<_>>().len(), Kernel::ALL.len());
        let names: Vec<_> = Kernel::ALL.iter().map(|kernel| kernel.name()).collect();
        let message = "sse".parse::<Kernel>().unwrap_err().to_string();
        assert_eq!(message, format!("unknown kernel \"sse\"; known: {}", names.join(", ")));
    }
}
