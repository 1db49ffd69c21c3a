//! Starting displacements: coarse to fine, and smooth fields.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation, observation, equations, results, solve.

pub(crate) mod cell_subset;
pub(crate) mod pyramid;
pub(crate) mod smooth_field;
