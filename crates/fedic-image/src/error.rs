//! Errors.

/// An image or an argument that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The width or the height is zero.
    #[error("the image is empty: {width} x {height} pixels")]
    Empty {
        /// Number of columns given.
        width: usize,
        /// Number of rows given.
        height: usize,
    },
    /// The width or the height is too small.
    #[error("the image is too small: {width} x {height} pixels, at least {minimum} x {minimum} are needed")]
    TooSmall {
        /// Number of columns.
        width: usize,
        /// Number of rows.
        height: usize,
        /// Smallest width and height accepted.
        minimum: usize,
    },
    /// The image has too many pixels.
    #[error("the image is too large: {width} x {height} pixels, at most {maximum} are possible; split it")]
    TooLarge {
        /// Number of columns.
        width: usize,
        /// Number of rows.
        height: usize,
        /// Largest number of pixels accepted.
        maximum: usize,
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
    /// A grey level is infinite or NaN; the first one in storage order.
    #[error("the grey level of pixel (u = {u}, v = {v}) is not a finite number")]
    NonFinite {
        /// Column of the pixel.
        u: usize,
        /// Row of the pixel.
        v: usize,
    },
    /// The standard deviation of a Gaussian filter is negative, NaN, or larger than the image.
    #[error("the standard deviation of the Gaussian filter must lie between 0 and {largest} pixels, got {smoothing}")]
    InvalidSmoothing {
        /// The value given, in pixels.
        smoothing: f64,
        /// The largest value accepted for this image, in pixels.
        largest: usize,
    },
    /// No interpolation has this name.
    #[error("unknown interpolation \"{name}\"; choose one of {}", known.join(", "))]
    UnknownInterpolation {
        /// The name given.
        name: String,
        /// The names of all interpolations.
        known: &'static [&'static str],
    },
}
