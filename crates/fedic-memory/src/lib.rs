//! Memory as loops over many numbers read it best: rows that begin where a cache line does, large ones in large pages, and
//! questions to the memory in advance.

mod row;

pub use bytemuck::Pod;
pub use row::Row;

use prefetch_index::prefetch_index;

/// Bytes in a cache line.
pub const LINE: usize = 64;

/// Asks the memory for `count` numbers from number `first` on, a cache line at a time. It changes nothing but time: numbers that
/// do not exist may be asked for.
#[inline(always)]
pub fn prefetch<T>(numbers: &[T], first: usize, count: usize) {
    (0..count).step_by(LINE / size_of::<T>()).for_each(|k| prefetch_index(numbers, first.wrapping_add(k)));
}
