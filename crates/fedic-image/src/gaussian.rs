//! Gaussian smoothing, against the noise that interpolation would otherwise pass on to the displacement.

use rayon::prelude::*;

use crate::error::ImageError;
use crate::image::Image;
use crate::symmetric_filter::SymmetricFilter;
use crate::view::ImageView;

/// Where the Gaussian is cut, in standard deviations.
const TRUNCATE: f64 = 4.0;

/// The image smoothed by a Gaussian of standard deviation `sigma`, in pixels.
///
/// The Gaussian is sampled at the pixels, cut at four standard deviations and normalised; the border is mirrored. The result
/// is that of `scipy.ndimage.gaussian_filter(image, sigma, mode="mirror", truncate=4)`. A `sigma` of zero copies the image.
///
/// # Errors
///
/// [`ImageError::InvalidSigma`] if `sigma` is negative, not a number, or larger than the image.
pub fn gaussian_filter(view: ImageView<'_>, sigma: f64) -> Result<Image, ImageError> {
    let (width, height) = (view.width(), view.height());
    let filter = SymmetricFilter::new(gaussian_weights(view, sigma)?);
    let mut data = vec![0.0; width * height];
    data.par_chunks_mut(width)
        .enumerate()
        .for_each_init(|| filter.scratch(view), |scratch, (v, row)| filter.filter_row(view, v, scratch, row));
    Ok(Image::of_checked(width, height, data))
}

/// The normalised weights at distance 0, 1, ... from the centre, of a filter no wider than the image.
pub(crate) fn gaussian_weights(view: ImageView<'_>, sigma: f64) -> Result<Vec<f32>, ImageError> {
    let largest = view.width().max(view.height());
    if !(0.0..=largest as f64).contains(&sigma) {
        return Err(ImageError::InvalidSigma { sigma, largest });
    }
    let radius = (TRUNCATE * sigma + 0.5) as usize;
    if radius == 0 {
        return Ok(vec![1.0]);
    }
    let bell: Vec<f64> = (0..=radius).map(|distance| (-0.5 * (distance as f64 / sigma).powi(2)).exp()).collect();
    let total = 2.0 * bell.iter().sum::<f64>() - bell[0];
    Ok(bell.into_iter().map(|weight| (weight / total) as f32).collect())
}
