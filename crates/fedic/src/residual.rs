//! One pass over the quadrature points at a given displacement: residual, right-hand side and, if asked, Hessian.

use fedic_image::Interpolator;
use fedic_mesh::MAX_NODES;
use fedic_sparse::SymmetricMatrix;

use crate::batch::{BATCH, Batch};
use crate::brightness::{Correction, FLAT, Moments};
use crate::cell_loop::for_each_cell;
use crate::hessian::CellHessian;
use crate::level::Level;
use crate::system::System;
use crate::{Brightness, COMPONENTS, Error, Monitor};

/// The correction of brightness is known only after the pass over all points, and the right-hand side is linear in it:
/// `sum w N q (f - gain g - offset)` is put together from the sums with `f`, `g` and `1`.
const SIGNALS: usize = 3 * COMPONENTS;

/// State of the correlation at a displacement.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    /// `b = sum w N^T q r` (paper, eq. 13-16).
    pub(crate) right_hand_side: Vec<f64>,
    /// Hessian at this displacement, where asked for.
    pub(crate) hessian: Option<SymmetricMatrix>,
    /// Standard deviation of the residual over the mesh, in grey levels.
    pub(crate) residual_std: f64,
    /// Root mean square of the residual over each cell, in grey levels; NaN in a cell without points in the image.
    pub(crate) cell_residuals: Vec<f64>,
    /// Cells with points outside the deformed image.
    pub(crate) outside_cells: Vec<usize>,
    /// Correction of the deformed image over the mesh; each cell's own where brightness is matched by element.
    pub(crate) correction: Correction,
}

/// What varies between evaluations.
#[derive(Clone, Copy)]
pub(crate) struct Evaluator<'a> {
    pub(crate) system: &'a System,
    pub(crate) level: &'a Level,
    pub(crate) deformed: &'a Interpolator,
    pub(crate) brightness: Brightness,
}

impl Evaluator<'_> {
    pub(crate) fn evaluate(
        &self,
        displacement: &[[f64; COMPONENTS]],
        with_hessian: bool,
        monitor: &dyn Monitor,
    ) -> Result<Evaluation, Error> {
        let pattern = &self.system.pattern;
        let num_cells = self.system.mesh.num_cells();
        let mut sums = vec![[0.0; SIGNALS]; pattern.num_nodes()];
        let mut hessian = with_hessian.then(|| SymmetricMatrix::zeros(pattern));
        let mut cell_moments = Vec::with_capacity(num_cells);
        let mut outside_cells = Vec::new();
        for_each_cell(
            num_cells,
            monitor,
            |batch, cell| self.evaluate_cell(batch, cell, displacement, with_hessian),
            |cell, mut result| {
                if self.brightness == Brightness::Element {
                    result.correct(result.moments.correction());
                }
                for (&node, cell_sums) in pattern.cell(cell).iter().zip(&result.sums) {
                    for (sum, cell_sum) in sums[node as usize].iter_mut().zip(cell_sums) {
                        *sum += cell_sum;
                    }
                }
                if let (Some(matrix), Some(cell_hessian)) = (&mut hessian, &result.hessian) {
                    matrix.add_cell(pattern, cell, cell_hessian.entries());
                }
                cell_moments.push(result.moments);
                if result.outside {
                    outside_cells.push(cell);
                }
            },
        )?;

        let mut moments = Moments::default();
        cell_moments.iter().for_each(|cell| moments.add(cell));
        let std = moments.std_g();
        if std.is_nan() || std <= FLAT {
            return Err(Error::Flat { which: "deformed", std });
        }
        let correction = match self.brightness {
            Brightness::Global => moments.correction(),
            Brightness::None | Brightness::Element => Correction::NONE,
        };
        let cell_correction = |cell: &Moments| match self.brightness {
            Brightness::Element => cell.correction(),
            Brightness::None | Brightness::Global => correction,
        };
        let squared: Vec<f64> = cell_moments.iter().map(|cell| cell.squared_residual(cell_correction(cell))).collect();
        Ok(Evaluation {
            right_hand_side: sums.iter().flat_map(|sums| combine(sums, correction)).collect(),
            hessian,
            residual_std: (squared.iter().sum::<f64>() / moments.weight).sqrt(),
            cell_residuals: squared.iter().zip(&cell_moments).map(|(s, cell)| (s / cell.weight).sqrt()).collect(),
            outside_cells,
            correction,
        })
    }

    /// Reads the deformed image at the points `first..first + len` of a cell; the batch then holds their grey levels.
    fn read_batch(&self, batch: &mut Batch, cell: usize, first: usize, len: usize, nodes: &[[f64; 3]]) {
        batch.take(&self.level.quadrature, cell, self.system.mesh.cell(cell).cell_type, first, len);
        batch.project_with_jacobian(self.level.camera.as_ref(), nodes);
        let [u, v] = &batch.pixel;
        self.deformed.values(&u[..len], &v[..len], &mut batch.grey[..len]);
    }

    fn evaluate_cell(
        &self,
        batch: &mut Batch,
        cell: usize,
        displacement: &[[f64; COMPONENTS]],
        with_hessian: bool,
    ) -> CellResult {
        let (nodes, num_nodes) = self.system.displaced(cell, displacement);
        let points = self.level.cell_points(cell);
        let mut result = CellResult {
            sums: [[0.0; SIGNALS]; MAX_NODES],
            moments: Moments::default(),
            hessian: with_hessian.then(|| CellHessian::new(num_nodes)),
            outside: false,
        };
        let mut q = [[0.0; BATCH]; COMPONENTS];
        let mut signals = [[0.0; BATCH]; SIGNALS];
        for first in (0..points.len()).step_by(BATCH) {
            let len = BATCH.min(points.len() - first);
            self.read_batch(batch, cell, first, len, &nodes[..num_nodes]);
            for (k, point) in points[first..first + len].iter().enumerate() {
                let seen = !batch.grey[k].is_nan();
                result.outside |= !seen;
                let (g, weight) = if seen { (f64::from(batch.grey[k]), f64::from(point.weight)) } else { (0.0, 0.0) };
                let f = f64::from(point.value);
                result.moments.add_point(weight, f, g);
                for c in 0..COMPONENTS {
                    q[c][k] = if seen { batch.pull_back(c, k, point.gradient) } else { 0.0 };
                    let weighted = weight * q[c][k];
                    signals[c][k] = weighted * f;
                    signals[COMPONENTS + c][k] = weighted * g;
                    signals[2 * COMPONENTS + c][k] = weighted;
                }
            }
            batch.clear_tail(&mut signals);
            for (a, sums) in result.sums[..num_nodes].iter_mut().enumerate() {
                for (sum, part) in sums.iter_mut().zip(batch.sums(batch.shape(a), &signals)) {
                    *sum += part;
                }
            }
            if let Some(hessian) = &mut result.hessian {
                batch.clear_tail(&mut q);
                let weighted = std::array::from_fn(|c| signals[2 * COMPONENTS + c]);
                hessian.add(batch, &weighted, &q);
            }
        }
        result
    }
}

struct CellResult {
    /// Sums of `w N q f`, `w N q g`, `w N q`, by node.
    sums: [[f64; SIGNALS]; MAX_NODES],
    moments: Moments,
    hessian: Option<CellHessian>,
    outside: bool,
}

impl CellResult {
    /// Replaces the sums by those of the corrected residual, in the place of `w N q f`.
    fn correct(&mut self, correction: Correction) {
        for sums in &mut self.sums {
            let residual = combine(sums, correction);
            *sums = [0.0; SIGNALS];
            sums[..COMPONENTS].copy_from_slice(&residual);
        }
    }
}

/// `f - gain g - offset`, summed.
fn combine(sums: &[f64; SIGNALS], correction: Correction) -> [f64; COMPONENTS] {
    let Correction { gain, offset } = correction;
    std::array::from_fn(|c| sums[c] - gain * sums[COMPONENTS + c] - offset * sums[2 * COMPONENTS + c])
}
