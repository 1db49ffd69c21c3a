//! Vectorised loops over the quadrature points of a cell.
//!
//! All slices have one length, a multiple of the vector length. Kernels that depend on the number of displacement components are
//! generic in it (`D`: 2 in the plane of the mesh, 3 in space). The instruction set is chosen at run time.
//!
//! May import: quadrature.

pub(crate) mod cell_matrix;
pub(crate) mod dispatch;
pub(crate) mod gradient;
pub(crate) mod node_sums;
pub(crate) mod polynomial;
pub(crate) mod residual;
#[cfg(test)]
mod tests;
