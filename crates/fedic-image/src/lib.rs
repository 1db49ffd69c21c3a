//! Images: borrowed and owned grey levels, interpolation with gradients, smoothing and pyramids.
//!
//! Digital image correlation evaluates two images at millions of points between their pixels. [`Interpolator::new`]
//! prepares an image once, so that each evaluation costs a few nanoseconds. Filters that may precede it are
//! [`gaussian_filter`], [`central_differences`] and [`downsample`].
//!
//! # Conventions
//!
//! An image point is `(u, v)` in pixels: `u` is the column, to the right; `v` is the row, downwards; the centre of the
//! top-left pixel is `(0, 0)`. Grey levels are stored row after row, pixel `(u, v)` at index `v * width + u`, and all
//! computations use `f32`. Beyond its border an image is continued by reflection about the centre of the last pixel
//! (`d c b | a b c d | c b a`, whole-sample symmetry, SciPy's `mode="mirror"`).
//!
//! # Parallelism
//!
//! Preparation and filters run in the caller's rayon pool, with the same bits for any number of threads. Evaluation is
//! sequential: the caller distributes the points over threads.

mod error;
mod filter;
mod image;
mod interpolation;
mod simd;
mod view;

pub use error::ImageError;
pub use filter::gaussian::gaussian_filter;
pub use filter::gradient::central_differences;
pub use filter::pyramid::downsample;
pub use image::Image;
pub use interpolation::interpolator::Interpolator;
pub use interpolation::method::Interpolation;
pub use view::{ImageView, MAX_PIXELS, MIN_SIZE, Pixels};
