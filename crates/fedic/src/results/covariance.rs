//! Standard deviation of the displacement, predicted from the noise of the images.
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

use std::f64::consts::PI;

use fedic_image::ImageView;
use fedic_mesh::{Mesh, jacobian};
use fedic_sparse::{Factor, SpdFactor, SymmetricMatrix};
use rayon::prelude::*;

use crate::equations::deformation::{NodalDeformation, Tensor, area_ratio, cell_gradients};
use crate::equations::dofs::Dofs;
use crate::error::check_memory;
use crate::interpolation::image_sampler::ImageSampler;
use crate::kernels::cell_matrix::CellMatrix;
use crate::observation::cell_context::{CellContext, exact_sensitivity};
use crate::observation::observe::Observation;
use crate::observation::workspace::Workspace;
use crate::options::{NOISE, OptionType};
use crate::parallel::for_each_in_order;
use crate::projection::cell_projection::CellProjection;
use crate::projection::pointwise::BATCH;
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::{Error, Monitor, Options};

/// Number of nodes whose unknowns are solved for at once.
const NODES: usize = 16;
/// Number of pixels over which interpolation between them averages white noise, about: 1.2 to 1.3 for the splines.
const PIXELS_INTERPOLATED: f64 = 1.25;

/// Number of pixels over which interpolation and smoothing average white noise.
pub(crate) fn pixels_averaged(smoothing: f64) -> f64 {
    (4.0 * PI * smoothing.powi(2)).max(PIXELS_INTERPOLATED)
}

/// Standard deviation of the displacement of each node for images whose noise has the standard deviation `noise`, at a
/// displacement.
///
/// # Errors
///
/// [`Error::Option`] if `noise` is negative or not finite; [`Error::Cancelled`] if `monitor` asks to stop.
pub(crate) fn standard_deviations<const D: usize>(
    dofs: &Dofs<D>,
    (observation, factor): (&Observation<D>, &Factor),
    reference: ImageView<'_>,
    options: &Options,
    (noise, displacement): (f64, &[[f64; D]]),
    monitor: &dyn Monitor,
) -> Result<Vec<[f64; D]>, Error> {
    noise.check("noise", Some(NOISE))?;
    let deformation = NodalDeformation::of(&dofs.mesh, displacement);
    let gradients = deformation.gradients();
    let noise_pass = NoisePass {
        dofs,
        observation,
        image: ImageSampler::smoothed_twice(reference, options.interpolation, options.gradient, options.smoothing)?,
        pixels_averaged: pixels_averaged(options.smoothing),
        area_ratios: area_ratios(&dofs.mesh, displacement),
    };
    let matrix = noise_pass.assemble(monitor)?;
    let (num_nodes, num_dofs) = (dofs.pattern.num_nodes(), dofs.pattern.num_dofs());
    let columns = rayon::current_num_threads().saturating_mul(NODES * D * num_dofs);
    check_memory(
        "the standard deviation of every node",
        columns.saturating_mul(size_of::<f64>()),
        "use fewer threads",
    )?;
    let blocks = (0..num_nodes).into_par_iter().step_by(NODES).map_init(
        || vec![0.0; NODES * D * num_dofs],
        |columns, first| {
            if monitor.cancelled() {
                return Err(Error::Cancelled);
            }
            let unknowns = first * D..num_nodes.min(first + NODES) * D;
            let columns = &mut columns[..unknowns.len() * num_dofs];
            columns.fill(0.0);
            // An increment of the displacement is that of the reference configuration, carried by the deformation gradient.
            for (column, unknown) in columns.chunks_exact_mut(num_dofs).zip(unknowns) {
                let (node, component) = (unknown / D, unknown % D);
                column[node * D..][..D].copy_from_slice(&gradients[node][component]);
            }
            factor.solve_sequentially(columns);
            let deviation = |column| {
                let variance = 2.0 * matrix.quadratic_form(&dofs.pattern, column);
                noise * variance.max(0.0).sqrt()
            };
            Ok(columns.chunks_exact(num_dofs).map(deviation).collect::<Vec<_>>())
        },
    );
    let deviations = blocks.collect::<Result<Vec<_>, Error>>()?.concat();
    Ok(deviations.as_chunks::<D>().0.to_vec())
}

/// Area of each cell at a displacement relative to that at rest; one where the cell is folded.
fn area_ratios<const D: usize>(mesh: &Mesh, displacement: &[[f64; D]]) -> Vec<f64> {
    let of_cell = |gradient: Option<Tensor<D>>| gradient.map_or(1.0, |gradient| area_ratio(&gradient));
    cell_gradients(mesh, displacement).into_iter().map(of_cell).collect()
}

/// Input of the pass that assembles the covariance of the right-hand side.
struct NoisePass<'a, const D: usize> {
    dofs: &'a Dofs<D>,
    observation: &'a Observation<D>,
    /// The reference image smoothed twice.
    image: ImageSampler,
    /// A point that stands for more pixels than these averages no more noise.
    pixels_averaged: f64,
    /// Area of each cell in the deformed image relative to that in the reference image.
    area_ratios: Vec<f64>,
}

impl<const D: usize> NoisePass<'_, D> {
    /// `B`: covariance of the right-hand side for a residual of variance one at a pixel.
    fn assemble(&self, monitor: &dyn Monitor) -> Result<SymmetricMatrix, Error> {
        let pattern = &self.dofs.pattern;
        let mut matrix = SymmetricMatrix::zeros(pattern);
        let nodes = project_nodes::<D>(&self.dofs.mesh, self.observation.camera.as_ref(), None);
        for_each_in_order(
            0..self.dofs.mesh.num_cells(),
            monitor,
            |workspace: &mut Workspace<D>, cell, _| self.cell_covariance(workspace, cell, &nodes),
            |cell, covariance| matrix.add_cell(pattern, cell, &covariance.entries()),
        )?;
        Ok(matrix)
    }

    fn cell_covariance(&self, workspace: &mut Workspace<D>, cell: usize, nodes: &[ProjectedPoint]) -> CellMatrix<D> {
        let (mesh, observation) = (&self.dofs.mesh, self.observation);
        let (cell_type, cell_points) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let (quadrature, camera) = (&observation.quadrature, observation.camera.as_ref());
        // Exact projection: the area of each point in pixels needs the Jacobian of the camera there.
        let projection = CellProjection::<D>::exact(mesh.cell(cell), nodes);
        let context = CellContext { cell, cell_type, quadrature, camera, projection };
        let samples = observation.samples.cell(cell);
        let Workspace { projector, points: buffers, .. } = workspace;
        buffers.resize(context.count());
        let (h, weights) = (&mut buffers.q, &mut buffers.weights);
        let (mut value, mut along_u, mut along_v) = ([0.0; BATCH], [0.0; BATCH], [0.0; BATCH]);
        context.for_each_exact_projection(projector, |batch, points| {
            let n = points.len();
            let [u, v] = batch.pixels();
            self.image.values_and_gradients(u, v, &mut value[..n], [&mut along_u[..n], &mut along_v[..n]]);
            for (k, point) in points.clone().enumerate() {
                let pixels = match quadrature.point_area(cell) {
                    Some(area) => {
                        area * batch.pixel_element(k, &jacobian(cell_type, &cell_points, batch.coordinates(k)))
                    }
                    None => 1.0,
                };
                // The noise of the deformed image is that of as many more pixels as the cell has grown.
                let noise = 0.5 * (1.0 + 1.0 / self.area_ratios[cell]);
                weights[point] = (noise * samples.weight(point).powi(2) / pixels.min(self.pixels_averaged)) as f32;
            }
            let first = points.start;
            exact_sensitivity(batch, points, |k| [along_u[k - first], along_v[k - first]], h);
        });
        let mut covariance = CellMatrix::zeros(cell_points.len());
        context.for_each_chunk(&mut projector.shapes, |chunk, points| {
            covariance.add(chunk, h.each_ref().map(|h| &h[points.clone()]), &weights[points]);
        });
        covariance
    }
}
