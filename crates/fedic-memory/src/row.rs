//! Rows of numbers.

use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

use crate::LINE;

/// Bytes from which a row has pages of its own: two large ones.
const LARGE: usize = 4 << 20;

/// Numbers side by side, the first of them where a cache line begins: no vector of them lies across two lines.
///
/// Large rows come from the system, zeros that cost nothing until a thread first writes there, and in large pages where it has
/// them: a page that is first written interrupts the program, and one that is read anew must be looked up.
///
/// # Examples
///
/// ```
/// use fedic_memory::{LINE, Row};
///
/// let mut row = Row::<f32>::zeros(1000);
/// row[7] = 1.0;
/// assert_eq!(row.iter().sum::<f32>(), 1.0);
/// assert_eq!(row.as_ptr() as usize % LINE, 0);
/// ```
#[derive(Debug)]
pub struct Row<T> {
    memory: Memory<T>,
    first: usize,
    len: usize,
}

#[derive(Debug)]
enum Memory<T> {
    Heap(Vec<T>),
    Pages(MmapMut),
}

impl<T: Pod> Row<T> {
    /// This many zeros.
    #[must_use]
    pub fn zeros(len: usize) -> Self {
        let bytes = len.saturating_mul(size_of::<T>());
        if bytes >= LARGE
            && let Some(pages) = large_pages(bytes)
        {
            return Self { memory: Memory::Pages(pages), first: 0, len };
        }
        let margin = LINE / size_of::<T>();
        let memory = vec![T::zeroed(); len + margin];
        let first = memory.as_ptr().align_offset(LINE).min(margin);
        Self { memory: Memory::Heap(memory), first, len }
    }

    /// Makes it this long; what it holds then is of no use.
    pub fn make_room(&mut self, len: usize) {
        if self.first + len > self.memory.numbers().len() {
            *self = Self::zeros(len);
        }
        self.len = len;
    }
}

/// Zeros from the system.
fn large_pages(bytes: usize) -> Option<MmapMut> {
    let pages = MmapMut::map_anon(bytes).ok()?;
    // A wish: where it is not granted, the pages are as usual.
    #[cfg(target_os = "linux")]
    let _ = pages.advise(memmap2::Advice::HugePage);
    Some(pages)
}

impl<T: Pod> Memory<T> {
    fn numbers(&self) -> &[T] {
        match self {
            Self::Heap(numbers) => numbers,
            Self::Pages(pages) => bytemuck::cast_slice(pages),
        }
    }

    fn numbers_mut(&mut self) -> &mut [T] {
        match self {
            Self::Heap(numbers) => numbers,
            Self::Pages(pages) => bytemuck::cast_slice_mut(pages),
        }
    }
}

impl<T> Default for Row<T> {
    fn default() -> Self {
        Self { memory: Memory::Heap(Vec::new()), first: 0, len: 0 }
    }
}

impl<T: Pod> Clone for Row<T> {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len);
        copy.copy_from_slice(self);
        copy
    }
}

impl<T: Pod> Deref for Row<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.memory.numbers()[self.first..self.first + self.len]
    }
}

impl<T: Pod> DerefMut for Row<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.memory.numbers_mut()[self.first..self.first + self.len]
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_where_a_cache_line_does_wherever_they_are_moved_or_copied() {
        let lengths = (0..20).chain([LARGE / 2 - 1, LARGE / 2, LARGE]);
        let rows: Vec<Row<i16>> = lengths.clone().map(Row::zeros).collect();
        let copies = rows.clone();
        for (row, len) in rows.iter().chain(&copies).zip(lengths.clone().chain(lengths)) {
            assert_eq!((row.len(), row.as_ptr() as usize % LINE), (len, 0));
            assert!(row.iter().all(|&number| number == 0));
        }
        let mut row = Row::<f32>::default();
        for len in [3, LARGE, 7, 2 * LARGE] {
            row.make_room(len);
            assert_eq!((row.len(), row.as_ptr() as usize % LINE), (len, 0));
        }
    }

    #[test]
    fn copies_of_large_rows_have_memory_of_their_own() {
        let mut row = Row::<f64>::zeros(LARGE / 8 + 3);
        row.iter_mut().enumerate().for_each(|(k, number)| *number = k as f64);
        let copy = row.clone();
        row[LARGE / 8] = -1.0;
        assert!(copy.iter().enumerate().all(|(k, &number)| number == k as f64));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn large_rows_ask_for_large_pages() {
        if !std::path::Path::new("/sys/kernel/mm/transparent_hugepage").exists() {
            return;
        }
        let row = Row::<f32>::zeros(LARGE);
        let address = row.as_ptr() as usize;
        let maps = std::fs::read_to_string("/proc/self/smaps").unwrap();
        let holds_it = |line: &&str| {
            let bound = |text| usize::from_str_radix(text, 16).ok();
            let bounds = line.split(' ').next().and_then(|range| range.split_once('-'));
            let range = bounds.and_then(|(from, to)| Some(bound(from)?..bound(to)?));
            range.is_some_and(|range| range.contains(&address))
        };
        let mut lines = maps.lines().skip_while(|line| !holds_it(line));
        let flags = lines.find(|line| line.starts_with("VmFlags")).unwrap();
        assert!(flags.split(' ').any(|flag| flag == "hg"));
    }
}
