//! Which code searches for hits.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// Instructions that some [`Kernel`] uses, and that this processor has.
///
/// `fearless_simd` knows SSE4.2, too: by its `Level` and its `dispatch`, all kernels would be
/// compiled for that, half as much code again as for the other three, and none would run it.
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
#[derive(Clone, Copy, Debug)]
pub(super) enum Level {
    Sse2(fearless_simd::x86::Sse2),
    Avx2(fearless_simd::x86::Avx2),
    Avx512(fearless_simd::x86::Avx512),
}

/// Runs code that is generic over `Simd` with the instructions of a [`Level`].
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
macro_rules! dispatch {
    (@with $token:ident, $simd:pat => $code:expr) => {{
        let $simd = $token;
        fearless_simd::Simd::vectorize(
            $token,
            #[inline(always)]
            || $code,
        )
    }};
    ($level:expr, $simd:pat => $code:expr) => {
        match $level {
            $crate::intersect::kernel::Level::Sse2(token) => {
                dispatch!(@with token, $simd => $code)
            }
            $crate::intersect::kernel::Level::Avx2(token) => {
                dispatch!(@with token, $simd => $code)
            }
            $crate::intersect::kernel::Level::Avx512(token) => {
                dispatch!(@with token, $simd => $code)
            }
        }
    };
}
#[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
pub(super) use dispatch;
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr")))]
pub(super) use fearless_simd::{Level, dispatch};

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
        #[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
        use fearless_simd::Level as Detected;
        match self {
            Self::Scalar => None,
            #[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
            Self::Portable => Detected::new().as_sse2().map(Level::Sse2),
            #[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
            Self::Avx2 => Detected::new().as_avx2().map(Level::Avx2),
            #[cfg(all(target_arch = "x86_64", target_feature = "sse2", target_feature = "fxsr"))]
            Self::Avx512 => Detected::new().as_avx512().map(Level::Avx512),
            #[cfg(not(all(
                target_arch = "x86_64",
                target_feature = "sse2",
                target_feature = "fxsr"
            )))]
            Self::Portable => Some(Level::baseline()),
            #[cfg(not(all(
                target_arch = "x86_64",
                target_feature = "sse2",
                target_feature = "fxsr"
            )))]
            Self::Avx2 | Self::Avx512 => None,
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
