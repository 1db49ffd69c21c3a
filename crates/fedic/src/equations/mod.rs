//! Normal equations of the nodal unknowns and the terms that they are the sum of.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation, observation.

pub(crate) mod basis;
pub(crate) mod deformation;
pub(crate) mod dofs;
pub(crate) mod normal_equations;
pub(crate) mod patches;
pub(crate) mod term;
pub(crate) mod terms;
