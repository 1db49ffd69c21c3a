//! The reference image at one resolution, read at every quadrature point: all that the iterations need of it.

use std::sync::Arc;

use fedic_camera::Camera;
use fedic_mesh::Mesh;
use fedic_sparse::{Factor, SymmetricMatrix};

use crate::equations::parallel::for_each_cell;
use crate::equations::tikhonov::penalty_factor;
use crate::equations::unknowns::System;
use crate::observation::photometry::{FLAT, Moments};
use crate::observation::reference_pass::{ReferenceReader, typical_level, weighing};
use crate::observation::reference_samples::Points;
use crate::projection::cell_projection::node_views;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::solve::cell_subset::spread_cells;
use crate::{Error, Monitor, Quadrature, Sampler, SolveError};

/// Gradients below this fraction of those of the best cells count as none.
const FLAT_GRADIENT: f64 = 1e-3;
/// A level of the pyramid; level 0 is the image as it is.
pub(crate) struct Level {
    pub(crate) camera: Arc<dyn Camera>,
    pub(crate) quadrature: CellQuadrature,
    pub(crate) points: Points,
    /// Cells that tell of the whole mesh.
    pub(crate) sample: Vec<usize>,
    /// Grey level from which moments are counted.
    pub(crate) pivot: f32,
    /// Moments of the reference image over each cell.
    pub(crate) moments: Vec<Moments>,
    /// Right-hand sides, but for a sign, of a gain and of an offset of the reference image, counted from the pivot:
    /// `sum w N^T q f` and `sum w N^T q`.
    pub(crate) brightness: [Vec<f64>; 2],
    /// Factor of the Hessian at the reference position, the penalty included.
    pub(crate) factor: Factor,
    /// Factor of the Laplacian in the system, where the displacement is smoothed.
    pub(crate) penalty: Option<f64>,
}

/// How a level is made.
pub(crate) struct LevelSettings {
    pub(crate) quadrature: Quadrature,
    /// Columns and rows of the image.
    pub(crate) size: [usize; 2],
    /// Wavelength, in pixels of this level, below which the displacement is smoothed.
    pub(crate) wavelength: Option<f64>,
    /// Whether a mesh that leaves the image is an error; its points outside are dropped otherwise.
    pub(crate) whole_mesh: bool,
    /// Whether the factor may be kept in single precision.
    pub(crate) compact: bool,
}

impl Level {
    pub(crate) fn new(
        system: &System,
        camera: Arc<dyn Camera>,
        reference: Sampler,
        settings: &LevelSettings,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let mesh = &system.mesh;
        let [width, height] = settings.size;
        let refuse = |cells| Error::MeshOutsideImage { cells, num_cells: mesh.num_cells(), width, height };
        if settings.whole_mesh {
            let cells = cells_outside(mesh, camera.as_ref(), settings.size);
            if !cells.is_empty() {
                return Err(refuse(cells));
            }
        }
        let quadrature = CellQuadrature::new(mesh, camera.as_ref(), settings.quadrature)?;
        let num_points = quadrature.num_points();
        let weighing = weighing(mesh, &quadrature, !settings.whole_mesh);
        let mut points =
            Points::zeros(&quadrature, &weighing).ok_or(SolveError::TooManyPoints { points: num_points })?;
        let views = node_views(mesh, camera.as_ref(), None);
        let reader = ReferenceReader {
            mesh,
            camera: camera.as_ref(),
            quadrature: &quadrature,
            image: &reference,
            views: &views,
            pivot: typical_level(&reference, &views),
        };
        let mut hessian = SymmetricMatrix::zeros(&system.pattern);
        let mut energies = Vec::with_capacity(mesh.num_cells());
        let mut cell_moments = Vec::with_capacity(mesh.num_cells());
        let mut moments = Moments::default();
        let mut outside = Vec::new();
        let mut brightness = [(); 2].map(|()| vec![0.0; system.pattern.num_dofs()]);
        for_each_cell(
            points.cells_mut(),
            monitor,
            |work, cell, (rows, scale)| reader.read_cell(work, cell, rows, scale),
            |cell, read| {
                hessian.add_cell(&system.pattern, cell, &read.hessian.entries());
                for (vector, sums) in brightness.iter_mut().zip(&read.brightness) {
                    system.add_to_nodes(cell, sums, vector);
                }
                energies.push((read.hessian.trace(), read.moments.weight));
                moments.add(&read.moments);
                cell_moments.push(read.moments);
                if read.outside {
                    outside.push(cell);
                }
            },
        )?;
        let pivot = reader.pivot;
        let sample = spread_cells(mesh, &views);
        // The largest of what is held: gone before the factorisation asks for memory.
        drop(reference);
        if settings.whole_mesh && !outside.is_empty() {
            return Err(refuse(outside));
        }
        let std = moments.std_f();
        if quadrature.num_points() > 0 && (std.is_nan() || std <= FLAT) {
            return Err(Error::Flat { which: "reference", std });
        }
        if settings.wavelength.is_none() {
            system.check_texture(&flat_cells(&energies), &quadrature)?;
        }
        let penalty = settings.wavelength.map(|wavelength| {
            let trace = energies.iter().map(|(trace, _)| trace).sum();
            let factor = penalty_factor(system, camera.as_ref(), trace, wavelength);
            hessian.add_scaled(factor, &system.laplacian().matrix);
            factor
        });
        let factor = system.factorize(&hessian, settings.compact, &quadrature)?;
        Ok(Self { camera, quadrature, points, sample, pivot, moments: cell_moments, brightness, factor, penalty })
    }

    /// Number of quadrature points.
    pub(crate) fn num_points(&self) -> usize {
        self.quadrature.num_points()
    }
}

/// Cells whose gradient is negligible beside that of the best: interpolation carries ripples of a texture into the flat part of
/// an image, and they determine nothing. `energies` are the trace of the Hessian and the weight of each cell.
fn flat_cells(energies: &[(f64, f64)]) -> Vec<bool> {
    let densities: Vec<f64> = energies.iter().map(|&(trace, weight)| trace / weight).collect();
    let mut sorted: Vec<f64> = densities.iter().copied().filter(|density| !density.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    // The upper tenth: much of the mesh may be flat.
    let textured = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or_default();
    densities.into_iter().map(|density| density.is_nan() || density <= FLAT_GRADIENT.powi(2) * textured).collect()
}

/// Cells with a node outside the image: looked for first, for a camera in the wrong unit would ask for more quadrature
/// points than there is memory.
fn cells_outside(mesh: &Mesh, camera: &dyn Camera, size: [usize; 2]) -> Vec<usize> {
    let inside = |&point: &[f64; 3]| {
        camera.project(point).iter().zip(size).all(|(&c, size)| c >= -0.5 && c <= size as f64 - 0.5)
    };
    let inside: Vec<bool> = mesh.points().iter().map(inside).collect();
    (0..mesh.num_cells()).filter(|&cell| mesh.cell(cell).nodes.iter().any(|&node| !inside[node as usize])).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use fedic_camera::ImageFrame;
    use fedic_image::{Image, Interpolator};
    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;
    use crate::equations::image_term::Evaluator;
    use crate::results::covariance::standard_deviations;
    use crate::solve::gauss_newton::Iterations;
    use fedic_synthetic::Speckle;

    use crate::{Brightness, COMPONENTS, Hessian, Options};

    const SIZE: usize = 240;

    fn image(shift: f64) -> Image {
        let speckle = Speckle::new(5.0, 0.5, 3).unwrap();
        let at = |k: usize| [(k % SIZE) as f64 - shift, (k / SIZE) as f64 + 0.5 * shift];
        let greys = (0..SIZE * SIZE).map(|k| (35.0 + 180.0 * speckle.value(at(k))) as f32);
        Image::new(SIZE, SIZE, greys.collect()).unwrap()
    }

    /// Displacement and standard deviations with a factor in either precision.
    fn measured(system: &System, images: &[Image; 2], compact: bool) -> [Vec<[f64; COMPONENTS]>; 2] {
        let options = Options::default();
        let sampler =
            Sampler::new(images[0].view(), options.interpolation, options.gradient, options.smoothing).unwrap();
        let settings = LevelSettings {
            quadrature: options.quadrature,
            size: [SIZE; 2],
            wavelength: None,
            whole_mesh: true,
            compact,
        };
        let level = Level::new(system, Arc::new(ImageFrame), sampler, &settings, &()).unwrap();
        assert_eq!(level.factor.is_compact(), compact);
        let deformed = Interpolator::smoothed(images[1].view(), options.interpolation, options.smoothing).unwrap();
        let evaluator = Evaluator { system, level: &level, deformed: &deformed, brightness: Brightness::Global };
        let iterations = Iterations {
            level: 0,
            hessian: Hessian::Initial,
            tolerance: options.tolerance,
            max_iterations: options.max_iterations,
            largest_correction: SIZE as f64,
        };
        let start = vec![[0.0; COMPONENTS]; system.mesh.num_nodes()];
        let outcome = iterations.run(&evaluator, start, &mut Vec::new(), &()).unwrap();
        assert!(outcome.converged);
        let deviations = standard_deviations(system, &level, images[0].view(), &options, 2.0, &()).unwrap();
        [outcome.displacement, deviations]
    }

    /// Measured on these cells: the displacement differs by up to 3.1e-6 px, the tolerance being 1e-3, and the standard
    /// deviations, which nothing iterates on, by up to 1.8e-7 of themselves.
    #[test]
    fn a_factor_in_single_precision_measures_alike() {
        let images = [image(0.0), image(0.7)];
        let meshes =
            [(CellType::Triangle, 6.0), (CellType::Quad, 6.0), (CellType::Triangle6, 14.0), (CellType::Quad9, 11.0)];
        for (cell_type, size) in meshes {
            let mesh = rectangle_mesh([20.0, 20.0, 220.0, 220.0], size, cell_type).unwrap();
            let system = System::new(&mesh).unwrap();
            let [compact, double] = [true, false].map(|compact| measured(&system, &images, compact));
            let pairs = |k: usize| compact[k].as_flattened().iter().zip(double[k].as_flattened());
            let moved = pairs(0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let spread = pairs(1).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            assert!(moved < 1e-5 && spread < 1e-6, "{cell_type:?}: {moved:e} px, {spread:e}");
            assert!(moved > 0.0 && spread > 0.0, "{cell_type:?}: the same factor");
        }
    }
}
