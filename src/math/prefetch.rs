//! Memory that is requested before it is read.

/// Requests the cache line in which a value begins, without waiting for it; does nothing on
/// processors other than x86-64.
///
/// Reading the value for this purpose would hold up all that follows until it has come.
#[inline(always)]
pub(crate) fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(value);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}
