//! An owned image, what the filters return.

use std::fmt;

use crate::error::ImageError;
use crate::view::{ImageView, Pixels};

/// An image of `f32` grey levels that owns them; same guarantees as [`ImageView`].
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
    /// Takes `data` as an image of `width` columns and `height` rows; pixel `(u, v)` is at index `v * width + u`.
    ///
    /// # Errors
    ///
    /// Those of [`ImageView::new`].
    pub fn new(width: usize, height: usize, data: Vec<f32>) -> Result<Self, ImageError> {
        ImageView::new(width, height, Pixels::F32(&data))?;
        Ok(Self::of_checked(width, height, data))
    }

    /// An image of grey levels already known to satisfy what [`Image::new`] checks.
    pub(crate) fn of_checked(width: usize, height: usize, data: Vec<f32>) -> Self {
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

    /// The grey levels, given away.
    #[must_use]
    pub fn into_pixels(self) -> Vec<f32> {
        self.data
    }

    /// The same image, borrowed.
    #[must_use]
    pub fn view(&self) -> ImageView<'_> {
        ImageView::of_checked(self.width, self.height, &self.data)
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Image({} x {})", self.width, self.height)
    }
}
