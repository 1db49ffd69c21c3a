//! Reduced bases: the nodal field depends on the parameters of some modes.

use fedic_sparse::SymmetricMatrix;
use nalgebra::{DMatrix, DVector};

use crate::SolveError;
use crate::equations::basis::Basis;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::{CellEquations, CellShare, Hessian, NormalEquations};
use crate::solve::basis::modes::Modes;

/// Parameters of some modes `S` as unknowns, with dense equations `S^T M S dp = S^T b`.
pub(crate) struct ReducedBasis<'a, M, const D: usize> {
    pub(crate) dofs: &'a Dofs<D>,
    pub(crate) modes: M,
    /// Added to the diagonal of the Hessian, relative to it: bounds parameters that are hardly determined.
    pub(crate) ridge: f64,
}

impl<M: Modes<D>, const D: usize> ReducedBasis<'_, M, D> {
    fn num_nodes(&self) -> usize {
        self.dofs.mesh.num_nodes()
    }

    /// Mode of one parameter as a vector of nodal unknowns.
    fn mode(&self, parameter: usize) -> Vec<f64> {
        let value = |node: usize| (0..D).map(move |c| self.modes.value(node, c, parameter));
        (0..self.num_nodes()).flat_map(value).collect()
    }
}

impl<M: Modes<D>, const D: usize> Basis<D> for ReducedBasis<'_, M, D> {
    fn linearize(&mut self, displacement: &[[f64; D]]) {
        self.modes.linearize(displacement);
    }

    fn equations(&self, with_hessian: bool) -> NormalEquations {
        let size = self.modes.len();
        NormalEquations {
            right_hand_side: vec![0.0; size],
            hessian: with_hessian.then(|| Hessian::Dense(DMatrix::zeros(size, size))),
        }
    }

    fn reduce(&self, nodes: &[u32], share: CellEquations<D>) -> CellShare<D> {
        let dofs = nodes.len() * D;
        let modes = DMatrix::from_fn(dofs, self.modes.len(), |row, parameter| {
            self.modes.value(nodes[row / D] as usize, row % D, parameter)
        });
        let sums = DVector::from_row_slice(&share.sums.as_flattened()[..dofs]);
        let matrix = share.matrix.map(|matrix| DMatrix::from_row_slice(dofs, dofs, &matrix.entries()));
        CellShare::Reduced {
            matrix: matrix.map(|matrix| modes.transpose() * matrix * &modes),
            right_hand_side: modes.transpose() * sums,
        }
    }

    fn add_cell(&self, _cell: usize, share: &CellShare<D>, equations: &mut NormalEquations) {
        let CellShare::Reduced { matrix, right_hand_side } = share else { return };
        equations.right_hand_side.iter_mut().zip(right_hand_side.iter()).for_each(|(b, sum)| *b += sum);
        if let (Some(Hessian::Dense(hessian)), Some(matrix)) = (&mut equations.hessian, matrix) {
            *hessian += matrix;
        }
    }

    fn add_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations) {
        for (parameter, b) in equations.right_hand_side.iter_mut().enumerate() {
            *b += factor * self.mode(parameter).iter().zip(nodal).map(|(mode, value)| mode * value).sum::<f64>();
        }
    }

    fn add_matrix(&self, factor: f64, nodal: &SymmetricMatrix, equations: &mut NormalEquations) {
        let Some(Hessian::Dense(hessian)) = &mut equations.hessian else { return };
        let modes: Vec<Vec<f64>> = (0..self.modes.len()).map(|parameter| self.mode(parameter)).collect();
        for (column, mode) in modes.iter().enumerate() {
            let product = nodal.multiply(&self.dofs.pattern, mode);
            for (row, mode) in modes.iter().enumerate() {
                hessian[(row, column)] += factor * mode.iter().zip(&product).map(|(a, b)| a * b).sum::<f64>();
            }
        }
    }

    fn solve(&self, equations: NormalEquations) -> Result<Vec<[f64; D]>, SolveError> {
        let undetermined = || SolveError::UndeterminedParameters { parameters: self.modes.len() };
        let Some(Hessian::Dense(mut hessian)) = equations.hessian else { return Err(undetermined()) };
        for k in 0..hessian.nrows() {
            hessian[(k, k)] *= 1.0 + self.ridge;
        }
        let factor = hessian.cholesky().ok_or_else(undetermined)?;
        let step = factor.solve(&DVector::from_vec(equations.right_hand_side));
        Ok((0..self.num_nodes()).map(|node| self.modes.increment(node, step.as_slice())).collect())
    }
}
