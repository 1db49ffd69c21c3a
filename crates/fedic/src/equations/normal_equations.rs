//! The normal equations of one Gauss-Newton step.

use fedic_mesh::MAX_NODES;
use fedic_sparse::SymmetricMatrix;
use nalgebra::{DMatrix, DVector};

use crate::kernels::cell_matrix::CellMatrix;

/// Hessian and right-hand side in the unknowns of a basis.
#[derive(Debug, Clone)]
pub(crate) struct NormalEquations {
    /// Absent where a factor of it is kept from before.
    pub(crate) hessian: Option<Hessian>,
    pub(crate) right_hand_side: Vec<f64>,
}

/// A Hessian: sparse in the nodal unknowns, dense in those of a reduced basis.
#[derive(Debug, Clone)]
pub(crate) enum Hessian {
    Sparse(SymmetricMatrix),
    Dense(DMatrix<f64>),
}

/// Share of one cell in the unknowns of its nodes.
#[derive(Debug, Clone)]
pub(crate) struct CellEquations<const D: usize> {
    /// Right-hand side, by node.
    pub(crate) sums: [[f64; D]; MAX_NODES],
    pub(crate) matrix: Option<CellMatrix<D>>,
}

/// Share of one cell in the unknowns of a basis.
#[derive(Debug, Clone)]
pub(crate) enum CellShare<const D: usize> {
    Nodal(CellEquations<D>),
    Reduced { matrix: Option<DMatrix<f64>>, right_hand_side: DVector<f64> },
}
