//! Reduced bases: the nodal field depends on the parameters of some modes.

use fedic_sparse::SymmetricMatrix;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use crate::SolveError;
use crate::equations::basis::Basis;
use crate::equations::deformation::NodalDeformation;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::{CellEquations, CellShare, Hessian, NormalEquations};
use crate::solve::basis::modes::Modes;

/// Parameters of some modes `S` as unknowns, with dense equations `S^T M S dp = S^T b`.
pub(crate) struct ReducedBasis<'a, M, const D: usize> {
    dofs: &'a Dofs<D>,
    modes: M,
    /// Added to the diagonal of the Hessian, relative to it: bounds parameters that are hardly determined.
    ridge: f64,
    stretch: f64,
    /// Inverse deformation gradient of each node, which carries the modes to the reference configuration.
    inverses: Vec<SMatrix<f64, D, D>>,
}

impl<'a, M: Modes<D>, const D: usize> ReducedBasis<'a, M, D> {
    /// The basis of some modes at no displacement.
    pub(crate) fn new(dofs: &'a Dofs<D>, modes: M, ridge: f64) -> Self {
        let inverses = vec![SMatrix::identity(); dofs.mesh.num_nodes()];
        Self { dofs, modes, ridge, stretch: 0.0, inverses }
    }

    /// Mode of one parameter at a node, in the reference configuration.
    fn material_mode(&self, node: usize, parameter: usize) -> SVector<f64, D> {
        self.inverses[node] * SVector::from_fn(|c, _| self.modes.value(node, c, parameter))
    }

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
        let deformation = NodalDeformation::of(&self.dofs.mesh, displacement);
        self.stretch = deformation.stretch;
        for (inverse, gradient) in self.inverses.iter_mut().zip(deformation.gradients()) {
            let gradient = SMatrix::<f64, D, D>::from_fn(|i, j| gradient[i][j]);
            *inverse = gradient.try_inverse().unwrap_or_else(SMatrix::identity);
        }
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
        let mut modes = DMatrix::zeros(dofs, self.modes.len());
        for (k, &node) in nodes.iter().enumerate() {
            for parameter in 0..self.modes.len() {
                modes.view_mut((k * D, parameter), (D, 1)).copy_from(&self.material_mode(node as usize, parameter));
            }
        }
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

    fn stretch(&self) -> f64 {
        self.stretch
    }

    fn add_material_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations) {
        let nodal = nodal.as_chunks::<D>().0;
        for (parameter, b) in equations.right_hand_side.iter_mut().enumerate() {
            let product = |(node, value): (usize, &[f64; D])| {
                self.material_mode(node, parameter).dot(&SVector::from_column_slice(value))
            };
            *b += factor * nodal.iter().enumerate().map(product).sum::<f64>();
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

    fn solve(&mut self, equations: NormalEquations) -> Result<Vec<[f64; D]>, SolveError> {
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
