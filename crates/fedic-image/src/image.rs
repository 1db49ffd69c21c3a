//! Owned images.

use std::fmt;

use rayon::prelude::*;

use crate::error::ImageError;
use crate::view::{ImageView, Pixels};

/// An owned image of `f32` grey levels, with the guarantees of [`ImageView`].
///
/// # Examples
///
/// ```
/// use fedic_image::Image;
///
/// let image = Image::new(4, 4, vec![0.5; 16])?;
/// assert_eq!(image.view().statistics(), (0.5, 0.0));
/// # Ok::<(), fedic_image::ImageError>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    data: Vec<f32>,
}

impl Image {
    /// Makes `data` an image of `width` columns and `height` rows; pixel `(u, v)` is at index `v * width + u`.
    ///
    /// # Errors
    ///
    /// Those of [`ImageView::new`].
    pub fn new(width: usize, height: usize, data: Vec<f32>) -> Result<Self, ImageError> {
        ImageView::new(width, height, Pixels::F32(&data))?;
        Ok(Self::new_unchecked(width, height, data))
    }

    /// An image of grey levels that are known to satisfy the conditions of [`Image::new`].
    pub(crate) fn new_unchecked(width: usize, height: usize, data: Vec<f32>) -> Self {
        Self { width, height, data }
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

    /// The grey levels, pixel `(u, v)` at index `v * width + u`.
    #[must_use]
    pub fn pixels(&self) -> &[f32] {
        &self.data
    }

    /// The grey levels as an owned vector.
    #[must_use]
    pub fn into_pixels(self) -> Vec<f32> {
        self.data
    }

    /// A borrowed view of the image.
    #[must_use]
    pub fn view(&self) -> ImageView<'_> {
        ImageView::new_unchecked(self.width, self.height, &self.data)
    }
}

impl ImageView<'_> {
    /// An owned copy in `f32`.
    #[must_use]
    pub fn to_image(&self) -> Image {
        let mut data = vec![0.0; self.width() * self.height()];
        data.par_chunks_mut(self.width()).enumerate().for_each(|(v, row)| self.read_row(v, row));
        Image::new_unchecked(self.width(), self.height(), data)
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Image({} x {})", self.width, self.height)
    }
}
