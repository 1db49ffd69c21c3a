//! Interpolation between pixels: kernels and their coefficients, and the evaluation at many points.

mod coefficients;
mod derivatives;
mod evaluate;
pub(crate) mod interpolator;
mod kernel;
mod locate;
pub(crate) mod method;
mod stencil;
