//! Bases of the displacement: every node, or a few parameters.
//!
//! May import: error, quadrature, kernels, projection, equations.

pub(crate) mod modes;
pub(crate) mod nodal;
pub(crate) mod polynomial;
pub(crate) mod reduced;
#[cfg(test)]
pub(crate) mod rigid;
