//! One level of an image pyramid from the next finer one.

use rayon::prelude::*;

use crate::error::ImageError;
use crate::filter::rows::RowFilter;
use crate::image::Image;
use crate::view::{ImageView, MIN_SIZE};

/// Binomial weights at the distances 0, 1 and 2.
const WEIGHTS: [f32; 3] = [6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// The image at half its resolution: the REDUCE step of Burt and Adelson (1983).
///
/// The image is smoothed by `[1 4 6 4 1] / 16` in both directions, mirrored at the border, and sampled at every other
/// pixel: pixel `(u, v)` of the result is centred on pixel `(2 u, 2 v)` of the source. A size `n` becomes `ceil(n / 2)`.
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
        return Err(ImageError::TooSmall { width, height, minimum: MIN_SIZE });
    }
    let mut data = vec![0.0; width * height];
    data.par_chunks_mut(width).enumerate().for_each_init(
        || (RowFilter::new(view, &WEIGHTS), vec![0.0; view.width()]),
        |(filter, smoothed), (v, row)| {
            filter.filter_row(2 * v, smoothed);
            for (out, &value) in row.iter_mut().zip(smoothed.iter().step_by(2)) {
                *out = value;
            }
        },
    );
    Ok(Image::new_unchecked(width, height, data))
}
