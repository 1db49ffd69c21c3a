//! Gaussian smoothing.

use rayon::prelude::*;

use crate::error::ImageError;
use crate::filter::rows::RowFilter;
use crate::image::Image;
use crate::view::ImageView;

/// Truncation of the Gaussian, in standard deviations.
const TRUNCATE: f64 = 4.0;

/// The image smoothed by a Gaussian filter of standard deviation `smoothing`, in pixels.
///
/// The Gaussian is sampled at the pixels, truncated at four standard deviations and normalised; the border is mirrored, as
/// in `scipy.ndimage.gaussian_filter(image, smoothing, mode="mirror", truncate=4)`. A `smoothing` of zero copies the image.
///
/// # Errors
///
/// [`ImageError::InvalidSmoothing`] if `smoothing` is negative, NaN, or larger than the image.
pub fn gaussian_filter(view: ImageView<'_>, smoothing: f64) -> Result<Image, ImageError> {
    let weights = gaussian_weights(view, smoothing)?;
    let mut data = vec![0.0; view.width() * view.height()];
    data.par_chunks_mut(view.width())
        .enumerate()
        .for_each_init(|| RowFilter::new(view, &weights), |filter, (v, row)| filter.filter_row(v, row));
    Ok(Image::new_unchecked(view.width(), view.height(), data))
}

/// Normalised weights at distance 0, 1, ... from the centre, of a filter no wider than the image.
pub(crate) fn gaussian_weights(view: ImageView<'_>, smoothing: f64) -> Result<Vec<f32>, ImageError> {
    let largest = view.width().max(view.height());
    if !(0.0..=largest as f64).contains(&smoothing) {
        return Err(ImageError::InvalidSmoothing { smoothing, largest });
    }
    let radius = (TRUNCATE * smoothing + 0.5) as usize;
    if radius == 0 {
        return Ok(vec![1.0]);
    }
    let bell: Vec<f64> = (0..=radius).map(|distance| (-0.5 * (distance as f64 / smoothing).powi(2)).exp()).collect();
    let total = 2.0 * bell.iter().sum::<f64>() - bell[0];
    Ok(bell.into_iter().map(|weight| (weight / total) as f32).collect())
}
