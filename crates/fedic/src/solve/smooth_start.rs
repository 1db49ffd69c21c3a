//! A better start: a smooth displacement of few unknowns, fitted to a sample of the cells.
//!
//! Most of what moves in a test moves smoothly. Far from the solution every iteration reads all points to find that motion,
//! where a few hundred cells tell it as well. The mesh's own field starts from there.

use nalgebra::{DMatrix, DVector};

use crate::equations::image_term::Evaluator;
use crate::equations::parallel::for_each_cell;
use crate::interpolation::cell_prefetch::Ahead;
use crate::observation::photometry::{Correction, Moments};
use crate::projection::cell_projection::{CellView, extents, node_views};
use crate::projection::projected_points::Sight;
use crate::solve::gauss_newton::corrections;
use crate::{COMPONENTS, Error, Monitor};

/// A sample is worth reading where the mesh has this many times its cells.
const MIN_CELLS: usize = 4;
/// Corrections below this many pixels are left to the mesh's own field.
const NEAR: f64 = 0.1;
const MAX_ITERATIONS: usize = 12;
/// Added to the diagonal, relative to it: keeps what the sample hardly determines, such as powers across a narrow strip, small.
const RIDGE: f64 = 1e-3;
/// Highest powers of the coordinates.
const DEGREE: i32 = 3;

/// The field to start from: `displacement`, or one that leaves less of a residual in the sample.
pub(crate) fn align(
    evaluator: &Evaluator<'_>,
    displacement: Vec<[f64; COMPONENTS]>,
    monitor: &dyn Monitor,
) -> Result<Vec<[f64; COMPONENTS]>, Error> {
    if evaluator.system.mesh.num_cells() < MIN_CELLS * evaluator.level.sample.len() {
        return Ok(displacement);
    }
    let basis = Basis::of(evaluator);
    let mut correction = evaluator.first_correction(&displacement, monitor)?;
    let mut best = displacement.clone();
    let mut least = f64::INFINITY;
    let mut current = displacement;
    for iteration in 0..MAX_ITERATIONS {
        let views = node_views(&evaluator.system.mesh, evaluator.level.camera.as_ref(), Some(&current));
        let sample = basis.sample(evaluator, &views, correction, monitor)?;
        // NaN, where the sample has left the image, is no progress either.
        if sample.residual >= least || sample.residual.is_nan() {
            break;
        }
        best.clone_from(&current);
        (least, correction) = (sample.residual, sample.correction);
        let Some(step) = sample.step(&basis) else { break };
        let largest = corrections(&views, &step).into_iter().fold(0.0, f64::max);
        let near = largest <= NEAR;
        if near && iteration == 0 {
            break;
        }
        for (u, step) in current.iter_mut().zip(step) {
            u.iter_mut().zip(step).for_each(|(u, step)| *u += step);
        }
        if near {
            return Ok(current);
        }
    }
    Ok(best)
}

/// Monomials of the pixel coordinates of the nodes, scaled to lie between -1 and 1.
struct Basis {
    terms: usize,
    values: Vec<f64>,
}

impl Basis {
    fn of(evaluator: &Evaluator<'_>) -> Self {
        let views = node_views(&evaluator.system.mesh, evaluator.level.camera.as_ref(), None);
        let extents = extents(views.iter());
        let powers: Vec<[i32; 2]> = (0..=DEGREE).flat_map(|sum| (0..=sum).map(move |j| [sum - j, j])).collect();
        let values = views.iter().flat_map(|view| {
            let [x, y] = [0, 1].map(|c| {
                let [low, high] = extents[c];
                (2.0 * view.pixel[c] - low - high) / (high - low)
            });
            powers.iter().map(move |&[i, j]| x.powi(i) * y.powi(j))
        });
        Self { terms: powers.len(), values: values.collect() }
    }

    fn at(&self, node: usize) -> &[f64] {
        &self.values[node * self.terms..(node + 1) * self.terms]
    }

    /// Evaluates the residual in the sample, its nodes displaced, and the system of the smooth field.
    fn sample(
        &self,
        evaluator: &Evaluator<'_>,
        views: &[Sight],
        correction: Correction,
        monitor: &dyn Monitor,
    ) -> Result<Sample, Error> {
        let mesh = &evaluator.system.mesh;
        let size = self.terms * COMPONENTS;
        let (mut matrix, mut right_hand_side) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let (mut moments, mut squares) = (Moments::default(), 0.0);
        let cells = &evaluator.level.sample;
        for_each_cell(
            cells.iter().copied(),
            monitor,
            |work, index, cell| {
                let ahead = Ahead::new(evaluator.deformed, mesh, cells.get(index + 1).copied(), views);
                let view = CellView::new(mesh, cell, views, evaluator.level.camera.as_ref());
                let result = evaluator.evaluate_cell(work, cell, &view, correction, true, ahead.as_ref());
                let nodes = mesh.cell(cell).nodes;
                let dofs = nodes.len() * COMPONENTS;
                let shares = DMatrix::from_fn(dofs, size, |row, column| {
                    let same = row % COMPONENTS == column % COMPONENTS;
                    if same { self.at(nodes[row / COMPONENTS] as usize)[column / COMPONENTS] } else { 0.0 }
                });
                let hessian = result.hessian.map(|hessian| DMatrix::from_row_slice(dofs, dofs, &hessian.entries()));
                let sums = DVector::from_row_slice(&result.sums.as_flattened()[..dofs]);
                let system = hessian.map(|hessian| (shares.transpose() * hessian * &shares, shares.transpose() * sums));
                (system, result.moments, result.squares)
            },
            |_, (system, cell_moments, cell_squares)| {
                if let Some((cell_matrix, cell_sums)) = system {
                    matrix += cell_matrix;
                    right_hand_side += cell_sums;
                }
                moments.add(&cell_moments);
                squares += cell_squares;
            },
        )?;
        let residual = squares / moments.weight;
        Ok(Sample { matrix, right_hand_side, residual, correction: evaluator.correction(&moments) })
    }
}

/// What a sample tells at a displacement.
struct Sample {
    matrix: DMatrix<f64>,
    right_hand_side: DVector<f64>,
    /// Mean square of the residual.
    residual: f64,
    correction: Correction,
}

impl Sample {
    /// The step of the smooth field at each node, or `None` where the sample does not determine it.
    fn step(mut self, basis: &Basis) -> Option<Vec<[f64; COMPONENTS]>> {
        for k in 0..self.matrix.nrows() {
            self.matrix[(k, k)] *= 1.0 + RIDGE;
        }
        let factors = self.matrix.cholesky()?.solve(&self.right_hand_side);
        let nodes = basis.values.len() / basis.terms;
        let at_node = |node: usize| {
            let mut step = [0.0; COMPONENTS];
            for (term, value) in basis.at(node).iter().enumerate() {
                (0..COMPONENTS).for_each(|c| step[c] += factors[term * COMPONENTS + c] * value);
            }
            step
        };
        Some((0..nodes).map(at_node).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Arc;

    use fedic_camera::ImageFrame;
    use fedic_image::{Image, Interpolator};
    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;
    use crate::equations::unknowns::System;
    use crate::observation::level::{Level, LevelSettings};
    use crate::{Brightness, Options, Sampler};
    use fedic_synthetic::Speckle;

    const SIZE: usize = 400;
    const BOUNDS: [f64; 4] = [20.0, 20.0, 380.0, 380.0];

    /// A texture after a displacement: where a point of the image came from.
    fn image(origin: impl Fn([f64; 2]) -> [f64; 2]) -> Image {
        let speckle = Speckle::new(5.0, 0.5, 3).unwrap();
        let at = |k: usize| origin([(k % SIZE) as f64, (k / SIZE) as f64]);
        let greys = (0..SIZE * SIZE).map(|k| (35.0 + 180.0 * speckle.value(at(k))) as f32);
        Image::new(SIZE, SIZE, greys.collect()).unwrap()
    }

    /// The field that `align` finds from `start`, where the nodes are, and the mean square of the residual before and after.
    fn aligned(size: f64, deformed: &Image, start: [f64; 2]) -> (Vec<[f64; 2]>, Vec<[f64; 3]>, [f64; 2]) {
        let mesh = rectangle_mesh(BOUNDS, size, CellType::Quad).unwrap();
        let system = System::new(&mesh).unwrap();
        let options = Options::default();
        let reference = image(|x| x);
        let sampler = Sampler::new(reference.view(), options.interpolation, options.gradient, 0.0).unwrap();
        let settings = LevelSettings {
            quadrature: options.quadrature,
            size: [SIZE; 2],
            wavelength: None,
            whole_mesh: true,
            compact: false,
        };
        let level = Level::new(&system, Arc::new(ImageFrame), sampler, &settings, &()).unwrap();
        let deformed = Interpolator::new(deformed.view(), options.interpolation);
        let brightness = Brightness::Global;
        let evaluator = Evaluator { system: &system, level: &level, deformed: &deformed, brightness };
        let start = vec![start; mesh.num_nodes()];
        let found = align(&evaluator, start.clone(), &()).unwrap();
        let residuals = [&start, &found].map(|field| {
            let views = node_views(&system.mesh, &ImageFrame, Some(field));
            let correction = evaluator.first_correction(field, &()).unwrap();
            Basis::of(&evaluator).sample(&evaluator, &views, correction, &()).unwrap().residual
        });
        (found, mesh.points().to_vec(), residuals)
    }

    #[test]
    fn a_smooth_motion_is_found_to_a_fraction_of_a_pixel() {
        let moved = |[x, y]: [f64; 2]| [2.5 + 0.006 * (x - 200.0), -1.8 + 1e-5 * (x - 200.0) * (y - 200.0)];
        // Two steps of a fixed point: to 1e-4 px.
        let origin = |[x, y]: [f64; 2]| {
            let [u, v] = moved([x, y]);
            let [u, v] = moved([x - u, y - v]);
            [x - u, y - v]
        };
        let (found, points, [before, after]) = aligned(6.0, &image(origin), [0.0; 2]);
        assert!(after < 0.02 * before, "{before} {after}");
        for (found, point) in found.iter().zip(points) {
            let [u, v] = moved([point[0], point[1]]);
            let error = (found[0] - u).hypot(found[1] - v);
            assert!(error < 0.005, "{error} px at {point:?}");
        }
    }

    #[test]
    fn a_good_start_is_left_as_it_is() {
        let start = [1.2, 0.7];
        let (found, ..) = aligned(6.0, &image(|[x, y]| [x - 1.23, y - 0.66]), start);
        assert!(found.iter().all(|&u| u == start));
    }

    #[test]
    fn what_does_not_help_is_not_taken() {
        let unrelated = image(|[x, y]| [x + 5000.0, y - 3000.0]);
        let start = [0.3, -0.2];
        let (found, _, [before, after]) = aligned(6.0, &unrelated, start);
        assert!(after <= before, "{before} {after}");
        assert!(found.iter().flatten().all(|u| u.is_finite() && u.abs() < 20.0));
        // A sample would be most of such a mesh.
        let (found, ..) = aligned(20.0, &image(|[x, y]| [x - 2.0, y]), [0.0; 2]);
        assert!(found.iter().all(|&u| u == [0.0; 2]));
    }
}
