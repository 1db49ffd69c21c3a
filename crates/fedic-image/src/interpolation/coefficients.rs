//! Interpolation coefficients: one per pixel, with a mirrored margin.
//!
//! The margin lets every stencil be read without a test for the border.

use std::ops::Range;

use fedic_memory::{AlignedBuffer, prefetch};
use rayon::prelude::*;

use crate::filter::bands::filter_image;
use crate::filter::line::LineFilter;
use crate::filter::mirror::{mirror, mirror_ends};
use crate::view::{ImageView, MIN_SIZE};

/// Rows and columns added on each side: enough for six taps half a pixel outside the outermost centres.
pub(crate) const PADDING: usize = 3;

/// Elements after the last row, so that [`ROW_READ`] elements can be read from the start of any row of a stencil.
const SLACK: usize = ROW_READ - 2 * PADDING;

/// Most elements that the evaluation reads from the start of a row of a stencil.
pub(crate) const ROW_READ: usize = 8;

/// Most coefficients prefetched at once: half of the level 1 cache.
const MAX_PREFETCHED: usize = 4096;

/// The margin is filled by a single reflection.
const _: () = assert!(PADDING < MIN_SIZE);

/// Coefficients of an image, row after row; that of pixel `(u, v)` is at row `v + PADDING`, column `u + PADDING`.
#[derive(Clone)]
pub(crate) struct Coefficients {
    stride: usize,
    data: AlignedBuffer<f32>,
}

impl Coefficients {
    /// The grey levels of an image, filtered, in `memory` if it is large enough.
    pub(crate) fn new(view: ImageView<'_>, filter: &LineFilter<'_>, memory: AlignedBuffer<f32>) -> Self {
        let (stride, height) = (view.width() + 2 * PADDING, view.height());
        let mut data = memory;
        data.resize_for_overwrite(stride * (height + 2 * PADDING) + SLACK);
        let rows = &mut data[PADDING * stride..(PADDING + height) * stride];
        if filter.is_identity() {
            rows.par_chunks_mut(stride).enumerate().for_each(|(v, row)| {
                view.read_row(v, &mut row[PADDING..PADDING + view.width()]);
                mirror_ends(row, PADDING);
            });
        } else {
            filter_image(view, filter, rows, PADDING);
        }
        let margins = (0..PADDING).chain(PADDING + height..2 * PADDING + height);
        for row in margins {
            let source = PADDING + mirror(row as isize - PADDING as isize, height);
            data.copy_within(source * stride..(source + 1) * stride, row * stride);
        }
        Self { stride, data }
    }

    /// Columns including the margin.
    #[inline]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Prefetches the coefficients of these pixels, unless they are so many that they would evict each other.
    pub(crate) fn prefetch(&self, columns: Range<isize>, rows: Range<isize>) {
        let last = self.data.len() / self.stride;
        let within = |range: Range<isize>, end: usize| {
            let [start, stop] = [range.start, range.end].map(|x| (x.max(0) as usize).saturating_add(PADDING).min(end));
            start..stop
        };
        let (columns, rows) = (within(columns, self.stride), within(rows, last));
        if columns.is_empty() || columns.len() * rows.len() > MAX_PREFETCHED {
            return;
        }
        for row in rows {
            let start = row * self.stride;
            prefetch(&self.data, start + columns.start, columns.len());
            prefetch(&self.data, start + columns.end - 1, 1);
        }
    }

    #[inline]
    pub(crate) fn as_slice(&self) -> &[f32] {
        &self.data
    }

    /// Gives up the memory for reuse.
    pub(crate) fn into_memory(self) -> AlignedBuffer<f32> {
        self.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_margin_mirrors_the_interior() {
        let data: Vec<f32> = (0..20).map(|i| i as f32).collect();
        let view = ImageView::new_unchecked(5, 4, &data);
        for weights in [&[1.0][..], &[0.5, 0.25]] {
            let found = Coefficients::new(view, &LineFilter { weights, poles: &[] }, AlignedBuffer::default());
            let at = |row: usize, column: usize| found.data[row * found.stride + column];
            for row in 0..4 + 2 * PADDING {
                for column in 0..5 + 2 * PADDING {
                    let u = mirror(column as isize - PADDING as isize, 5);
                    let v = mirror(row as isize - PADDING as isize, 4);
                    assert_eq!(at(row, column), at(v + PADDING, u + PADDING));
                    if weights.len() == 1 {
                        assert_eq!(at(row, column), data[v * 5 + u]);
                    }
                }
            }
        }
    }
}
