//! One pass over the cells that assembles the Hessian and the covariance of its right-hand side.

use std::f64::consts::PI;

use fedic_mesh::jacobian;
use fedic_sparse::SymmetricMatrix;

use crate::equations::dofs::Dofs;
use crate::interpolation::image_sampler::ImageSampler;
use crate::kernels::cell_matrix::CellMatrix;
use crate::observation::cell_context::{CellContext, exact_sensitivity, linear_sensitivity};
use crate::observation::observe::Observation;
use crate::observation::workspace::Workspace;
use crate::parallel::for_each_in_order;
use crate::projection::cell_projection::CellProjection;
use crate::projection::pointwise::BATCH;
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::results::covariance::borders::Borders;
use crate::results::solution::Information;
use crate::{Error, Monitor};

/// Number of pixels over which interpolation between them averages white noise, about: 1.2 to 1.3 for the splines.
const PIXELS_INTERPOLATED: f64 = 1.25;

/// Number of pixels over which interpolation and smoothing average white noise.
pub(crate) fn pixels_averaged(smoothing: f64) -> f64 {
    (4.0 * PI * smoothing.powi(2)).max(PIXELS_INTERPOLATED)
}

/// Input of the pass.
pub(super) struct NoisePass<'a, const D: usize> {
    pub(super) dofs: &'a Dofs<D>,
    pub(super) observation: &'a Observation<D>,
    /// The reference image smoothed twice.
    pub(super) image: ImageSampler,
    /// A point that stands for more pixels than these averages no more noise.
    pub(super) pixels_averaged: f64,
    /// What each cell contributes; `None` if all its points do.
    pub(super) information: Option<&'a [Information]>,
    pub(super) borders: Borders,
}

/// Hessian and covariance of the right-hand side.
pub(super) struct Matrices {
    /// `A = sum w q q^T`.
    pub(super) hessian: SymmetricMatrix,
    /// `B`, for a residual of variance one at a pixel.
    pub(super) noise: SymmetricMatrix,
}

impl<const D: usize> NoisePass<'_, D> {
    /// Assembles both matrices.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub(super) fn assemble(&self, monitor: &dyn Monitor) -> Result<Matrices, Error> {
        let pattern = &self.dofs.pattern;
        let zeros = || SymmetricMatrix::zeros(pattern);
        let mut matrices = Matrices { hessian: zeros(), noise: zeros() };
        let nodes = project_nodes::<D>(&self.dofs.mesh, self.observation.camera.as_ref(), None);
        for_each_in_order(
            0..self.dofs.mesh.num_cells(),
            monitor,
            |workspace: &mut Workspace<D>, cell, _| self.cell_matrices(workspace, cell, &nodes),
            |cell, [hessian, noise]| {
                matrices.hessian.add_cell(pattern, cell, &hessian.entries());
                matrices.noise.add_cell(pattern, cell, &noise.entries());
            },
        )?;
        Ok(matrices)
    }

    /// Hessian of a cell and the covariance of its right-hand side.
    fn cell_matrices(&self, workspace: &mut Workspace<D>, cell: usize, nodes: &[ProjectedPoint]) -> [CellMatrix<D>; 2] {
        let hessian = self.cell_hessian(workspace, cell, nodes);
        let noise = self.cell_covariance(workspace, cell, nodes);
        let mut both = [hessian, noise];
        if let Some(information) = self.information {
            let Information { hessian, noise, .. } = &information[cell];
            both.iter_mut().zip([*hessian, *noise]).for_each(|(matrix, factor)| matrix.scale(factor));
        }
        both
    }

    /// Robust weights of the points of a cell, if they are not one.
    fn robust_weights(&self, cell: usize) -> Option<&[f32]> {
        self.information?[cell].weights.as_deref()
    }

    fn cell_hessian(&self, workspace: &mut Workspace<D>, cell: usize, nodes: &[ProjectedPoint]) -> CellMatrix<D> {
        let (mesh, observation) = (&self.dofs.mesh, self.observation);
        let projection = CellProjection::<D>::exact(mesh.cell(cell), nodes);
        let (quadrature, camera) = (&observation.quadrature, observation.camera.as_ref());
        let cell_type = mesh.cell(cell).cell_type;
        let context = CellContext { cell, cell_type, quadrature, camera, projection };
        workspace.points.resize(context.count());
        let jacobian = observation.jacobians[cell].as_ref();
        if jacobian.is_none() {
            observation.exact_sensitivities(mesh, workspace, cell);
        }
        let samples = observation.samples.cell(cell);
        let robust = self.robust_weights(cell);
        let Workspace { projector, points: buffers, .. } = workspace;
        let mut matrix = CellMatrix::zeros(cell_type.num_nodes());
        context.for_each_chunk(&mut projector.shapes, |chunk, points| {
            if let Some(jacobian) = jacobian {
                let q = buffers.q.each_mut().map(|q| &mut q[points.clone()]);
                linear_sensitivity(chunk, jacobian, samples.step, samples.gradient.part(points.clone()), q);
            }
            let mut weights = samples.weights.map_or(chunk.ones(), |weights| &weights[points.clone()]);
            if let Some(robust) = robust {
                let own = &mut buffers.weights[points.clone()];
                own.copy_from_slice(weights);
                own.iter_mut().zip(&robust[points.start..]).for_each(|(own, weight)| *own *= weight);
                weights = own;
            }
            matrix.add(chunk, buffers.q.each_ref().map(|q| &q[points.clone()]), weights);
        });
        matrix.scale(samples.scale);
        matrix
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
        let robust = self.robust_weights(cell);
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
                let border = self.borders.factor(cell, [u[k], v[k]]);
                let robust = robust.map_or(1.0, |weights| f64::from(weights[point]));
                let own = border * (robust * samples.weight(point)).powi(2);
                weights[point] = (own / pixels.min(self.pixels_averaged)) as f32;
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
