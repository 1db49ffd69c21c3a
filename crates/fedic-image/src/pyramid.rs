//! The step from one level of an image pyramid to the next coarser one.

use rayon::prelude::*;

use crate::error::ImageError;
use crate::image::Image;
use crate::symmetric_filter::SymmetricFilter;
use crate::view::{ImageView, MIN_SIZE};

/// The image at half its resolution: the REDUCE step of Burt and Adelson (1983).
///
/// The image is smoothed by `[1 4 6 4 1] / 16` in both directions, mirrored at the border, and kept at every other pixel:
/// pixel `(u, v)` of the result is centred on pixel `(2 u, 2 v)` of the source. A size `n` becomes `ceil(n / 2)`.
///
/// # Errors
///
/// [`ImageError::TooSmall`], with the sizes of the result, if they are below [`MIN_SIZE`].
///
/// # Examples
///
/// ```
/// use fedic_image::{Image, downsample};
///
/// let image = Image::new(9, 8, vec![3.0; 72])?;
/// let half = downsample(image.view())?;
/// assert_eq!((half.width(), half.height()), (5, 4));
/// assert!(downsample(half.view()).is_err());
/// # Ok::<(), fedic_image::ImageError>(())
/// ```
pub fn downsample(view: ImageView<'_>) -> Result<Image, ImageError> {
    let (width, height) = (view.width().div_ceil(2), view.height().div_ceil(2));
    if width < MIN_SIZE || height < MIN_SIZE {
        return Err(ImageError::TooSmall { width, height });
    }
    let filter = SymmetricFilter::new(vec![6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0]);
    let mut data = vec![0.0; width * height];
    data.par_chunks_mut(width).enumerate().for_each_init(
        || (filter.scratch(view), vec![0.0; view.width()]),
        |(scratch, smoothed), (v, row)| {
            filter.filter_row(view, 2 * v, scratch, smoothed);
            for (out, &value) in row.iter_mut().zip(smoothed.iter().step_by(2)) {
                *out = value;
            }
        },
    );
    Ok(Image::of_checked(width, height, data))
}
