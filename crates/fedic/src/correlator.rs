//! The reference image prepared once, and the correlation of each deformed image with it.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use fedic_camera::Camera;
use fedic_image::{ImageError, ImageView, Interpolator, downsample};
use fedic_mesh::{Mesh, map};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::equations::image_term::Evaluator;
use crate::equations::unknowns::System;
use crate::observation::level::{Level, LevelSettings};
use crate::projection::cell_projection::seen_displacement;
use crate::results::{covariance, residual_map};
use crate::solve::gauss_newton::Iterations;
use crate::solve::pyramid::Pyramid;
use crate::solve::smooth_start::align;
use crate::{COMPONENTS, Error, Monitor, Options, Progress, Sampler, Solution, SolveError, Stage};

/// From this number of unknowns on the factor is worth making small: it would take 5 MB, which each iteration reads twice.
const COMPACT_DOFS: usize = 10_000;

/// Largest image, in pixels, whose memory is kept for the next one. That of larger ones would be missed between the frames; it
/// comes from the system, zeros in large pages.
const KEPT_PIXELS: usize = 1 << 24;

/// Where the iterations start. `Zero` and `Field` are improved first where the mesh has many cells: by a field of cubic
/// polynomials fitted to a few hundred of them, if that lowers the residual there.
#[derive(Debug, Clone, Copy)]
pub enum Start<'a> {
    /// No displacement.
    Zero,
    /// The displacement found on reduced images: converges from further away. The image is the one that the correlator was made
    /// of.
    Pyramid(ImageView<'a>),
    /// A displacement per node of the mesh, in its unit; only nodes that a cell uses need a finite one.
    Field(&'a [[f64; COMPONENTS]]),
}

/// A reference image read at the quadrature points of a mesh, ready to be correlated with any number of deformed images.
///
/// See the [crate's documentation](crate) for an example.
pub struct Correlator {
    system: System,
    camera: Arc<dyn Camera>,
    options: Options,
    size: [usize; 2],
    level: Level,
    pyramid: OnceLock<Pyramid>,
    /// The last deformed image: the next one takes its memory.
    last: Mutex<Option<Interpolator>>,
    pool: Option<ThreadPool>,
}

impl Correlator {
    /// Reads `reference` at the quadrature points of `mesh` seen by `camera`, assembles the Hessian and factorises it.
    ///
    /// # Errors
    ///
    /// [`Error`] where an option is out of its range, the mesh leaves the image, the image is flat, or it does not
    /// determine the displacement of every node; [`Error::Cancelled`] where `monitor` asks to stop.
    pub fn new(
        reference: ImageView<'_>,
        mesh: &Mesh,
        camera: Arc<dyn Camera>,
        options: Options,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        options.check()?;
        let pool = options.num_threads.map(thread_pool).transpose()?;
        let prepare = || {
            // The order of the unknowns keeps one thread busy for a while: the others do what they can.
            let (system, sampler) = rayon::join(
                || System::new(mesh),
                || Sampler::new(reference, options.interpolation, options.gradient, options.smoothing),
            );
            let (system, sampler) = (system?, sampler?);
            let settings = LevelSettings {
                quadrature: options.quadrature,
                size: [reference.width(), reference.height()],
                wavelength: options.regularization_length,
                whole_mesh: true,
                // A penalty makes the system stiff, whatever its pivots say.
                compact: options.regularization_length.is_none() && system.pattern.num_dofs() >= COMPACT_DOFS,
            };
            let level = Level::new(&system, Arc::clone(&camera), sampler, &settings, monitor)?;
            Ok::<_, Error>((system, level))
        };
        let (system, level) = match &pool {
            Some(pool) => pool.install(prepare),
            None => prepare(),
        }?;
        let prepared = Progress { stage: Stage::Prepare, level: 0, iteration: 0, correction: 0.0, residual_rms: 0.0 };
        monitor.progress(&prepared);
        let size = [reference.width(), reference.height()];
        Ok(Self { system, camera, options, size, level, pyramid: OnceLock::new(), last: Mutex::default(), pool })
    }

    /// Number of quadrature points.
    pub fn num_points(&self) -> usize {
        self.level.num_points()
    }

    /// World points of the quadrature points, their weights and their cells, cell after cell.
    pub fn quadrature_points(&self) -> (Vec<[f64; 3]>, Vec<f64>, Vec<usize>) {
        let mesh = &self.system.mesh;
        let mut points = Vec::with_capacity(self.num_points());
        let mut cells = Vec::with_capacity(self.num_points());
        for cell in 0..mesh.num_cells() {
            let nodes = mesh.cell_points(cell);
            let count = self.level.quadrature.range(cell).len();
            let (mut xi, mut eta) = (vec![0.0; count], vec![0.0; count]);
            self.level.quadrature.coordinates(cell, 0, &mut xi, &mut eta);
            points.extend(xi.iter().zip(&eta).map(|(&x, &y)| map(mesh.cell(cell).cell_type, &nodes, [x, y])));
            cells.extend(std::iter::repeat_n(cell, count));
        }
        let weights = (0..mesh.num_cells()).flat_map(|cell| {
            let points = self.level.points.cell(cell);
            (0..self.level.quadrature.range(cell).len()).map(move |k| points.weight(k))
        });
        (points, weights.collect(), cells)
    }

    /// Measures the displacement between the reference image and `deformed`.
    ///
    /// # Errors
    ///
    /// [`Error`] where the images differ in size, the deformed one is flat, the start does not fit the mesh or the
    /// iterations diverge; [`Error::Cancelled`] where `monitor` asks to stop. Iterations that end before they reach the
    /// tolerance are no error: see [`Solution::converged`].
    pub fn correlate(
        &self,
        deformed: ImageView<'_>,
        start: Start<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Solution, Error> {
        self.check_size(deformed)?;
        self.in_pool(|| self.solve(deformed, start, monitor))
    }

    /// Residual `f - g~`, in grey levels, at the pixels of the reference image, row after row; NaN at pixels whose centre
    /// lies outside the mesh or leaves the deformed image. `reference` is the image this correlator was made of.
    ///
    /// # Errors
    ///
    /// Those of [`correlate`](Self::correlate).
    pub fn residual_map(
        &self,
        reference: ImageView<'_>,
        deformed: ImageView<'_>,
        displacement: &[[f64; COMPONENTS]],
        monitor: &dyn Monitor,
    ) -> Result<Vec<f32>, Error> {
        self.check_size(reference)?;
        self.check_size(deformed)?;
        self.in_pool(|| {
            let displacement = self.system.restrict(displacement)?;
            let interpolator = |view| Interpolator::smoothed(view, self.options.interpolation, self.options.smoothing);
            let (reference, deformed) = (interpolator(reference)?, interpolator(deformed)?);
            residual_map::residual_map(&self.evaluator(&deformed), &reference, &displacement, monitor)
        })
    }

    /// Standard deviation of the displacement of each node that the noise of the images causes, in the mesh's unit; NaN at
    /// nodes that no cell uses.
    ///
    /// `reference` is the image this correlator was made of. `noise` is the standard deviation, in grey levels, of the noise
    /// of one image as recorded, before any smoothing: white from pixel to pixel, and the same in both images.
    ///
    /// The standard deviations are the roots of the diagonal of `2 noise^2 A^-1 B A^-1`. `A` is the Hessian, the penalty of a
    /// regularization included. `B = sum (w^2 / p) h h^T` over the quadrature points, of weight `w` and standing for `p`
    /// pixels, with `h = N^T J_P^T grad f` of the reference image through the smoothing twice: `A` and the noise that the
    /// right-hand side gathers each see it. A point counts for no more pixels than a reading of the image averages: 1.25
    /// through the interpolation, `4 pi s^2` through a smoothing of standard deviation `s`.
    ///
    /// Only the scatter at convergence is predicted: neither the bias of interpolation and noise, nor that of a mesh too
    /// coarse for the field. The prediction is too large for [`Gradient::FiniteDifference`](crate::Gradient), as
    /// the sensitivity of the residual is that of the analytic gradient; too large with a smoothing as wide as a tenth of
    /// the cells, over which shape functions are taken as constant; and too small where the noise is no longer small
    /// beside the gradient of the reference image, to which it adds.
    ///
    /// The cost is one solution of the system per unknown: it grows faster than the square of the number of nodes.
    ///
    /// # Errors
    ///
    /// [`SolveError::InvalidOption`] where `noise` is negative or not finite, [`Error::SizeMismatch`] where `reference` has
    /// another size than the image this correlator was made of, [`Error::Cancelled`] where `monitor` asks to stop.
    pub fn standard_deviations(
        &self,
        reference: ImageView<'_>,
        noise: f64,
        monitor: &dyn Monitor,
    ) -> Result<Vec<[f64; COMPONENTS]>, Error> {
        self.check_size(reference)?;
        self.in_pool(|| {
            let deviations =
                covariance::standard_deviations(&self.system, &self.level, reference, &self.options, noise, monitor)?;
            Ok(self.system.extend(&deviations))
        })
    }

    fn solve(&self, deformed: ImageView<'_>, start: Start<'_>, monitor: &dyn Monitor) -> Result<Solution, Error> {
        let mut history = Vec::new();
        let first = match start {
            Start::Zero => vec![[0.0; COMPONENTS]; self.system.mesh.num_nodes()],
            Start::Field(field) => self.system.restrict(field)?,
            Start::Pyramid(reference) => {
                self.check_size(reference)?;
                self.pyramid(reference, monitor)?.start(
                    &self.system,
                    deformed,
                    self.options.brightness,
                    &mut history,
                    monitor,
                )?
            }
        };
        let interpolator = self.prepare(deformed)?;
        let iterations = Iterations {
            level: 0,
            hessian: self.options.hessian,
            tolerance: self.options.tolerance,
            max_iterations: self.options.max_iterations,
            largest_correction: self.size[0].max(self.size[1]) as f64,
        };
        let evaluator = self.evaluator(&interpolator);
        let first = match start {
            Start::Zero | Start::Field(_) => align(&evaluator, first, monitor)?,
            Start::Pyramid(_) => first,
        };
        let outcome = iterations.run(&evaluator, first, &mut history, monitor)?;
        if self.size[0] * self.size[1] <= KEPT_PIXELS {
            *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(interpolator);
        }
        let seen = seen_displacement(&self.system.mesh, self.camera.as_ref(), &outcome.displacement);
        Ok(Solution {
            displacement: self.system.extend(&outcome.displacement),
            pixel_displacement: self.system.extend(&seen),
            converged: outcome.converged,
            iterations: history.iter().filter(|iteration| iteration.level == 0).count(),
            history,
            residual_rms: outcome.evaluation.residual_rms,
            cell_residuals: outcome.evaluation.cell_residuals,
            outside_cells: outcome.evaluation.outside_cells,
            num_points: self.num_points(),
        })
    }

    /// Prepares a deformed image.
    fn prepare(&self, deformed: ImageView<'_>) -> Result<Interpolator, ImageError> {
        let Options { interpolation, smoothing, .. } = self.options;
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner).take();
        match last {
            Some(last) => last.renewed(deformed, smoothing),
            None => Interpolator::smoothed(deformed, interpolation, smoothing),
        }
    }

    fn pyramid(&self, reference: ImageView<'_>, monitor: &dyn Monitor) -> Result<&Pyramid, Error> {
        if self.pyramid.get().is_none() {
            let built = match downsample(reference) {
                Ok(reduced) => Pyramid::new(&self.system, &self.camera, &reduced, monitor)?,
                Err(_) => Pyramid::empty(),
            };
            // Another thread may have been faster; both built the same.
            let _ = self.pyramid.set(built);
        }
        Ok(self.pyramid.get_or_init(Pyramid::empty))
    }

    fn evaluator<'a>(&'a self, deformed: &'a Interpolator) -> Evaluator<'a> {
        Evaluator { system: &self.system, level: &self.level, deformed, brightness: self.options.brightness }
    }

    fn check_size(&self, deformed: ImageView<'_>) -> Result<(), Error> {
        let found = [deformed.width(), deformed.height()];
        if found == self.size { Ok(()) } else { Err(Error::SizeMismatch { reference: self.size, deformed: found }) }
    }

    fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

pub(crate) fn thread_pool(num_threads: usize) -> Result<ThreadPool, SolveError> {
    ThreadPoolBuilder::new().num_threads(num_threads).build().map_err(|_| SolveError::InvalidOption {
        option: "num_threads",
        expected: "a number of threads that this machine can start",
        value: num_threads.to_string(),
    })
}
