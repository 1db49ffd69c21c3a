//! Errors of texture generation and rendering.

use std::error::Error;

use fedic_image::ImageError;

/// An error of texture generation or rendering.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SyntheticError {
    /// An option is out of its range.
    #[error("{option} must be {expected}, got {value}")]
    InvalidOption {
        /// Name of the option.
        option: &'static str,
        /// Accepted values.
        expected: &'static str,
        /// The value given.
        value: String,
    },
    /// The origin or the axes of a plane are not finite, or the axes are parallel.
    #[error("a plane needs a finite origin and two finite axes that are not parallel, got {origin:?} and {axes:?}")]
    InvalidPlane {
        /// The origin given.
        origin: [f64; 3],
        /// The axes given.
        axes: [[f64; 3]; 2],
    },
    /// Some pixels see no point of the plane.
    #[error(
        "{count} of the {total} pixels in rows {} to {} see no point of the plane, the first at (u = {}, v = {}): their rays \
         miss it, or the lens model folds there",
        rows[0], rows[1] - 1, pixel[0], pixel[1]
    )]
    NotVisible {
        /// Column and row of the first of these pixels.
        pixel: [usize; 2],
        /// Number of these pixels in the rows.
        count: usize,
        /// Number of pixels in the rows.
        total: usize,
        /// First row, and the row after the last.
        rows: [usize; 2],
    },
    /// The fixed-point iteration that inverts a displacement did not converge.
    #[error(
        "the displacement could not be inverted in {iterations} fixed-point iterations: the last one still moved a point by \
         {step:e}, the tolerance is {tolerance:e}; the gradient of the displacement must stay well below 1"
    )]
    NotInvertible {
        /// Number of iterations.
        iterations: usize,
        /// Largest change of a coordinate in the last iteration, in the unit of the plane's axes.
        step: f64,
        /// Accepted change.
        tolerance: f64,
    },
    /// The given displacement failed.
    #[error("the displacement failed: {0}")]
    Displacement(#[source] Box<dyn Error + Send + Sync>),
    /// The sample points of one row of pixels, or the image, do not fit in memory.
    #[error("{count} points do not fit in memory; use a smaller image or fewer samples per pixel")]
    TooLarge {
        /// Number of points.
        count: usize,
    },
    /// The rendered image cannot be used.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The caller stopped the rendering.
    #[error("the rendering was cancelled")]
    Cancelled,
}
