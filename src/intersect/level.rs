//! The instructions that fast kernels are compiled for, and how code for one of them is chosen.

pub(super) use levels::{Level, avx2, avx512, dispatch, portable};

/// `fearless_simd` knows SSE4.2, too: by its `Level` and its `dispatch`, all kernels would be
/// compiled for that, half as much code again as for the other three, and none would run it.
#[cfg(all(
    any(target_arch = "x86", target_arch = "x86_64"),
    target_feature = "sse2",
    target_feature = "fxsr"
))]
mod levels {
    use fearless_simd::Level as Detected;
    use fearless_simd::x86::{Avx2, Avx512, Sse2};

    /// Instructions that some kernel uses, and that this processor has.
    #[derive(Clone, Copy, Debug)]
    pub(in crate::intersect) enum Level {
        Sse2(Sse2),
        Avx2(Avx2),
        Avx512(Avx512),
    }

    pub(in crate::intersect) fn portable() -> Option<Level> {
        Detected::new().as_sse2().map(Level::Sse2)
    }

    pub(in crate::intersect) fn avx2() -> Option<Level> {
        Detected::new().as_avx2().map(Level::Avx2)
    }

    pub(in crate::intersect) fn avx512() -> Option<Level> {
        Detected::new().as_avx512().map(Level::Avx512)
    }

    /// Runs code that is generic over `Simd` with the instructions of a [`Level`].
    macro_rules! dispatch {
        (@with $token:ident, $simd:pat => $code:expr) => {{
            let $simd = $token;
            fearless_simd::Simd::vectorize(
                $token,
                #[inline(always)]
                || $code,
            )
        }};
        ($level:expr, $simd:pat => $code:expr) => {{
            use $crate::intersect::level::Level;
            match $level {
                Level::Sse2(token) => dispatch!(@with token, $simd => $code),
                Level::Avx2(token) => dispatch!(@with token, $simd => $code),
                Level::Avx512(token) => dispatch!(@with token, $simd => $code),
            }
        }};
    }
    pub(in crate::intersect) use dispatch;
}

#[cfg(not(all(
    any(target_arch = "x86", target_arch = "x86_64"),
    target_feature = "sse2",
    target_feature = "fxsr"
)))]
mod levels {
    pub(in crate::intersect) use fearless_simd::{Level, dispatch};

    pub(in crate::intersect) fn portable() -> Option<Level> {
        Some(Level::baseline())
    }

    pub(in crate::intersect) fn avx2() -> Option<Level> {
        None
    }

    pub(in crate::intersect) fn avx512() -> Option<Level> {
        None
    }
}
