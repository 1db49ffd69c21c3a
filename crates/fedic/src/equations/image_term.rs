//! One pass over the quadrature points at a given displacement: residual, right-hand side and, if asked, Hessian.

use fedic_image::Interpolator;
use fedic_mesh::MAX_NODES;
use fedic_sparse::SymmetricMatrix;

use crate::equations::cell_matrix::CellHessian;
use crate::equations::parallel::for_each_cell;
use crate::equations::unknowns::System;
use crate::interpolation::cell_prefetch::Ahead;
use crate::kernels::simd::{Readings, add_node_sums, moments, positions, pull_back, weighted_residuals};
use crate::observation::level::Level;
use crate::observation::photometry::{Correction, FLAT, Moments, counted_from};
use crate::observation::reference_samples::CellPoints;
use crate::observation::workspace::{OwnTable, Work};
use crate::projection::cell_projection::{CellView, node_views};
use crate::projection::projected_points::Sight;
use crate::quadrature::shape_table::PART;
use crate::{Brightness, COMPONENTS, Error, Monitor};

/// State of the correlation at a displacement.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    /// `b = sum w N^T q r` (paper, eq. 13-16).
    pub(crate) right_hand_side: Vec<f64>,
    /// Hessian at this displacement, where asked for.
    pub(crate) hessian: Option<SymmetricMatrix>,
    /// Standard deviation of the residual over the mesh, in grey levels.
    pub(crate) residual_rms: f64,
    /// Root mean square of the residual over each cell, in grey levels; NaN in a cell without points in the image.
    pub(crate) cell_residuals: Vec<f64>,
    /// Cells with points outside the deformed image.
    pub(crate) outside_cells: Vec<usize>,
    /// Correction of the deformed image over the mesh, its grey levels counted from the pivot; none where each cell has its own.
    pub(crate) correction: Correction,
    /// The displaced nodes.
    pub(crate) views: Vec<Sight>,
    /// Whether a polynomial follows the camera over each cell.
    pub(crate) followed: Vec<bool>,
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
    /// Evaluates the residual. The correction of brightness over the whole mesh is known only when all points are read:
    /// `guess` serves for the reading, and the right-hand side follows what is then found to first order. `followed` is what an
    /// evaluation nearby has found, if any.
    pub(crate) fn evaluate(
        &self,
        displacement: &[[f64; COMPONENTS]],
        guess: Correction,
        followed: Option<&[bool]>,
        with_hessian: bool,
        monitor: &dyn Monitor,
    ) -> Result<Evaluation, Error> {
        let pattern = &self.system.pattern;
        let num_cells = self.system.mesh.num_cells();
        let views = node_views(&self.system.mesh, self.level.camera.as_ref(), Some(displacement));
        let mut right_hand_side = vec![0.0; pattern.num_dofs()];
        let mut hessian = with_hessian.then(|| SymmetricMatrix::zeros(pattern));
        let mut cell_residuals = Vec::with_capacity(num_cells);
        let mut followed_cells = Vec::with_capacity(num_cells);
        let mut outside_cells = Vec::new();
        let (mut moments, mut squares) = (Moments::default(), 0.0);
        for_each_cell(
            0..num_cells,
            monitor,
            |work, cell, _| {
                let ahead = Ahead::new(self.deformed, &self.system.mesh, Some(cell + 1), &views);
                let view = work.cells.view(&self.system.mesh, cell, &views, self.level.camera.as_ref(), followed);
                self.evaluate_cell(work, cell, &view, guess, with_hessian, ahead.as_ref())
            },
            |cell, result| {
                self.system.add_to_nodes(cell, &result.sums, &mut right_hand_side);
                if let (Some(matrix), Some(cell_hessian)) = (&mut hessian, &result.hessian) {
                    matrix.add_cell(pattern, cell, &cell_hessian.entries());
                }
                moments.add(&result.moments);
                squares += result.squares;
                cell_residuals.push((result.squares / result.moments.weight).sqrt());
                followed_cells.push(result.followed);
                if result.outside {
                    outside_cells.push(cell);
                }
            },
        )?;
        let std = moments.std_g();
        if std.is_nan() || std <= FLAT {
            return Err(Error::Flat { which: "deformed", std });
        }
        let correction = self.correction(&moments);
        self.follow(guess, correction, &mut right_hand_side);
        Ok(Evaluation {
            right_hand_side,
            hessian,
            residual_rms: (squares / moments.weight).sqrt(),
            cell_residuals,
            outside_cells,
            correction,
            views,
            followed: followed_cells,
        })
    }

    /// The correction over the mesh as some of its cells tell it, to begin with.
    pub(crate) fn first_correction(
        &self,
        displacement: &[[f64; COMPONENTS]],
        monitor: &dyn Monitor,
    ) -> Result<Correction, Error> {
        if self.brightness != Brightness::Global {
            return Ok(Correction::NONE);
        }
        let mesh = &self.system.mesh;
        let views = node_views(mesh, self.level.camera.as_ref(), Some(displacement));
        let mut moments = Moments::default();
        let sample = &self.level.sample;
        for_each_cell(
            sample.iter().copied(),
            monitor,
            |work, index, cell| {
                let ahead = Ahead::new(self.deformed, mesh, sample.get(index + 1).copied(), &views);
                let view = CellView::new(mesh, cell, &views, self.level.camera.as_ref());
                let points = self.level.points.cell(cell);
                self.read_cell(work, cell, &view, points, ahead.as_ref()).moments
            },
            |_, cell| moments.add(&cell),
        )?;
        Ok(self.correction(&moments))
    }

    pub(crate) fn correction(&self, moments: &Moments) -> Correction {
        match self.brightness {
            Brightness::Global => moments.correction(),
            Brightness::None | Brightness::Element => Correction::NONE,
        }
    }

    /// Brings a right-hand side from one correction to another. It is linear in the gain, by the deformed image, and the
    /// offset; the deformed image is nearly the reference image as the first correction sees it.
    fn follow(&self, from: Correction, to: Correction, right_hand_side: &mut [f64]) {
        let gain = (to.gain - from.gain) / from.gain;
        let offset = to.offset - from.offset - gain * from.offset;
        let [image, one] = &self.level.brightness;
        for ((b, image), one) in right_hand_side.iter_mut().zip(image).zip(one) {
            *b -= gain * image + offset * one;
        }
    }

    /// Reads the deformed image at the points of a cell: their grey levels are in `work.grey`. Where points lie outside, their
    /// weights, in `work.weights`, vanish. Where the cell has no expansion, `work.q` holds the gradients pulled back.
    fn read_cell(
        &self,
        work: &mut Work,
        cell: usize,
        view: &CellView<'_>,
        points: CellPoints<'_>,
        ahead: Option<&Ahead<'_>>,
    ) -> CellReading {
        let level = self.level;
        let (cell_type, count) = (self.system.mesh.cell(cell).cell_type, level.quadrature.range(cell).len());
        work.resize(count);
        let (grey, q) = (&mut work.grey, &mut work.q);
        level.points.prefetch_gradient(cell);
        if let Some(expansion) = &view.expansion {
            for first in (0..count).step_by(PART) {
                let part = first..count.min(first + PART);
                let rows = work.own_table.rows(&level.quadrature, cell, cell_type, first);
                let [u, v] = work.pixel.each_mut().map(|row| &mut row[..rows.padded()]);
                positions(rows, expansion, u, v);
                self.deformed.values_near(expansion.origin, &u[..part.len()], &v[..part.len()], &mut grey[part]);
            }
        } else {
            let camera = level.camera.as_ref();
            view.for_each_batch(&mut work.batch, &level.quadrature, cell, camera, |batch, part| {
                let [u, v] = &batch.pixel;
                self.deformed.values(&u[..part.len()], &v[..part.len()], &mut grey[part.clone()]);
                for (k, point) in part.enumerate() {
                    for (c, q) in q.iter_mut().enumerate() {
                        q[point] = batch.pull_back(c, k, points.gradient_at(point)) as f32;
                    }
                }
            });
        }
        level.points.prefetch_value(cell);
        ahead.iter().for_each(|ahead| ahead.ask_upper());
        let of_reference = level.moments[cell];
        let weight = of_reference.weight / points.scale;
        let [g, gg] = self.moments(&mut work.own_table, cell, &work.grey, points.weights, weight);
        if !g.is_nan() {
            let moments = Moments { g: points.scale * g, gg: points.scale * gg, ..of_reference };
            return CellReading { moments, outside: false };
        }
        let mut weight = 0.0;
        for k in 0..count {
            let seen = !work.grey[k].is_nan();
            work.weights[k] = if seen { points.weights.map_or(1.0, |weights| weights[k]) } else { 0.0 };
            weight += f64::from(work.weights[k]);
            if !seen {
                work.grey[k] = 0.0;
                work.q.iter_mut().for_each(|q| q[k] = 0.0);
            }
        }
        let weights = Some(&*work.weights);
        let [f, ff] = self.moments(&mut work.own_table, cell, points.value, weights, weight);
        let [g, gg] = self.moments(&mut work.own_table, cell, &work.grey, weights, weight);
        let [weight, f, ff, g, gg] = [weight, f, ff, g, gg].map(|sum| points.scale * sum);
        CellReading { moments: Moments { weight, f, ff, g, gg }, outside: true }
    }

    /// Weighted sum and sum of squares of grey levels, counted from the pivot, at the points of a cell whose weights add up to
    /// `weight`.
    fn moments(&self, own: &mut OwnTable, cell: usize, grey: &[f32], weights: Option<&[f32]>, weight: f64) -> [f64; 2] {
        let Some(&from) = grey.first() else { return [0.0; 2] };
        let mut sums = [0.0; 2];
        for first in (0..grey.len()).step_by(PART) {
            let rows = own.rows(&self.level.quadrature, cell, self.system.mesh.cell(cell).cell_type, first);
            let part = first..first + rows.padded();
            let weights = weights.map_or(rows.ones(), |weights| &weights[part.clone()]);
            let part_sums = moments(&grey[part], weights, from);
            sums.iter_mut().zip(part_sums).for_each(|(sum, part)| *sum += part);
        }
        counted_from(f64::from(self.level.pivot), sums, weight, f64::from(from))
    }

    pub(crate) fn evaluate_cell(
        &self,
        work: &mut Work,
        cell: usize,
        view: &CellView<'_>,
        correction: Correction,
        with_hessian: bool,
        ahead: Option<&Ahead<'_>>,
    ) -> CellResult {
        let (mesh, level) = (&self.system.mesh, self.level);
        let cell_type = mesh.cell(cell).cell_type;
        let points = level.points.cell(cell);
        let CellReading { moments, outside } = self.read_cell(work, cell, view, points, ahead);
        ahead.iter().for_each(|ahead| ahead.ask_lower());
        let correction = match self.brightness {
            Brightness::Element => moments.correction(),
            Brightness::None | Brightness::Global => correction,
        };
        let Correction { gain, offset } = correction.without_pivot(f64::from(level.pivot));
        let mut result = CellResult {
            sums: [[0.0; COMPONENTS]; MAX_NODES],
            squares: 0.0,
            moments,
            hessian: with_hessian.then(|| CellHessian::new(cell_type.num_nodes())),
            followed: view.expansion.is_some(),
            outside,
        };
        let Work { own_table, grey, q, weights, weighted, .. } = work;
        let weights = if outside { Some(&**weights) } else { points.weights };
        for first in (0..grey.len()).step_by(PART) {
            let rows = own_table.rows(&level.quadrature, cell, cell_type, first);
            let part = first..first + rows.padded();
            let [x, y] = q.each_mut().map(|q| &mut q[part.clone()]);
            let weights = weights.map_or(rows.ones(), |weights| &weights[part.clone()]);
            if let Some(expansion) = &view.expansion {
                let jacobian = expansion.jacobian.map(|entry| entry.map(|c| points.step * c));
                pull_back(rows, &jacobian, points.gradient.part(part.clone()), [&mut *x, &mut *y]);
            }
            let readings = Readings {
                reference: &points.value[part.clone()],
                deformed: &grey[part],
                weights,
                correction: [gain as f32, offset as f32],
            };
            let weighted = &mut weighted[..rows.padded()];
            result.squares += weighted_residuals(readings, weighted);
            add_node_sums(cell_type, rows, [&*x, &*y], weighted, &mut result.sums);
            if let Some(hessian) = &mut result.hessian {
                hessian.add(rows, [x, y], weights);
            }
        }
        result.scale(points.scale);
        result
    }
}

struct CellReading {
    moments: Moments,
    outside: bool,
}

pub(crate) struct CellResult {
    /// Sums of `w N q r`, by node.
    pub(crate) sums: [[f64; COMPONENTS]; MAX_NODES],
    /// Sum of `w r^2`.
    pub(crate) squares: f64,
    pub(crate) moments: Moments,
    pub(crate) hessian: Option<CellHessian>,
    followed: bool,
    outside: bool,
}

impl CellResult {
    /// Multiplies the sums by what multiplies the weights.
    fn scale(&mut self, scale: f64) {
        self.sums.as_flattened_mut().iter_mut().for_each(|sum| *sum *= scale);
        self.squares *= scale;
        if let Some(hessian) = &mut self.hessian {
            hessian.scale(scale);
        }
    }
}
