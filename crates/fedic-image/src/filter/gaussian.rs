//! Gaussian smoothing.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::ImageError;
use crate::filter::rows::RowFilter;
use crate::image::Image;
use crate::view::ImageView;

/// Radius of the filter, in standard deviations.
const TRUNCATE: f64 = 4.0;
/// Wavenumbers, in radians per pixel, up to which the response is fitted closely. Speckle has little beyond: 1.8 is a wave of 3.5 px.
const PASS_BAND: f64 = 1.8;
/// Weight in the fit of the wavenumbers beyond.
const BEYOND: f64 = 1e-4;
/// Wavenumbers at which the response is fitted.
const WAVENUMBERS: usize = 128;

/// The image smoothed by a Gaussian filter of standard deviation `smoothing`, in pixels.
///
/// The weights within four standard deviations are those whose frequency response is closest to that of the Gaussian,
/// `exp(-(smoothing k)^2 / 2)`, up to 1.8 radians per pixel: of a `smoothing` of 0.8, within 1e-4 for waves of 4.2 px and longer. A
/// Gaussian sampled at the pixels has aliases there, 7e-4 in this example, and smooths a rotated or stretched image differently. The
/// border is mirrored. A `smoothing` of zero copies the image.
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
    let weights = fitted_weights(radius, smoothing);
    let total = 2.0 * weights.iter().sum::<f64>() - weights[0];
    Ok(weights.into_iter().map(|weight| (weight / total) as f32).collect())
}

/// Weights at distance 0 to `radius` by weighted least squares on the frequency response. They differ little from the sampled
/// Gaussian, to whose error the fit is applied, so that the weights of a wide filter are hardly touched.
fn fitted_weights(radius: usize, smoothing: f64) -> Vec<f64> {
    let mut bell: Vec<f64> =
        (0..=radius).map(|distance| (-0.5 * (distance as f64 / smoothing).powi(2)).exp()).collect();
    let total = 2.0 * bell.iter().sum::<f64>() - bell[0];
    bell.iter_mut().for_each(|weight| *weight /= total);
    let wavenumber = |row: usize| PI * (row as f64 + 0.5) / WAVENUMBERS as f64;
    let root_weight = |row: usize| if wavenumber(row) <= PASS_BAND { 1.0 } else { BEYOND.sqrt() };
    let wave = |row: usize, n: usize| if n == 0 { 1.0 } else { 2.0 * (n as f64 * wavenumber(row)).cos() };
    let design = DMatrix::from_fn(WAVENUMBERS, radius + 1, |row, n| root_weight(row) * wave(row, n));
    let error = DVector::from_fn(WAVENUMBERS, |row, _| {
        let response: f64 = bell.iter().enumerate().map(|(n, weight)| weight * wave(row, n)).sum();
        root_weight(row) * ((-0.5 * (smoothing * wavenumber(row)).powi(2)).exp() - response)
    });
    if let Some(factor) = (design.transpose() * &design).cholesky() {
        let correction = factor.solve(&(design.transpose() * error));
        bell.iter_mut().zip(correction.iter()).for_each(|(weight, correction)| *weight += correction);
    }
    bell
}
