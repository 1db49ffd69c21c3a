//! The nodal basis: the displacement of every node.

use fedic_sparse::{Factor, SpdFactor, SymmetricMatrix};

use crate::SolveError;
use crate::equations::basis::Basis;
use crate::equations::deformation::NodalDeformation;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::{CellEquations, CellShare, Hessian, NormalEquations};
use crate::quadrature::cell_quadrature::CellQuadrature;

/// Increment of every node in the reference configuration as unknowns, solved for with a sparse factor.
pub(crate) struct NodalBasis<'a, const D: usize> {
    dofs: &'a Dofs<D>,
    /// Factor used where the equations have no Hessian.
    factor: &'a Factor,
    /// Quadrature of an observation; names the poorest cell if the equations are singular.
    quadrature: &'a CellQuadrature,
    deformation: NodalDeformation<D>,
}

impl<'a, const D: usize> NodalBasis<'a, D> {
    /// The basis at no displacement.
    pub(crate) fn new(dofs: &'a Dofs<D>, factor: &'a Factor, quadrature: &'a CellQuadrature) -> Self {
        Self { dofs, factor, quadrature, deformation: NodalDeformation::none(dofs.mesh.num_nodes()) }
    }
}

impl<const D: usize> Basis<D> for NodalBasis<'_, D> {
    fn linearize(&mut self, displacement: &[[f64; D]]) {
        self.deformation = NodalDeformation::of(&self.dofs.mesh, displacement);
    }

    fn equations(&self, with_hessian: bool) -> NormalEquations {
        let pattern = &self.dofs.pattern;
        NormalEquations {
            right_hand_side: vec![0.0; pattern.num_dofs()],
            hessian: with_hessian.then(|| Hessian::Sparse(SymmetricMatrix::zeros(pattern))),
        }
    }

    fn reduce(&self, _nodes: &[u32], share: CellEquations<D>) -> CellShare<D> {
        CellShare::Nodal(share)
    }

    fn add_cell(&self, cell: usize, share: &CellShare<D>, equations: &mut NormalEquations) {
        let CellShare::Nodal(share) = share else { return };
        let all = equations.right_hand_side.as_chunks_mut::<D>().0;
        for (&node, sums) in self.dofs.pattern.cell(cell).iter().zip(&share.sums) {
            all[node as usize].iter_mut().zip(sums).for_each(|(b, sum)| *b += sum);
        }
        if let (Some(Hessian::Sparse(hessian)), Some(matrix)) = (&mut equations.hessian, &share.matrix) {
            hessian.add_cell(&self.dofs.pattern, cell, &matrix.entries());
        }
    }

    fn stretch(&self) -> f64 {
        self.deformation.stretch
    }

    fn add_material_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations) {
        equations.right_hand_side.iter_mut().zip(nodal).for_each(|(b, value)| *b += factor * value);
    }

    fn add_vector(&self, factor: f64, nodal: &[f64], equations: &mut NormalEquations) {
        self.add_material_vector(factor, &self.deformation.pulled_back(nodal), equations);
    }

    fn add_matrix(&self, factor: f64, nodal: &SymmetricMatrix, equations: &mut NormalEquations) {
        if let Some(Hessian::Sparse(hessian)) = &mut equations.hessian {
            hessian.add_congruent(&self.dofs.pattern, factor, nodal, self.deformation.gradients());
        }
    }

    fn solve(&self, equations: NormalEquations) -> Result<Vec<[f64; D]>, SolveError> {
        let mut increment = equations.right_hand_side;
        match equations.hessian {
            Some(Hessian::Sparse(hessian)) => {
                self.dofs.factorize(&hessian, false, self.quadrature)?.solve(&mut increment);
            }
            _ => self.factor.solve(&mut increment),
        }
        self.deformation.push_forward(&mut increment);
        Ok(increment.as_chunks::<D>().0.to_vec())
    }
}
