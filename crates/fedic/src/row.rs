//! Rows of numbers as vectors read them best.

use std::ops::{Deref, DerefMut};

/// Bytes in a cache line.
pub(crate) const LINE: usize = 64;

/// Numbers side by side, the first of them where a cache line begins: no vector of them lies across two lines.
#[derive(Debug, Default)]
pub(crate) struct Row<T> {
    memory: Vec<T>,
    first: usize,
    len: usize,
}

impl<T: Copy + Default> Row<T> {
    /// This many zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        let margin = LINE / size_of::<T>();
        let memory = vec![T::default(); len + margin];
        let first = memory.as_ptr().align_offset(LINE).min(margin);
        Self { memory, first, len }
    }

    /// Makes it this long; what it holds then is of no use.
    pub(crate) fn make_room(&mut self, len: usize) {
        if self.first + len > self.memory.len() {
            *self = Self::zeros(len);
        }
        self.len = len;
    }
}

impl<T: Copy + Default> Clone for Row<T> {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len);
        copy.copy_from_slice(self);
        copy
    }
}

impl<T> Deref for Row<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.memory[self.first..self.first + self.len]
    }
}

impl<T> DerefMut for Row<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.memory[self.first..self.first + self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_where_a_cache_line_does_wherever_they_are_moved_or_copied() {
        let rows: Vec<Row<i16>> = (0..20).map(Row::zeros).collect();
        let copies = rows.clone();
        for row in rows.iter().chain(&copies) {
            assert_eq!(row.as_ptr() as usize % LINE, 0);
        }
        let mut row = Row::<f32>::default();
        for len in [3, 1000, 7] {
            row.make_room(len);
            assert_eq!((row.len(), row.as_ptr() as usize % LINE), (len, 0));
        }
    }
}
