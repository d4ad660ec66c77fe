//! The one unsafe call of the renderer: asks the cache for something that will be read soon.

/// Asks for all of `item`; changes nothing but time.
#[inline(always)]
#[allow(unsafe_code)]
pub fn prefetch<T>(item: &T) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..size_of::<T>().div_ceil(64) {
        let address = std::ptr::from_ref(item).cast::<i8>().wrapping_add(64 * line);
        // SAFETY: the instruction belongs to SSE, which every x86-64 has, it reads nothing that a program could see,
        // and it does not fault on any address.
        unsafe {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            _mm_prefetch::<_MM_HINT_T0>(address);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = item;
}
