//! Prefetch hints.

use prefetch_index::prefetch_index;

use crate::CACHE_LINE;

/// Prefetches `count` elements from element `first` on, one cache line at a time.
///
/// A hint only: results do not change, and elements out of range are allowed.
#[inline(always)]
pub fn prefetch<T>(elements: &[T], first: usize, count: usize) {
    (0..count).step_by(CACHE_LINE / size_of::<T>()).for_each(|k| prefetch_index(elements, first.wrapping_add(k)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_out_of_range_may_be_prefetched() {
        let elements = [1.0_f32, 2.0, 3.0];
        for (first, count) in [(0, 3), (2, 100), (1000, 5), (usize::MAX - 3, 40), (0, 0)] {
            prefetch(&elements, first, count);
            prefetch::<f32>(&[], first, count);
        }
        assert_eq!(elements, [1.0, 2.0, 3.0]);
    }
}
