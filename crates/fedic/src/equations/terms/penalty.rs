//! Term of a penalty that is a quadratic form of the displacement.

use fedic_sparse::SymmetricMatrix;

use crate::equations::basis::Basis;
use crate::equations::deformation::{NodalDeformation, Tensor};
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
    pub(crate) rest: Rest<D>,
}

/// Displacement `U0` without penalty.
pub(crate) enum Rest<const D: usize> {
    /// None.
    Zero,
    /// A given displacement.
    Field(Vec<[f64; D]>),
    /// The mean rotation `Q` of the displacement itself. The penalty is that of `Q^T (X + U) - X`: a strain with any rotation costs what
    /// it costs without. `Q` is that of the last displacement, not varied with it.
    MeanRotation,
}

impl<const D: usize> Penalty<'_, D> {
    /// Displacement in axes turned by the rotation.
    fn turned_back(&self, displacement: &[[f64; D]], rotation: &Tensor<D>) -> Vec<[f64; D]> {
        let of_node = |(point, u): (&[f64; 3], &[f64; D])| -> [f64; D] {
            let place: [f64; D] = std::array::from_fn(|c| point[c] + u[c]);
            transposed(rotation, &place, |c| point[c])
        };
        self.dofs.mesh.points().iter().zip(displacement).map(of_node).collect()
    }

    /// Adds the terms of the gradient `R (U - U0)` and of `R`, and returns `(U - U0)^T R (U - U0)`.
    fn add(
        &self,
        basis: &dyn Basis<D>,
        equations: &mut NormalEquations,
        from_rest: &[[f64; D]],
        turn: Option<&Tensor<D>>,
    ) -> f64 {
        let from_rest = from_rest.as_flattened();
        let mut gradient = self.matrix.multiply(&self.dofs.pattern, from_rest);
        let energy = gradient.iter().zip(from_rest).map(|(g, u)| g * u).sum();
        match turn {
            None => basis.add_matrix(self.factor, self.matrix, equations),
            Some(rotation) => {
                for vector in gradient.as_chunks_mut::<D>().0 {
                    *vector = std::array::from_fn(|i| (0..D).map(|j| rotation[i][j] * vector[j]).sum());
                }
                if equations.hessian.is_some() {
                    let back: Tensor<D> = std::array::from_fn(|i| std::array::from_fn(|j| rotation[j][i]));
                    let mut turned = SymmetricMatrix::zeros(&self.dofs.pattern);
                    let blocks = vec![back; self.dofs.mesh.num_nodes()];
                    turned.add_congruent(&self.dofs.pattern, 1.0, self.matrix, &blocks);
                    basis.add_matrix(self.factor, &turned, equations);
                }
            }
        }
        basis.add_vector(-self.factor, &gradient, equations);
        energy
    }
}

impl<const D: usize> Term<D> for Penalty<'_, D> {
    fn assemble(
        &mut self,
        displacement: &[[f64; D]],
        basis: &dyn Basis<D>,
        equations: &mut NormalEquations,
        _monitor: &dyn Monitor,
    ) -> Result<TermReport, Error> {
        let energy = match &self.rest {
            Rest::Zero => self.add(basis, equations, displacement, None),
            Rest::Field(rest) => {
                let from_rest = |(u, rest): (&[f64; D], &[f64; D])| std::array::from_fn(|c| u[c] - rest[c]);
                let from_rest: Vec<[f64; D]> = displacement.iter().zip(rest).map(from_rest).collect();
                self.add(basis, equations, &from_rest, None)
            }
            Rest::MeanRotation => {
                let rotation = NodalDeformation::of(&self.dofs.mesh, displacement).mean_rotation();
                self.add(basis, equations, &self.turned_back(displacement, &rotation), Some(&rotation))
            }
        };
        Ok(TermReport { cost: self.factor * energy, ..TermReport::default() })
    }

    fn is_penalty(&self) -> bool {
        true
    }

    fn is_corotated(&self) -> bool {
        matches!(self.rest, Rest::MeanRotation)
    }
}

/// `Q^T y - x` of a rotation `Q`.
fn transposed<const D: usize>(rotation: &Tensor<D>, y: &[f64; D], x: impl Fn(usize) -> f64) -> [f64; D] {
    std::array::from_fn(|j| (0..D).map(|i| rotation[i][j] * y[i]).sum::<f64>() - x(j))
}
