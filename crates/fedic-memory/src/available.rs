//! The memory that can still be allocated.

/// Returns `true` if this many bytes can be allocated at once now.
///
/// An allocation that fails ends the process. Before a large one this tells whether it would.
///
/// # Examples
///
/// ```
/// assert!(fedic_memory::is_available(1 << 20));
/// assert!(!fedic_memory::is_available(usize::MAX));
/// ```
#[must_use]
pub fn is_available(bytes: usize) -> bool {
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}
