//! Nodes and quadrature points projected into an image: by the camera itself, or by polynomials fitted over each cell.
//!
//! May import: quadrature, kernels.

pub(crate) mod cell_edges;
pub(crate) mod cell_polynomial;
pub(crate) mod cell_projection;
pub(crate) mod pointwise;
pub(crate) mod polynomial_basis;
pub(crate) mod projected_points;
pub(crate) mod visibility;
