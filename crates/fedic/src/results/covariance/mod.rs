//! Covariance of the displacement, predicted from the noise of the images.
//!
//! An increment solves `A dU = b` with `b = sum w_k q_k r_k` and the Hessian `A`. Noise of standard deviation `sigma`, white from pixel
//! to pixel in both images, gives the residual the variance `2 sigma^2` at a pixel. Where a point stands for `p_k` pixels, `b` has the
//! covariance `2 sigma^2 B` with `B = sum (w_k^2 / p_k) h_k h_k^T`, and the displacement `2 sigma^2 A^-1 B A^-1`. With one point per
//! pixel, uniform pixel density, and neither smoothing nor penalty, that is the Cramer-Rao bound `2 sigma^2 (sum q_k q_k^T)^-1`.
//!
//! Smoothing the images smooths their noise, too. That equals unsmoothed noise with smoothed weights, and shape functions vary little
//! over the width of the filter: `h_k` is `q_k` with the gradient of an image smoothed twice.
//!
//! All of that depends on the reference image and the points used alone, and is prepared once for them. At a displacement with the
//! gradient `F` the increment is `F` times that of the reference configuration, so that the covariance is `F C F^T`. The noise of the
//! deformed image is averaged over `det F` times as many pixels: the part of `B` of each cell has the factor `(1 + 1 / det F) / 2`. Its
//! square root, from the mean `F` of the cells of a node, is a factor of that node instead. That is exact where `det F` is uniform, and
//! an approximation where it varies from cell to cell: to 0.2 % of a deviation where it varies by 1 % from one cell to the next.
//!
//! The entries of `A^-1 B A^-1` on the pattern of `A` are the derivative `-d/dt (A + t B)^-1`, from two selected inversions. Linear
//! functions of the displacement that couple other nodes take one solution each: `x = A^-1 g` has the variance `x^T B x`.

mod borders;
mod functionals;
pub(crate) mod noise_pass;
mod reference;

use std::sync::Arc;

use fedic_mesh::Mesh;
use rayon::prelude::*;

use crate::equations::deformation::{NodalDeformation, Tensor, area_ratio};
use crate::{Error, OptionError, PLANE};

pub(crate) use reference::ReferenceCovariance;

/// Covariance of the displacement of the nodes due to the noise of the images, near a displacement.
#[derive(Debug, Clone)]
pub struct Covariance {
    /// That of the reference configuration for a noise of one, which is carried to the displacement.
    reference: Arc<ReferenceCovariance>,
    /// Increment of each node at the displacement, for one of the reference configuration and a noise of one.
    factors: Vec<Tensor<PLANE>>,
    /// Mesh that strains and points refer to; `None` if it is that of the prediction.
    mesh: Option<Mesh>,
    /// Displacement of that mesh.
    displacement: Vec<[f64; PLANE]>,
}

impl Covariance {
    /// Carries the covariance of the reference configuration to a displacement of the mesh that is solved on. `noise` is the standard
    /// deviation of the noise of one image, in grey levels.
    pub(crate) fn carried(reference: Arc<ReferenceCovariance>, noise: f64, displacement: Vec<[f64; PLANE]>) -> Self {
        let deformation = NodalDeformation::of(&reference.dofs.mesh, &displacement);
        let of_node = |gradient: &Tensor<PLANE>| {
            // The residual has the noise of both images: once, and once over as many more pixels as the surface has grown.
            let both = noise * (1.0 + 1.0 / area_ratio(gradient)).sqrt();
            gradient.map(|row| row.map(|entry| both * entry))
        };
        let factors = deformation.gradients().iter().map(of_node).collect();
        Self { reference, factors, mesh: None, displacement }
    }

    /// The same covariance of the nodes, for strains and points of another configuration: those of the displacement `displacement` of
    /// `mesh`, which has the cells of this mesh on other points.
    ///
    /// A series may be measured from an intermediate image, on the mesh moved there, while its strains refer to the first mesh: these
    /// are the strains of the total displacement, with the noise of the last step alone.
    ///
    /// # Errors
    ///
    /// [`OptionError`] if the mesh has other cells; [`SolveError::InvalidStart`](crate::SolveError::InvalidStart) if the displacement
    /// does not have one finite value for each node.
    pub fn of_total(&self, mesh: &Mesh, displacement: &[[f64; PLANE]]) -> Result<Self, Error> {
        let dofs = &self.reference.dofs;
        let Some(moved) = dofs.on_points_of(mesh) else {
            let expected = "the mesh of the prediction on other points, with the same cells";
            let found = format!("a mesh of {} nodes and {} cells", mesh.num_nodes(), mesh.num_cells());
            return Err(OptionError::invalid("mesh", expected, &found).into());
        };
        Ok(Self { mesh: Some(moved), displacement: dofs.restrict(displacement)?, ..self.clone() })
    }

    /// Covariance of the displacement of each node, in the square of the mesh's unit; NaN at nodes that no point determines.
    pub fn blocks(&self) -> Vec<Tensor<PLANE>> {
        let of_node = |(node, factor): (usize, &Tensor<PLANE>)| {
            let Some([[xx, xy], [yx, yy]]) = self.reference.block(node as u32, node as u32) else {
                return [[f64::NAN; PLANE]; PLANE];
            };
            let half = factor.map(|[x, y]| [x * xx + y * yx, x * xy + y * yy]);
            half.map(|[x, y]| factor.map(|row| x * row[0] + y * row[1]))
        };
        let blocks: Vec<Tensor<PLANE>> = self.factors.par_iter().enumerate().map(of_node).collect();
        self.reference.dofs.extend_by(&blocks, [[f64::NAN; PLANE]; PLANE])
    }

    /// Standard deviation of the displacement of each node, in the mesh's unit; NaN at nodes that no point determines.
    pub fn standard_deviations(&self) -> Vec<[f64; PLANE]> {
        self.blocks().iter().map(|block| std::array::from_fn(|c| block[c][c].max(0.0).sqrt())).collect()
    }

    /// Mesh that strains and points refer to.
    fn mesh(&self) -> &Mesh {
        self.mesh.as_ref().unwrap_or(&self.reference.dofs.mesh)
    }

    /// What a weight on the displacement of a node weighs in the reference configuration.
    fn carry(&self, node: u32, weight: [f64; PLANE]) -> [f64; PLANE] {
        let [[xx, xy], [yx, yy]] = self.factors[node as usize];
        [xx * weight[0] + yx * weight[1], xy * weight[0] + yy * weight[1]]
    }
}
