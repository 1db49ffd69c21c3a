//! Borrowed images in their stored type.
//!
//! Cameras deliver 8 or 16 bits per pixel. A view avoids a converted copy, up to four times larger: each consumer converts
//! one row, or less, at a time.

use std::fmt;
use std::ops::Range;

use fedic_memory::prefetch;
use rayon::prelude::*;

use crate::error::ImageError;

/// Smallest width and height of an image, in pixels, as the mirrored margin of the interpolation needs.
pub const MIN_SIZE: usize = 4;

/// Largest number of pixels of an image: with its margins, they are indexed by 32 bits.
pub const MAX_PIXELS: usize = 1 << 30;

/// Full scales of floating-point images.
const FULL_SCALES: [f32; 6] = [1.0, 255.0, 1023.0, 4095.0, 16383.0, 65535.0];

/// Smallest number of rows of a parallel task.
const ROWS_PER_TASK: usize = 64;

/// Number of pixels at the full scale from which on they count as saturated.
const MIN_SATURATED: usize = 9;

/// Grey levels per task in the search for values that are not finite.
const CHECK_CHUNK: usize = 1 << 16;

/// Stored grey levels, row after row.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Pixels<'a> {
    /// 8 bits per pixel.
    U8(&'a [u8]),
    /// 16 bits per pixel.
    U16(&'a [u16]),
    /// 32-bit floating point, all values finite.
    F32(&'a [f32]),
}

impl Pixels<'_> {
    fn len(&self) -> usize {
        match self {
            Self::U8(data) => data.len(),
            Self::U16(data) => data.len(),
            Self::F32(data) => data.len(),
        }
    }
}

/// A borrowed image of at least [`MIN_SIZE`] x [`MIN_SIZE`] and at most [`MAX_PIXELS`] pixels, every grey level finite.
///
/// # Examples
///
/// ```
/// use fedic_image::{ImageView, Pixels};
///
/// let data: Vec<u8> = (0..20).collect();
/// let view = ImageView::new(5, 4, Pixels::U8(&data))?;
/// let mut row = [0.0; 5];
/// view.read_row(1, &mut row);
/// assert_eq!(row, [5.0, 6.0, 7.0, 8.0, 9.0]);
/// # Ok::<(), fedic_image::ImageError>(())
/// ```
#[derive(Clone, Copy)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    pixels: Pixels<'a>,
}

impl<'a> ImageView<'a> {
    /// Views `pixels` as an image of `width` columns and `height` rows; pixel `(u, v)` is at index `v * width + u`.
    ///
    /// # Errors
    ///
    /// [`ImageError::Empty`], [`ImageError::TooSmall`] or [`ImageError::TooLarge`] for the sizes,
    /// [`ImageError::LengthMismatch`] if `pixels` does not hold `width * height` grey levels, [`ImageError::NonFinite`] for
    /// the first infinite value or NaN.
    pub fn new(width: usize, height: usize, pixels: Pixels<'a>) -> Result<Self, ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::Empty { width, height });
        }
        let (expected, found) = (width.saturating_mul(height), pixels.len());
        if expected != found {
            return Err(ImageError::LengthMismatch { width, height, expected, found });
        }
        if width < MIN_SIZE || height < MIN_SIZE {
            return Err(ImageError::TooSmall { width, height, minimum: MIN_SIZE });
        }
        if expected > MAX_PIXELS {
            return Err(ImageError::TooLarge { width, height, maximum: MAX_PIXELS });
        }
        if let Pixels::F32(data) = pixels
            && let Some(index) = first_non_finite(data)
        {
            return Err(ImageError::NonFinite { u: index % width, v: index / width });
        }
        Ok(Self { width, height, pixels })
    }

    /// A view of grey levels that are known to satisfy the conditions of [`ImageView::new`].
    pub(crate) fn new_unchecked(width: usize, height: usize, data: &'a [f32]) -> Self {
        Self { width, height, pixels: Pixels::F32(data) }
    }

    /// Number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Full scale of the grey levels, if more than a few pixels reach it: they may be saturated.
    ///
    /// 255 of 8 bits; of 16 bits the largest grey level if it is the largest of a number of 8 bits or more, in the low or in the high bits;
    /// of floating-point numbers the largest if it is 1, or the largest of 8, 10, 12, 14 or 16 bits.
    #[must_use]
    pub fn full_scale(&self) -> Option<f32> {
        let full = match self.pixels {
            Pixels::U8(_) => 255.0,
            Pixels::U16(data) => {
                let largest = data.par_chunks(CHECK_CHUNK).map(|part| part.iter().copied().max().unwrap_or(0)).max()?;
                let (low, high) = (u32::from(largest) + 1, (1_u32 << 16) - u32::from(largest));
                let is_full =
                    largest >= 255 && (low.is_power_of_two() || (largest > 1 << 15 && high.is_power_of_two()));
                is_full.then(|| f32::from(largest))?
            }
            Pixels::F32(data) => {
                let of_part = |part: &[f32]| part.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                let largest = data.par_chunks(CHECK_CHUNK).map(of_part).reduce(|| f32::NEG_INFINITY, f32::max);
                FULL_SCALES.contains(&largest).then_some(largest)?
            }
        };
        (self.count_at(full, 0..self.width, 0..self.height) >= MIN_SATURATED).then_some(full)
    }

    /// The full scale, if it is reached by all pixels of some square of this side.
    #[must_use]
    pub fn full_scale_of_square(&self, side: usize) -> Option<f32> {
        let full = self.full_scale()?;
        // Number of consecutive rows, up to the present one, in which a run of pixels ends at each column.
        let mut rows = vec![0; self.width];
        for v in 0..self.height {
            if self.count_at(full, 0..self.width, v..v + 1) < side {
                rows.fill(0);
                continue;
            }
            let mut run = 0;
            for (u, rows) in rows.iter_mut().enumerate() {
                run = if self.is_at(full, v * self.width + u) { run + 1 } else { 0 };
                *rows = if run >= side { *rows + 1 } else { 0 };
                if *rows >= side {
                    return Some(full);
                }
            }
        }
        None
    }

    /// Whether each pixel is at a grey level, row after row.
    #[must_use]
    pub fn pixels_at(&self, level: f32) -> Vec<bool> {
        (0..self.width * self.height).map(|pixel| self.is_at(level, pixel)).collect()
    }

    /// Share of the pixels at the [full scale](Self::full_scale) in a rectangle from the pixel `low` to before the pixel `high`.
    #[must_use]
    pub fn saturated_share(&self, low: [usize; 2], high: [usize; 2]) -> f64 {
        let full = match self.pixels {
            Pixels::U8(_) => Some(255.0),
            _ => self.full_scale(),
        };
        let Some(full) = full else { return 0.0 };
        let (columns, rows) = (low[0]..high[0].min(self.width), low[1]..high[1].min(self.height));
        if columns.is_empty() || rows.is_empty() {
            return 0.0;
        }
        let pixels = columns.len() * rows.len();
        let saturated = self.count_at(full, columns, rows);
        if saturated < MIN_SATURATED { 0.0 } else { saturated as f64 / pixels as f64 }
    }

    /// Number of pixels of a rectangle that are at a grey level.
    fn count_at(&self, level: f32, columns: Range<usize>, rows: Range<usize>) -> usize {
        let of_row = |v: usize| {
            let part = v * self.width + columns.start..v * self.width + columns.end;
            match self.pixels {
                Pixels::U8(data) => count_equal(&data[part], level as u8),
                Pixels::U16(data) => count_equal(&data[part], level as u16),
                Pixels::F32(data) => count_equal(&data[part], level),
            }
        };
        rows.into_par_iter().with_min_len(ROWS_PER_TASK).map(of_row).sum()
    }

    fn is_at(&self, level: f32, pixel: usize) -> bool {
        match self.pixels {
            Pixels::U8(data) => f32::from(data[pixel]) == level,
            Pixels::U16(data) => f32::from(data[pixel]) == level,
            Pixels::F32(data) => data[pixel] == level,
        }
    }

    /// Converts row `v` into `out`, of length [`width`](Self::width).
    ///
    /// # Panics
    ///
    /// If the image has no row `v`, or if `out` has another length.
    pub fn read_row(&self, v: usize, out: &mut [f32]) {
        assert_eq!(out.len(), self.width, "the output must have one element per column");
        self.read_segment(v, 0, out);
    }

    /// Converts the `out.len()` pixels of row `v` that begin at column `u`.
    #[inline]
    pub(crate) fn read_segment(&self, v: usize, u: usize, out: &mut [f32]) {
        let start = v * self.width + u;
        let range = start..start + out.len();
        match self.pixels {
            Pixels::U8(data) => convert(&data[range], out),
            Pixels::U16(data) => convert(&data[range], out),
            Pixels::F32(data) => out.copy_from_slice(&data[range]),
        }
    }

    /// Prefetches the cache line of the pixel `(u, v)`.
    #[inline]
    pub(crate) fn prefetch(&self, v: usize, u: usize) {
        let index = v * self.width + u;
        match self.pixels {
            Pixels::U8(data) => prefetch(data, index, 1),
            Pixels::U16(data) => prefetch(data, index, 1),
            Pixels::F32(data) => prefetch(data, index, 1),
        }
    }

    /// Mean and population standard deviation of the grey levels.
    #[must_use]
    pub fn statistics(&self) -> (f64, f64) {
        let rows: Vec<(f64, f64)> = (0..self.height)
            .into_par_iter()
            .map_init(
                || vec![0.0; self.width],
                |row, v| {
                    self.read_row(v, row);
                    mean_and_variance(row)
                },
            )
            .collect();
        let count = self.height as f64;
        let mean = rows.iter().map(|(mean, _)| mean).sum::<f64>() / count;
        let variance =
            rows.iter().map(|(row_mean, variance)| variance + (row_mean - mean).powi(2)).sum::<f64>() / count;
        (mean, variance.sqrt())
    }
}

impl fmt::Debug for ImageView<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stored = match self.pixels {
            Pixels::U8(_) => "u8",
            Pixels::U16(_) => "u16",
            Pixels::F32(_) => "f32",
        };
        write!(formatter, "ImageView({} x {} {stored})", self.width, self.height)
    }
}

#[inline]
fn convert<T: Copy + Into<f32>>(source: &[T], out: &mut [f32]) {
    for (out, &grey) in out.iter_mut().zip(source) {
        *out = grey.into();
    }
}

/// Number of entries that equal `value`.
fn count_equal<T: PartialEq + Copy>(data: &[T], value: T) -> usize {
    // Counts of 8 bits are added in wide vectors.
    let short = |part: &[T]| part.iter().fold(0_u8, |count, &entry| count + u8::from(entry == value));
    data.chunks(usize::from(u8::MAX)).map(|part| usize::from(short(part))).sum()
}

fn first_non_finite(data: &[f32]) -> Option<usize> {
    data.par_chunks(CHECK_CHUNK).enumerate().find_map_first(|(chunk, values)| {
        values.iter().position(|grey| !grey.is_finite()).map(|index| chunk * CHECK_CHUNK + index)
    })
}

fn mean_and_variance(row: &[f32]) -> (f64, f64) {
    let count = row.len() as f64;
    let mean = sum(row, |grey| grey) / count;
    (mean, sum(row, |grey| (grey - mean).powi(2)) / count)
}

/// The sum of `term` over `row`, in eight interleaved partial sums that vectorise.
fn sum(row: &[f32], term: impl Fn(f64) -> f64) -> f64 {
    let (blocks, rest) = row.as_chunks::<8>();
    let mut partial = [0.0; 8];
    for block in blocks {
        for (partial, &grey) in partial.iter_mut().zip(block) {
            *partial += term(f64::from(grey));
        }
    }
    partial.iter().sum::<f64>() + rest.iter().map(|&grey| term(f64::from(grey))).sum::<f64>()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn full_scale_is_reached_by_more_than_a_few_pixels() {
        let with = |saturated: usize| (0..100).map(|k| if k < saturated { 255 } else { 7 }).collect::<Vec<u8>>();
        let full = |data: &[u8]| ImageView::new(10, 10, Pixels::U8(data)).unwrap().full_scale();
        assert_eq!([full(&with(MIN_SATURATED - 1)), full(&with(MIN_SATURATED))], [None, Some(255.0)]);
        for (largest, expected) in
            [(1023, true), (4095, true), (65_520, true), (65_535, true), (1000, false), (63, false)]
        {
            let data: Vec<u16> = (0..100).map(|k| if k < 50 { largest } else { 3 }).collect();
            let found = ImageView::new(10, 10, Pixels::U16(&data)).unwrap().full_scale();
            assert_eq!(found, expected.then_some(f32::from(largest)), "{largest}");
        }
        for (largest, expected) in [(1.0, true), (255.0, true), (254.9, false)] {
            let data: Vec<f32> = (0..100).map(|k| if k < 50 { largest } else { 0.5 }).collect();
            assert_eq!(ImageView::new(10, 10, Pixels::F32(&data)).unwrap().full_scale().is_some(), expected);
        }
    }

    #[test]
    fn a_square_at_the_full_scale_is_found() {
        for (left, top, side) in [(0, 0, 3), (7, 7, 3), (2, 4, 4)] {
            let inside = |k: usize| (left..left + side).contains(&(k % 10)) && (top..top + side).contains(&(k / 10));
            let data: Vec<u8> = (0..100).map(|k| if inside(k) { 255 } else { 7 }).collect();
            let view = ImageView::new(10, 10, Pixels::U8(&data)).unwrap();
            assert_eq!(view.full_scale_of_square(side), Some(255.0), "{left} {top} {side}");
            assert_eq!(view.full_scale_of_square(side + 1), None);
            assert_eq!(view.pixels_at(255.0).iter().filter(|&&at| at).count(), side * side);
        }
        let stripes: Vec<u8> = (0..100).map(|k| if k / 10 % 2 == 0 { 255 } else { 7 }).collect();
        assert_eq!(ImageView::new(10, 10, Pixels::U8(&stripes)).unwrap().full_scale_of_square(2), None);
    }

    #[test]
    fn saturated_share_counts_a_rectangle() {
        let data: Vec<u8> = (0..100).map(|k| if k < 30 { 255 } else { 7 }).collect();
        let view = ImageView::new(10, 10, Pixels::U8(&data)).unwrap();
        assert_eq!(view.saturated_share([0, 0], [10, 10]), 0.3);
        assert_eq!(view.saturated_share([0, 2], [9, 4]), 0.5);
        assert_eq!(view.saturated_share([5, 5], [99, 99]), 0.0);
        assert_eq!(view.saturated_share([12, 0], [14, 3]), 0.0);
    }

    #[test]
    fn the_first_non_finite_value_is_found_across_chunks() {
        let mut data = vec![1.0; 3 * CHECK_CHUNK];
        assert_eq!(first_non_finite(&data), None);
        data[2 * CHECK_CHUNK + 7] = f32::INFINITY;
        data[CHECK_CHUNK + 5] = f32::NAN;
        assert_eq!(first_non_finite(&data), Some(CHECK_CHUNK + 5));
    }
}
