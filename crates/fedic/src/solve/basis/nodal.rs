//! The nodal basis: the displacement of every node.

use fedic_sparse::{Factor, SpdFactor, SymmetricMatrix};

use crate::SolveError;
use crate::equations::basis::Basis;
use crate::equations::deformation::NodalDeformation;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::{CellEquations, CellShare, Hessian, NormalEquations};
use crate::quadrature::cell_quadrature::CellQuadrature;

/// Trace of the block of a node, relative to the median, below which the node is held.
const MIN_TRACE: f64 = 1e-3;

/// Increment of every node in the reference configuration as unknowns, solved for with a sparse factor.
pub(crate) struct NodalBasis<'a, const D: usize> {
    dofs: &'a Dofs<D>,
    /// Factor used until the equations have a Hessian.
    factor: &'a Factor,
    /// Factor of the last Hessian.
    renewed: Option<Factor>,
    /// Quadrature of an observation; names the poorest cell if the equations are singular.
    quadrature: &'a CellQuadrature,
    deformation: NodalDeformation<D>,
}

impl<'a, const D: usize> NodalBasis<'a, D> {
    /// The basis at no displacement.
    pub(crate) fn new(dofs: &'a Dofs<D>, factor: &'a Factor, quadrature: &'a CellQuadrature) -> Self {
        Self { dofs, factor, renewed: None, quadrature, deformation: NodalDeformation::none(dofs.mesh.num_nodes()) }
    }
}

impl<const D: usize> Basis<D> for NodalBasis<'_, D> {
    fn linearize(&mut self, displacement: &[[f64; D]]) {
        self.deformation = NodalDeformation::of(&self.dofs.mesh, displacement);
    }

    fn average_deformation(&mut self) {
        self.deformation.average();
    }

    fn average_rotation(&mut self) {
        self.deformation.average_rotation();
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

    fn solve(&mut self, equations: NormalEquations) -> Result<Vec<[f64; D]>, SolveError> {
        let mut increment = equations.right_hand_side;
        if let Some(Hessian::Sparse(mut hessian)) = equations.hessian {
            hold_weak_nodes(self.dofs, &mut hessian);
            self.renewed = Some(self.dofs.factorize(&hessian, false, self.quadrature)?);
        }
        self.renewed.as_ref().unwrap_or(self.factor).solve(&mut increment);
        self.deformation.push_forward(&mut increment);
        Ok(increment.as_chunks::<D>().0.to_vec())
    }
}

/// Adds to the diagonal of nodes that hardly any point determines, so that their increments are small.
///
/// The solution does not change: the right-hand side is the same.
pub(crate) fn hold_weak_nodes<const D: usize>(dofs: &Dofs<D>, hessian: &mut SymmetricMatrix) {
    let traces: Vec<f64> =
        (0..dofs.mesh.num_nodes()).map(|node| hessian.node_diagonal(&dofs.pattern, node).sum()).collect();
    let mut sorted: Vec<f64> = traces.iter().copied().filter(|&trace| trace > 0.0).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2) else { return };
    let weak = MIN_TRACE * median;
    for (node, _) in traces.iter().enumerate().filter(|(_, trace)| **trace < weak) {
        hessian.add_to_node_diagonal(&dofs.pattern, node, weak / D as f64);
    }
}
