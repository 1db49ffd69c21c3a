//! Terms of the functional: the image term of each observation, and quadratic penalties.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation, observation, equations.

pub(crate) mod curvature;
pub(crate) mod equilibrium_gap;
pub(crate) mod halved_waves;
pub(crate) mod image;
pub(crate) mod laplacian;
pub(crate) mod penalty;
