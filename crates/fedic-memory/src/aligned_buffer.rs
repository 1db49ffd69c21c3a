//! Buffers aligned to cache lines.

use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

use crate::CACHE_LINE;

/// Size in bytes from which a buffer is mapped from the operating system: two huge pages.
const MIN_MAPPED_BYTES: usize = 4 << 20;

/// A buffer whose first element begins a cache line, so that no aligned vector of its elements straddles two lines.
///
/// Large buffers are mapped from the operating system, which zeroes a page when it is first written, and use huge pages
/// where available: fewer page faults and fewer TLB misses.
///
/// # Examples
///
/// ```
/// use fedic_memory::{AlignedBuffer, CACHE_LINE};
///
/// let mut buffer = AlignedBuffer::<f32>::zeros(1000);
/// buffer[7] = 1.0;
/// assert_eq!(buffer.iter().sum::<f32>(), 1.0);
/// assert_eq!(buffer.as_ptr() as usize % CACHE_LINE, 0);
/// ```
#[derive(Debug)]
pub struct AlignedBuffer<T> {
    memory: Memory<T>,
    first: usize,
    len: usize,
}

#[derive(Debug)]
enum Memory<T> {
    Heap(Vec<T>),
    Mapped(MmapMut),
}

impl<T: Pod> AlignedBuffer<T> {
    /// A buffer of `len` zeros.
    #[must_use]
    pub fn zeros(len: usize) -> Self {
        let bytes = len.saturating_mul(size_of::<T>());
        if bytes >= MIN_MAPPED_BYTES
            && let Some(pages) = map_zeros(bytes)
        {
            return Self { memory: Memory::Mapped(pages), first: 0, len };
        }
        let margin = CACHE_LINE / size_of::<T>();
        let memory = vec![T::zeroed(); len + margin];
        let first = memory.as_ptr().align_offset(CACHE_LINE).min(margin);
        Self { memory: Memory::Heap(memory), first, len }
    }

    /// Sets the length, reusing the memory if it is large enough. The elements are unspecified afterwards.
    pub fn resize_for_overwrite(&mut self, len: usize) {
        if self.first + len > self.memory.elements().len() {
            *self = Self::zeros(len);
        }
        self.len = len;
    }
}

/// Zeroed pages of the operating system.
fn map_zeros(bytes: usize) -> Option<MmapMut> {
    let pages = MmapMut::map_anon(bytes).ok()?;
    // Huge pages are a hint: without them, the pages have their usual size.
    #[cfg(target_os = "linux")]
    let _ = pages.advise(memmap2::Advice::HugePage);
    Some(pages)
}

impl<T: Pod> Memory<T> {
    fn elements(&self) -> &[T] {
        match self {
            Self::Heap(elements) => elements,
            Self::Mapped(pages) => bytemuck::cast_slice(pages),
        }
    }

    fn elements_mut(&mut self) -> &mut [T] {
        match self {
            Self::Heap(elements) => elements,
            Self::Mapped(pages) => bytemuck::cast_slice_mut(pages),
        }
    }
}

impl<T> Default for AlignedBuffer<T> {
    fn default() -> Self {
        Self { memory: Memory::Heap(Vec::new()), first: 0, len: 0 }
    }
}

impl<T: Pod> Clone for AlignedBuffer<T> {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len);
        copy.copy_from_slice(self);
        copy
    }
}

impl<T: Pod> Deref for AlignedBuffer<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.memory.elements()[self.first..self.first + self.len]
    }
}

impl<T: Pod> DerefMut for AlignedBuffer<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.memory.elements_mut()[self.first..self.first + self.len]
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn buffers_are_aligned_when_created_moved_cloned_or_resized() {
        let lengths = (0..20).chain([MIN_MAPPED_BYTES / 2 - 1, MIN_MAPPED_BYTES / 2, MIN_MAPPED_BYTES]);
        let buffers: Vec<AlignedBuffer<i16>> = lengths.clone().map(AlignedBuffer::zeros).collect();
        let clones = buffers.clone();
        for (buffer, len) in buffers.iter().chain(&clones).zip(lengths.clone().chain(lengths)) {
            assert_eq!((buffer.len(), buffer.as_ptr() as usize % CACHE_LINE), (len, 0));
            assert!(buffer.iter().all(|&element| element == 0));
        }
        let mut buffer = AlignedBuffer::<f32>::default();
        for len in [3, MIN_MAPPED_BYTES, 7, 2 * MIN_MAPPED_BYTES] {
            buffer.resize_for_overwrite(len);
            assert_eq!((buffer.len(), buffer.as_ptr() as usize % CACHE_LINE), (len, 0));
        }
    }

    #[test]
    fn clones_of_mapped_buffers_do_not_share_memory() {
        let mut buffer = AlignedBuffer::<f64>::zeros(MIN_MAPPED_BYTES / 8 + 3);
        buffer.iter_mut().enumerate().for_each(|(k, element)| *element = k as f64);
        let clone = buffer.clone();
        buffer[MIN_MAPPED_BYTES / 8] = -1.0;
        assert!(clone.iter().enumerate().all(|(k, &element)| element == k as f64));
    }

    #[test]
    fn buffers_are_mapped_from_the_stated_size_on() {
        let is_mapped = |len| matches!(AlignedBuffer::<u8>::zeros(len).memory, Memory::Mapped(_));
        assert!(!is_mapped(MIN_MAPPED_BYTES - 1) && is_mapped(MIN_MAPPED_BYTES));
    }

    /// Flags of the mapping of this process that holds `address`, from `/proc/self/smaps`.
    #[cfg(target_os = "linux")]
    fn mapping_flags(address: usize) -> String {
        let maps = std::fs::read_to_string("/proc/self/smaps").unwrap();
        let holds_address = |line: &&str| {
            let bound = |text| usize::from_str_radix(text, 16).ok();
            let bounds = line.split(' ').next().and_then(|range| range.split_once('-'));
            let range = bounds.and_then(|(from, to)| Some(bound(from)?..bound(to)?));
            range.is_some_and(|range| range.contains(&address))
        };
        let mut lines = maps.lines().skip_while(|line| !holds_address(line));
        lines.find(|line| line.starts_with("VmFlags")).unwrap().to_owned()
    }

    #[test]
    #[cfg_attr(not(target_os = "linux"), ignore = "huge pages are requested on Linux only")]
    fn mapped_buffers_request_huge_pages() {
        #[cfg(target_os = "linux")]
        {
            let buffer = AlignedBuffer::<f32>::zeros(MIN_MAPPED_BYTES);
            let requested = mapping_flags(buffer.as_ptr() as usize).split(' ').any(|flag| flag == "hg");
            // A kernel without huge pages refuses the request; the buffer must be usable all the same.
            let supported = std::path::Path::new("/sys/kernel/mm/transparent_hugepage").exists();
            assert_eq!(requested, supported);
            assert!(buffer.iter().all(|&element| element == 0.0));
        }
    }
}
