//! Images: borrowed and owned grey levels, interpolation with gradients, smoothing and pyramids.
//!
//! Digital image correlation reads two images at millions of points that fall between pixels. This crate prepares an
//! image once ([`Interpolator::new`]) so that each of those readings costs a few nanoseconds, and offers the filters that
//! come before it: [`gaussian_filter`], [`central_differences`] and [`downsample`].
//!
//! # Conventions
//!
//! An image point is `(u, v)` in pixels: `u` is the column, to the right; `v` is the row, downwards; the centre of the
//! top-left pixel is `(0, 0)`. Grey levels are stored row after row, pixel `(u, v)` at index `v * width + u`, and computed
//! with in `f32`. Beyond its border an image continues as its mirror image about the centre of the last pixel
//! (`d c b | a b c d | c b a`, whole-sample symmetry, what SciPy calls `mode="mirror"`).
//!
//! # Parallel work
//!
//! Preparation and filters run in the rayon pool of the caller. Results do not depend on the number of threads, to the
//! last bit. Point evaluation is sequential: the caller decides how to cut its points.

mod coefficients;
mod differences;
mod error;
mod gaussian;
mod image;
mod interpolation;
mod interpolator;
mod kernel;
mod lanes;
mod line_filter;
mod mirror;
mod places;
mod prefilter;
mod pyramid;
mod reading;
mod stencil;
mod symmetric_filter;
mod transposition;
mod view;

pub use differences::central_differences;
pub use error::ImageError;
pub use gaussian::gaussian_filter;
pub use image::Image;
pub use interpolation::Interpolation;
pub use interpolator::Interpolator;
pub use pyramid::downsample;
pub use view::{ImageView, MAX_PIXELS, MIN_SIZE, Pixels};
