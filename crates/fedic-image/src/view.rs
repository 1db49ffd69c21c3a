//! Borrowed images in their stored type.
//!
//! Cameras deliver 8 or 16 bits per pixel. A view avoids a converted copy, up to four times larger: each consumer converts
//! one row, or less, at a time.

use std::fmt;

use fedic_memory::prefetch;
use rayon::prelude::*;

use crate::error::ImageError;

/// Smallest width and height of an image, in pixels, as the mirrored margin of the interpolation needs.
pub const MIN_SIZE: usize = 4;

/// Largest number of pixels of an image: with its margins, they are indexed by 32 bits.
pub const MAX_PIXELS: usize = 1 << 30;

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
    use super::*;

    #[test]
    fn the_first_non_finite_value_is_found_across_chunks() {
        let mut data = vec![1.0; 3 * CHECK_CHUNK];
        assert_eq!(first_non_finite(&data), None);
        data[2 * CHECK_CHUNK + 7] = f32::INFINITY;
        data[CHECK_CHUNK + 5] = f32::NAN;
        assert_eq!(first_non_finite(&data), Some(CHECK_CHUNK + 5));
    }
}
