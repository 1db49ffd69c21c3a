//! Standard deviation of the displacement, predicted from the noise of the images.
//!
//! A correction solves `A dU = b` with `b = sum w_k q_k r_k` and `A` the Hessian. Noise of standard deviation `sigma`, white
//! from pixel to pixel in both images, gives the residual the variance `2 sigma^2` at a pixel and, where a point stands for
//! `p_k` pixels, `b` the covariance `2 sigma^2 B` with `B = sum (w_k^2 / p_k) h_k h_k^T`. The displacement then has the
//! covariance `2 sigma^2 A^-1 B A^-1`. With one point per pixel, as many pixels per area everywhere and neither smoothing nor
//! penalty, that is the Cramer-Rao bound `2 sigma^2 (sum q_k q_k^T)^-1`.
//!
//! A smoothing smooths the noise before `b` gathers it. That is to gather the noise as recorded with smoothed weights, and
//! shape functions vary little over the width of the filter: `h_k` is `q_k` with the gradient of an image filtered twice.

use std::f64::consts::PI;

use fedic_image::ImageView;
use fedic_mesh::jacobian;
use fedic_sparse::SymmetricMatrix;
use rayon::prelude::*;

use crate::equations::cell_matrix::CellHessian;
use crate::equations::parallel::for_each_cell;
use crate::equations::unknowns::System;
use crate::observation::level::Level;
use crate::observation::workspace::Work;
use crate::projection::cell_projection::{CellView, node_views};
use crate::projection::pointwise::BATCH;
use crate::projection::projected_points::Sight;
use crate::quadrature::shape_table::PART;
use crate::{COMPONENTS, Error, Monitor, Options, Sampler, SolveError};

/// Nodes whose unknowns are solved for at once.
const NODES: usize = 16;
/// Over how many pixels the interpolation between them averages white noise, about: 1.2 to 1.3 for the splines.
const PIXELS_INTERPOLATED: f64 = 1.25;

/// Standard deviation of the displacement of each node for images whose noise has the standard deviation `noise`.
pub(crate) fn standard_deviations(
    system: &System,
    level: &Level,
    reference: ImageView<'_>,
    options: &Options,
    noise: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<[f64; COMPONENTS]>, Error> {
    if !(noise.is_finite() && noise >= 0.0) {
        return Err(Error::Solve(SolveError::InvalidOption {
            option: "noise",
            expected: "zero or a positive standard deviation in grey levels",
            value: noise.to_string(),
        }));
    }
    let gathered = GatheredNoise {
        system,
        level,
        image: Sampler::filtered_twice(reference, options.interpolation, options.gradient, options.smoothing)?,
        pixels_read: (4.0 * PI * options.smoothing.powi(2)).max(PIXELS_INTERPOLATED),
    };
    let matrix = gathered.assemble(monitor)?;
    let (num_nodes, dofs) = (system.pattern.num_nodes(), system.pattern.num_dofs());
    let blocks = (0..num_nodes).into_par_iter().step_by(NODES).map_init(
        || vec![0.0; NODES * COMPONENTS * dofs],
        |columns, first| {
            if monitor.cancelled() {
                return Err(Error::Cancelled);
            }
            let unknowns = first * COMPONENTS..num_nodes.min(first + NODES) * COMPONENTS;
            let columns = &mut columns[..unknowns.len() * dofs];
            columns.fill(0.0);
            columns.chunks_exact_mut(dofs).zip(unknowns).for_each(|(column, unknown)| column[unknown] = 1.0);
            level.factor.solve_sequentially(columns);
            let deviation = |column| {
                let variance = 2.0 * matrix.quadratic_form(&system.pattern, column);
                noise * variance.max(0.0).sqrt()
            };
            Ok(columns.chunks_exact(dofs).map(deviation).collect::<Vec<_>>())
        },
    );
    let deviations = blocks.collect::<Result<Vec<_>, Error>>()?.concat();
    Ok(deviations.as_chunks::<COMPONENTS>().0.to_vec())
}

/// The noise that the right-hand side gathers.
struct GatheredNoise<'a> {
    system: &'a System,
    level: &'a Level,
    /// The reference image through the smoothing twice.
    image: Sampler,
    /// Pixels over which a reading of the image averages the noise: a point that stands for more does not average more.
    pixels_read: f64,
}

impl GatheredNoise<'_> {
    /// `B`: the covariance of the right-hand side over the variance of the residual at a pixel.
    fn assemble(&self, monitor: &dyn Monitor) -> Result<SymmetricMatrix, Error> {
        let pattern = &self.system.pattern;
        let mut matrix = SymmetricMatrix::zeros(pattern);
        let views = node_views(&self.system.mesh, self.level.camera.as_ref(), None);
        for_each_cell(
            0..pattern.num_cells(),
            monitor,
            |work, cell, _| self.of_cell(work, cell, &views),
            |cell, gathered| matrix.add_cell(pattern, cell, &gathered.entries()),
        )?;
        Ok(matrix)
    }

    fn of_cell(&self, work: &mut Work, cell: usize, views: &[Sight]) -> CellHessian {
        let (mesh, quadrature, camera) = (&self.system.mesh, &self.level.quadrature, self.level.camera.as_ref());
        let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let points = self.level.points.cell(cell);
        let count = quadrature.range(cell).len();
        work.resize(count);
        let Work { batch, own_table, q: h, weights, .. } = work;
        let (mut value, mut along_u, mut along_v) = ([0.0; BATCH], [0.0; BATCH], [0.0; BATCH]);
        CellView::new(mesh, cell, views, camera).for_each_batch(batch, quadrature, cell, camera, |batch, part| {
            let n = part.len();
            batch.read(&self.image, &mut value[..n], [&mut along_u[..n], &mut along_v[..n]]);
            for (k, point) in part.enumerate() {
                let pixels = match quadrature.part_area(cell) {
                    Some(area) => {
                        area * batch.pixel_element(k, &jacobian(cell_type, &nodes, [batch.xi[k], batch.eta[k]]))
                    }
                    None => 1.0,
                };
                weights[point] = (points.weight(point).powi(2) / pixels.min(self.pixels_read)) as f32;
                for (c, h) in h.iter_mut().enumerate() {
                    h[point] = batch.pull_back(c, k, [along_u[k], along_v[k]]) as f32;
                }
            }
        });
        let mut gathered = CellHessian::new(nodes.len());
        for first in (0..count).step_by(PART) {
            let rows = own_table.rows(quadrature, cell, cell_type, first);
            let part = first..first + rows.padded();
            gathered.add(rows, [&h[0][part.clone()], &h[1][part.clone()]], &weights[part]);
        }
        gathered
    }
}
