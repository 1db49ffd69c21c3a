//! Term of a penalty that is a quadratic form of the displacement.

use fedic_sparse::SymmetricMatrix;

use crate::equations::basis::Basis;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::NormalEquations;
use crate::equations::term::{Term, TermReport};
use crate::{Error, Monitor};

/// The penalty `factor / 2 (U - U0)^T R (U - U0)` of the displacement `U`.
pub(crate) struct Penalty<'a, const D: usize> {
    pub(crate) dofs: &'a Dofs<D>,
    /// Matrix `R` on the pattern of `dofs`.
    pub(crate) matrix: &'a SymmetricMatrix,
    pub(crate) factor: f64,
    /// Displacement `U0` without penalty; `None` for zero.
    pub(crate) rest: Option<Vec<[f64; D]>>,
}

impl<const D: usize> Term<D> for Penalty<'_, D> {
    fn assemble(
        &mut self,
        displacement: &[[f64; D]],
        basis: &dyn Basis<D>,
        equations: &mut NormalEquations,
        _monitor: &dyn Monitor,
    ) -> Result<TermReport, Error> {
        let mut displacement = displacement.to_vec();
        if let Some(rest) = &self.rest {
            let each = displacement.as_flattened_mut().iter_mut().zip(rest.as_flattened());
            each.for_each(|(u, rest)| *u -= rest);
        }
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
