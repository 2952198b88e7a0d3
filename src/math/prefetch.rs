//! Memory that is asked for before it is read.

/// Asks for the cache line in which a value begins, without waiting for it; on processors it is not known
/// for it does nothing.
///
/// A value that is read instead, to the same end, holds up all that follows until it has come.
#[inline(always)]
pub(crate) fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(value);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}
