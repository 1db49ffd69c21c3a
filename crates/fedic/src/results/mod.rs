//! Results: the solution, the covariance of the displacement, and the residual as an image.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation, observation, equations, solve.

pub(crate) mod covariance;
pub(crate) mod flags;
pub(crate) mod quality;
pub(crate) mod residual_map;
pub(crate) mod solution;
pub(crate) mod verdict;
