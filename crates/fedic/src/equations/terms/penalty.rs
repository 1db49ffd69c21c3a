//! Term of a penalty that is a quadratic form of the displacement.

use fedic_sparse::SymmetricMatrix;

use crate::equations::basis::Basis;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::NormalEquations;
use crate::equations::term::{Term, TermReport};
use crate::{Error, Monitor};

/// The penalty `factor / 2 U^T R U` of the displacement `U`.
pub(crate) struct Penalty<'a, const D: usize> {
    pub(crate) dofs: &'a Dofs<D>,
    /// Matrix `R` on the pattern of `dofs`.
    pub(crate) matrix: &'a SymmetricMatrix,
    pub(crate) factor: f64,
}

impl<const D: usize> Term<D> for Penalty<'_, D> {
    fn assemble(
        &mut self,
        displacement: &[[f64; D]],
        basis: &dyn Basis<D>,
        equations: &mut NormalEquations,
        _monitor: &dyn Monitor,
    ) -> Result<TermReport, Error> {
        let displacement = displacement.as_flattened();
        let gradient = self.matrix.multiply(&self.dofs.pattern, displacement);
        basis.add_vector(-self.factor, &gradient, equations);
        basis.add_matrix(self.factor, self.matrix, equations);
        let energy: f64 = gradient.iter().zip(displacement).map(|(g, u)| g * u).sum();
        Ok(TermReport { cost: self.factor * energy, ..TermReport::default() })
    }

    fn is_penalty(&self) -> bool {
        true
    }
}
