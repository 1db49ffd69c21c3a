//! Nodal fields as functions of unknowns.

use fedic_sparse::SymmetricMatrix;

use crate::SolveError;
use crate::equations::normal_equations::{CellEquations, CellShare, NormalEquations};

/// Unknowns of a nodal field and the normal equations in them.
///
/// The nodal basis has the displacement of every node as unknowns. A reduced basis has a few parameters `p` with `U = U0 + S p`, and
/// the equations `S^T M S dp = S^T b`.
pub(crate) trait Basis<const D: usize>: Sync {
    /// Prepares the basis for a step from this displacement.
    fn linearize(&mut self, _displacement: &[[f64; D]]) {}

    /// Equations without any term.
    fn equations(&self, with_hessian: bool) -> NormalEquations;

    /// Share of a cell in the unknowns of the basis. Called in parallel.
    fn reduce(&self, nodes: &[u32], share: CellEquations<D>) -> CellShare<D>;

    /// Adds the share of a cell.
    fn add_cell(&self, cell: usize, share: &CellShare<D>, equations: &mut NormalEquations);

    /// Adds `factor` times a vector of nodal unknowns to the right-hand side.
    fn add_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations);

    /// Adds `factor` times a matrix of nodal unknowns to the Hessian, if the equations have one.
    fn add_matrix(&self, factor: f64, nodal: &SymmetricMatrix, equations: &mut NormalEquations);

    /// Increment of the nodal field that solves the equations.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`] if the equations do not determine it.
    fn solve(&self, equations: NormalEquations) -> Result<Vec<[f64; D]>, SolveError>;
}
