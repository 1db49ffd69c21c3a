//! Covariance of the displacement in the reference configuration, prepared once for an image and the points used.

use std::sync::{Arc, OnceLock};

use fedic_image::ImageView;
use fedic_sparse::{Factor, SpdFactor, SymmetricMatrix};

use crate::equations::deformation::Tensor;
use crate::equations::dofs::Dofs;
use crate::error::check_memory;
use crate::interpolation::image_sampler::ImageSampler;
use crate::projection::projected_points::project_nodes;
use crate::results::covariance::borders::Borders;
use crate::results::covariance::noise_pass::{Matrices, NoisePass, pixels_averaged};
use crate::results::solution::Information;
use crate::solve::basis::nodal::hold_weak_nodes;
use crate::solve::level::Level;
use crate::{Error, Monitor, Options, PLANE, SolveError};

/// Step of the derivative, relative to the ratio of the mean diagonals of `A` and `B`. The error of the derivative grows with its
/// square, that of rounding falls with it.
const STEP: f64 = 2e-4;
/// Relative difference up to which `B` counts as a multiple of `A`.
const PROPORTIONAL: f64 = 1e-6;

/// Covariance of the increment of the displacement in the reference configuration, for a residual of variance one at a pixel.
#[derive(Debug)]
pub(crate) struct ReferenceCovariance {
    pub(super) dofs: Arc<Dofs<PLANE>>,
    /// `A`, the penalty of a regularization included.
    hessian: SymmetricMatrix,
    /// `B`.
    pub(super) noise: SymmetricMatrix,
    /// `A^-1 B A^-1` on the pattern of `A`.
    covariance: SymmetricMatrix,
    /// Nodes that no point determines.
    pub(super) undetermined: Vec<bool>,
    /// Factor of `A`, made when first needed.
    factor: OnceLock<Factor>,
}

impl ReferenceCovariance {
    /// Assembles and inverts the matrices. `information` is what each cell contributes; `None` if all its points do.
    ///
    /// # Errors
    ///
    /// [`Error`] if the matrices and factors do not fit in memory; [`Error::Cancelled`] if `monitor` asks to stop.
    pub(crate) fn prepare(
        dofs: &Arc<Dofs<PLANE>>,
        level: &Level<PLANE>,
        reference: ImageView<'_>,
        options: &Options,
        information: Option<&[Information]>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let [width, height] = level.observation.size;
        let images = 2 * size_of::<f32>() * width * height;
        let matrices = size_of::<f64>() * (4 * dofs.pattern.num_entries() + 2 * level.factor.num_entries());
        check_memory("the covariance of the displacement", images + matrices, "use a coarser mesh")?;
        let nodes = project_nodes::<PLANE>(&dofs.mesh, level.observation.camera.as_ref(), None);
        let pass = NoisePass {
            dofs,
            observation: &level.observation,
            image: ImageSampler::smoothed_twice(reference, options.interpolation, options.gradient, options.smoothing)?,
            pixels_averaged: pixels_averaged(options.smoothing),
            information,
            borders: Borders::new(&dofs.mesh, &nodes, options.smoothing),
        };
        let Matrices { mut hessian, noise } = pass.assemble(monitor)?;
        let has_points = |node: usize| hessian.node_diagonal(&dofs.pattern, node).any(|entry| entry > 0.0);
        let undetermined = (0..dofs.mesh.num_nodes()).map(|node| !has_points(node)).collect();
        if let Some((matrix, factor)) = level.penalty() {
            hessian.add_scaled(factor, matrix);
        }
        hold_weak_nodes(dofs, &mut hessian);
        let covariance = sandwich(dofs, &hessian, &noise, monitor)?;
        let (dofs, factor) = (Arc::clone(dofs), OnceLock::new());
        Ok(Self { dofs, hessian, noise, covariance, undetermined, factor })
    }

    /// Whether two nodes share a cell, so that their covariance is known.
    pub(super) fn share_a_cell(&self, row: u32, column: u32) -> bool {
        let block: Option<Tensor<PLANE>> = self.covariance.block(&self.dofs.pattern, row as usize, column as usize);
        block.is_some()
    }

    /// Covariance of two nodes of the mesh that is solved on, which share a cell; `None` if no point determines one of them.
    pub(super) fn block(&self, row: u32, column: u32) -> Option<Tensor<PLANE>> {
        let (row, column) = (row as usize, column as usize);
        let known = !self.undetermined[row] && !self.undetermined[column];
        known.then(|| self.covariance.block(&self.dofs.pattern, row, column).unwrap_or_default())
    }

    /// Factor of `A`.
    pub(super) fn factor(&self) -> Result<&Factor, Error> {
        if let Some(factor) = self.factor.get() {
            return Ok(factor);
        }
        let factor = self.dofs.factorize_known(&self.hessian)?;
        Ok(self.factor.get_or_init(|| factor))
    }
}

/// `A^-1 B A^-1` on the pattern of `A`.
fn sandwich(
    dofs: &Dofs<PLANE>,
    hessian: &SymmetricMatrix,
    noise: &SymmetricMatrix,
    monitor: &dyn Monitor,
) -> Result<SymmetricMatrix, Error> {
    let trace = |matrix: &SymmetricMatrix| -> f64 {
        (0..dofs.pattern.num_nodes()).flat_map(|node| matrix.node_diagonal(&dofs.pattern, node)).sum()
    };
    let ratio = trace(noise) / trace(hessian);
    let largest = hessian.values().iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    let difference = |(b, a): (&f64, &f64)| (b - ratio * a).abs();
    let inverse = |matrix: &SymmetricMatrix| -> Result<SymmetricMatrix, Error> {
        if monitor.cancelled() {
            return Err(Error::Cancelled);
        }
        let inverse = dofs.factorize_known(matrix)?.selected_inverse();
        inverse.map_err(|_| SolveError::TooLarge { dofs: dofs.pattern.num_dofs() }.into())
    };
    let mut found = SymmetricMatrix::zeros(&dofs.pattern);
    if noise.values().iter().zip(hessian.values()).map(difference).fold(0.0, f64::max) <= PROPORTIONAL * ratio * largest
    {
        found.add_scaled(ratio, &inverse(hessian)?);
        return Ok(found);
    }
    let step = STEP / ratio;
    for (sign, share) in [(1.0, -0.5 / step), (-1.0, 0.5 / step)] {
        let mut shifted = hessian.clone();
        shifted.add_scaled(sign * step, noise);
        found.add_scaled(share, &inverse(&shifted)?);
    }
    Ok(found)
}
