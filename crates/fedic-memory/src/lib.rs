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

/// Copies as many numbers as fit. Where these are `N`, which they nearly always are, it takes no call.
#[inline(always)]
pub fn copy<const N: usize, T: Copy>(to: &mut [T], from: &[T]) {
    if let (Ok(to), Some(from)) = (<&mut [T; N]>::try_from(&mut *to), from.first_chunk()) {
        *to = *from;
        return;
    }
    let n = to.len().min(from.len());
    to[..n].copy_from_slice(&from[..n]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_are_copied_as_fit() {
        for (to, from) in [(4, 4), (4, 7), (3, 4), (7, 4), (0, 4)] {
            let (mut copied, numbers) = (vec![0; to], (1..=from).collect::<Vec<_>>());
            copy::<4, _>(&mut copied, &numbers);
            let n = to.min(from);
            assert!(copied[..n] == numbers[..n] && copied[n..].iter().all(|&number| number == 0));
        }
    }
}
