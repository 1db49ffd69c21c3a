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
//! At a displacement with the gradient `F` the increment is `F` times that of the reference configuration, so that the covariance is
//! `F C F^T`. The noise of the deformed image is averaged over `det F` times as many pixels.
//!
//! The entries of `A^-1 B A^-1` on the pattern of `A` are the derivative `-d/dt (A + t B)^-1`, from two selected inversions. Linear
//! functions of the displacement that couple other nodes take one solution each: `x = A^-1 g` has the variance `x^T B x`.

mod borders;
mod functionals;
pub(crate) mod noise_pass;

use std::sync::{Arc, OnceLock};

use fedic_image::ImageView;
use fedic_sparse::{Factor, SpdFactor, SymmetricMatrix};

use crate::equations::deformation::{NodalDeformation, Tensor};
use crate::equations::dofs::Dofs;
use crate::error::check_memory;
use crate::interpolation::image_sampler::ImageSampler;
use crate::options::{NOISE, OptionType};
use crate::projection::projected_points::project_nodes;
use crate::results::covariance::borders::Borders;
use crate::results::covariance::noise_pass::{Matrices, NoisePass, area_ratios, pixels_averaged};
use crate::results::solution::Information;
use crate::solve::basis::nodal::hold_weak_nodes;
use crate::solve::level::Level;
use crate::{Error, Monitor, Options, PLANE, SolveError};

/// Step of the derivative, relative to the ratio of the mean diagonals of `A` and `B`. The error of the derivative grows with its
/// square, that of rounding falls with it.
const STEP: f64 = 2e-4;
/// Relative difference up to which `B` counts as a multiple of `A`.
const PROPORTIONAL: f64 = 1e-6;

/// Covariance of the displacement of the nodes due to the noise of the images, near a displacement.
#[derive(Debug)]
pub struct Covariance {
    dofs: Arc<Dofs<PLANE>>,
    /// `A`, the penalty of a regularization included.
    hessian: SymmetricMatrix,
    /// `2 noise^2 B`.
    noise: SymmetricMatrix,
    /// `A^-1 (2 noise^2 B) A^-1` on the pattern of `A`, of the increment in the reference configuration.
    covariance: SymmetricMatrix,
    /// Displacement near which it was predicted.
    displacement: Vec<[f64; PLANE]>,
    /// Deformation gradient of each node.
    gradients: Vec<Tensor<PLANE>>,
    /// Nodes that no point determines.
    undetermined: Vec<bool>,
    /// Factor of `A`, made when first needed.
    factor: OnceLock<Factor>,
}

/// What a covariance is predicted for.
pub(crate) struct Prediction<'a> {
    /// Standard deviation of the noise of one image, in grey levels.
    pub(crate) noise: f64,
    pub(crate) displacement: &'a [[f64; PLANE]],
    /// What each cell contributes; `None` if all its points do.
    pub(crate) information: Option<&'a [Information]>,
}

impl Covariance {
    /// Predicts the covariance.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] if the noise is negative or not finite; [`Error`] if the matrices and factors do not fit in memory;
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub(crate) fn predict(
        dofs: &Arc<Dofs<PLANE>>,
        level: &Level<PLANE>,
        reference: ImageView<'_>,
        options: &Options,
        prediction: &Prediction<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let &Prediction { noise, displacement, information } = prediction;
        noise.check("noise", Some(NOISE))?;
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
            area_ratios: area_ratios(&dofs.mesh, displacement),
            information,
            borders: Borders::new(&dofs.mesh, &nodes, options.smoothing),
        };
        let Matrices { mut hessian, noise: gathered } = pass.assemble(monitor)?;
        let has_points = |node: usize| hessian.node_diagonal(&dofs.pattern, node).any(|entry| entry > 0.0);
        let undetermined = (0..dofs.mesh.num_nodes()).map(|node| !has_points(node)).collect();
        if let Some((matrix, factor)) = level.penalty() {
            hessian.add_scaled(factor, matrix);
        }
        hold_weak_nodes(dofs, &mut hessian);
        let mut scaled = SymmetricMatrix::zeros(&dofs.pattern);
        scaled.add_scaled(2.0 * noise * noise, &gathered);
        let covariance = if noise == 0.0 {
            SymmetricMatrix::zeros(&dofs.pattern)
        } else {
            sandwich(dofs, &hessian, &scaled, monitor)?
        };
        let gradients = NodalDeformation::of(&dofs.mesh, displacement).gradients().to_vec();
        let dofs = Arc::clone(dofs);
        let displacement = displacement.to_vec();
        let factor = OnceLock::new();
        Ok(Self { dofs, hessian, noise: scaled, covariance, displacement, gradients, undetermined, factor })
    }

    /// Covariance of the displacement of each node, in the square of the mesh's unit; NaN at nodes that no point determines.
    pub fn blocks(&self) -> Vec<Tensor<PLANE>> {
        let of_node = |node: usize| self.block(node as u32, node as u32);
        let blocks: Vec<Tensor<PLANE>> = (0..self.dofs.mesh.num_nodes()).map(of_node).collect();
        self.dofs.extend_by(&blocks, [[f64::NAN; PLANE]; PLANE])
    }

    /// Standard deviation of the displacement of each node, in the mesh's unit; NaN at nodes that no point determines.
    pub fn standard_deviations(&self) -> Vec<[f64; PLANE]> {
        self.blocks().iter().map(|block| std::array::from_fn(|c| block[c][c].max(0.0).sqrt())).collect()
    }

    /// Covariance of the displacements of two nodes of the mesh that is solved on, which share a cell.
    fn block(&self, row: u32, column: u32) -> Tensor<PLANE> {
        if self.undetermined[row as usize] || self.undetermined[column as usize] {
            return [[f64::NAN; PLANE]; PLANE];
        }
        let block: Tensor<PLANE> =
            self.covariance.block(&self.dofs.pattern, row as usize, column as usize).unwrap_or_default();
        let [left, right] = [row, column].map(|node| &self.gradients[node as usize]);
        let entry = |i: usize, j: usize| -> f64 {
            let terms = (0..PLANE).flat_map(|p| (0..PLANE).map(move |q| (p, q)));
            terms.map(|(p, q)| left[i][p] * block[p][q] * right[j][q]).sum()
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    /// Factor of `A`.
    fn factor(&self) -> Result<&Factor, Error> {
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
