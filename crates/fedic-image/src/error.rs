//! What can be wrong with an image or with what is asked of it.

use crate::interpolation::Interpolation;
use crate::view::{MAX_PIXELS, MIN_SIZE};

/// Why an image, or an operation on it, was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// One of the two sizes is zero.
    #[error("the image is empty: {width} x {height} pixels")]
    Empty {
        /// Number of columns given.
        width: usize,
        /// Number of rows given.
        height: usize,
    },
    /// One of the two sizes is below [`MIN_SIZE`].
    #[error("the image is too small: {width} x {height} pixels, at least {MIN_SIZE} x {MIN_SIZE} are needed")]
    TooSmall {
        /// Number of columns.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// There are more than [`MAX_PIXELS`] pixels.
    #[error("the image is too large: {width} x {height} pixels, at most {MAX_PIXELS} are possible; cut it in parts")]
    TooLarge {
        /// Number of columns.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// The number of grey levels is not the width times the height.
    #[error("an image of {width} x {height} pixels has {expected} grey levels, but {found} were given")]
    LengthMismatch {
        /// Number of columns given.
        width: usize,
        /// Number of rows given.
        height: usize,
        /// The width times the height.
        expected: usize,
        /// Number of grey levels given.
        found: usize,
    },
    /// A grey level is infinite or not a number; the first one in storage order.
    #[error("the grey level of pixel (u = {u}, v = {v}) is not a finite number")]
    NonFinite {
        /// Column of the pixel.
        u: usize,
        /// Row of the pixel.
        v: usize,
    },
    /// The standard deviation of a Gaussian filter is negative, not a number, or larger than the image.
    #[error("the standard deviation of the Gaussian filter must lie between 0 and {largest} pixels, got {sigma}")]
    InvalidSigma {
        /// The value given, in pixels.
        sigma: f64,
        /// The largest value accepted for this image, in pixels.
        largest: usize,
    },
    /// No interpolation has this name.
    #[error("unknown interpolation \"{name}\"; choose one of {}", Interpolation::choices())]
    UnknownInterpolation {
        /// The name given.
        name: String,
    },
}
