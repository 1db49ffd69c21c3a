//! Standard deviation of the displacement, predicted from the noise of the images.
//!
//! A correction solves `A dU = b` with `b = sum w_k q_k r_k` and `A` the Hessian. Noise of standard deviation `sigma`, white
//! from pixel to pixel in both images, gives the residual the variance `2 sigma^2` at a pixel and, where a point stands for
//! `p_k` pixels, `b` the covariance `2 sigma^2 B` with `B = sum (w_k^2 / p_k) h_k h_k^T`. The displacement then has the
//! covariance `2 sigma^2 A^-1 B A^-1`. With one point per pixel, as many pixels per area everywhere and neither prefilter nor
//! penalty, that is the Cramer-Rao bound `2 sigma^2 (sum q_k q_k^T)^-1`.
//!
//! A prefilter smooths the noise before `b` gathers it. That is to gather the noise as recorded with smoothed weights, and
//! shape functions vary little over the width of the filter: `h_k` is `q_k` with the gradient of an image filtered twice.

use std::f64::consts::PI;

use fedic_image::ImageView;
use fedic_mesh::jacobian;
use fedic_sparse::SymmetricMatrix;
use rayon::prelude::*;

use crate::batch::{BATCH, Batch};
use crate::cell_loop::for_each_cell;
use crate::hessian::CellHessian;
use crate::level::Level;
use crate::system::System;
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
        image: Sampler::filtered_twice(reference, options.interpolation, options.gradient, options.prefilter)?,
        pixels_read: (4.0 * PI * options.prefilter.powi(2)).max(PIXELS_INTERPOLATED),
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
            level.factor.solve(columns);
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
    /// The reference image through the prefilter twice.
    image: Sampler,
    /// Pixels over which a reading of the image averages the noise: a point that stands for more does not average more.
    pixels_read: f64,
}

impl GatheredNoise<'_> {
    /// `B`: the covariance of the right-hand side over the variance of the residual at a pixel.
    fn assemble(&self, monitor: &dyn Monitor) -> Result<SymmetricMatrix, Error> {
        let pattern = &self.system.pattern;
        let mut matrix = SymmetricMatrix::zeros(pattern);
        for_each_cell(
            pattern.num_cells(),
            monitor,
            |batch, cell| self.of_cell(batch, cell),
            |cell, gathered| matrix.add_cell(pattern, cell, gathered.entries()),
        )?;
        Ok(matrix)
    }

    fn of_cell(&self, batch: &mut Batch, cell: usize) -> CellHessian {
        let cell_type = self.system.mesh.cell(cell).cell_type;
        let nodes = self.system.mesh.cell_points(cell);
        let quadrature = &self.level.quadrature;
        let points = self.level.cell_points(cell);
        let mut gathered = CellHessian::new(nodes.len());
        let mut h = [[0.0; BATCH]; COMPONENTS];
        let mut weighted = [[0.0; BATCH]; COMPONENTS];
        for first in (0..points.len()).step_by(BATCH) {
            let len = BATCH.min(points.len() - first);
            batch.take(quadrature, cell, cell_type, first, len);
            batch.project_with_jacobian(self.level.camera.as_ref(), &nodes);
            batch.read(&self.image);
            for (k, point) in points[first..first + len].iter().enumerate() {
                let pixels = match quadrature.part_area(cell) {
                    Some(area) => {
                        area * batch.pixel_element(k, &jacobian(cell_type, &nodes, [batch.xi[k], batch.eta[k]]))
                    }
                    None => 1.0,
                };
                let factor = f64::from(point.weight).powi(2) / pixels.min(self.pixels_read);
                let gradient = [batch.gradient[0][k], batch.gradient[1][k]];
                for c in 0..COMPONENTS {
                    h[c][k] = batch.pull_back(c, k, gradient);
                    weighted[c][k] = factor * h[c][k];
                }
            }
            batch.clear_tail(&mut h);
            batch.clear_tail(&mut weighted);
            gathered.add(batch, &weighted, &h);
        }
        gathered
    }
}
