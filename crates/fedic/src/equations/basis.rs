//! Nodal fields as functions of unknowns.

use fedic_sparse::SymmetricMatrix;

use crate::SolveError;
use crate::equations::normal_equations::{CellEquations, CellShare, NormalEquations};

/// Unknowns of a nodal field and the normal equations in them.
///
/// The nodal basis has an increment of every node as unknowns, in the reference configuration: `dU = F dV`, see
/// [`deformation`](crate::equations::deformation). A reduced basis has a few parameters `p` with `U = U0 + S p`, and the equations
/// `S^T M S dp = S^T b`.
pub(crate) trait Basis<const D: usize>: Sync {
    /// Prepares the basis for a step from this displacement.
    fn linearize(&mut self, _displacement: &[[f64; D]]) {}

    /// Takes the deformation gradient as the same at all nodes, so that it leaves the null space of a penalty as it is.
    fn average_deformation(&mut self) {}

    /// Takes the deformation gradient as the rotation of its mean: a penalty in axes that turn with it is the same as without it.
    fn average_rotation(&mut self) {}

    /// Equations without any term.
    fn equations(&self, with_hessian: bool) -> NormalEquations;

    /// Share of a cell in the unknowns of the basis. Called in parallel.
    fn reduce(&self, nodes: &[u32], share: CellEquations<D>) -> CellShare<D>;

    /// Adds the share of a cell.
    fn add_cell(&self, cell: usize, share: &CellShare<D>, equations: &mut NormalEquations);

    /// Largest relative change of length in the field that the basis was prepared for.
    fn stretch(&self) -> f64;

    /// Adds `factor` times a vector of the increment in the reference configuration to the right-hand side.
    fn add_material_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations);

    /// Adds `factor` times a vector of the increment of the displacement to the right-hand side.
    fn add_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations);

    /// Adds `factor` times a matrix of the increment of the displacement to the Hessian, if the equations have one.
    fn add_matrix(&self, factor: f64, nodal: &SymmetricMatrix, equations: &mut NormalEquations);

    /// Increment of the nodal field that solves the equations. A Hessian that they hold is used until the next.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`] if the equations do not determine it.
    fn solve(&mut self, equations: NormalEquations) -> Result<Vec<[f64; D]>, SolveError>;
}
