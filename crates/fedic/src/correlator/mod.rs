//! The correlator: a reference image prepared once, and the measurement of each deformed image.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation, observation, equations, solve, results.

mod covariance;

use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use fedic_camera::Camera;
use fedic_image::{Image, ImageError, ImageView, Interpolator, downsample};
use fedic_mesh::{Mesh, map};

use self::covariance::Prepared;
use crate::equations::dofs::Dofs;
use crate::equations::terms::curvature::Curvature;
use crate::equations::terms::equilibrium_gap::Gap;
use crate::equations::terms::laplacian::Laplacian;
use crate::error::check_memory;
use crate::interpolation::image_sampler::ImageSampler;
use crate::observation::image_source::view_of;
use crate::observation::material_filter::MaterialFilter;
use crate::observation::observe::ObservationSettings;
use crate::observation::pixel_mask::PixelMask;
use crate::observation::used_points::SATURATED_SQUARE;
use crate::projection::projected_points::{pixel_displacement, project_nodes};
use crate::projection::visibility::check_visibility;
use crate::results::flags::NodeFlag;
use crate::results::residual_map::{ImagePair, residual_map};
use crate::results::solution::Iteration;
use crate::results::verdict::Judged;
use crate::solve::basis::nodal::NodalBasis;
use crate::solve::gauss_newton::{GaussNewton, residual_rms};
use crate::solve::level::{Comparison, Level, LevelSettings, Smoothing};
use crate::solve::start::pyramid::Pyramid;
use crate::solve::start::smooth_field::smooth_start;
use crate::threads::in_pool;
use crate::{
    EquilibriumGap, Error, ImageSource, Monitor, OptionError, Options, PLANE, Progress, Solution, Stage, ThreadPool,
};

/// Number of unknowns from which on the factor is kept in single precision. It would take 5 MB, which each iteration reads twice.
const COMPACT_DOFS: usize = 10_000;

/// Largest image, in pixels, whose buffer is kept for the next frame. Larger buffers are returned to the system between frames.
const MAX_KEPT_PIXELS: usize = 1 << 24;

/// Distance from a cut of the mesh, in standard deviations of the smoothing, and at the least in pixels, up to which points are left out.
const CUT_MARGIN: f64 = 2.5;
const MIN_CUT_MARGIN: f64 = 2.0;

/// Memory of each node at the least, in bytes: of the mesh, the matrix, its factor and the sums. With the points 1800 are usual.
const BYTES_PER_NODE: usize = 1024;

/// Start of the iterations.
///
/// On a mesh of many cells, `Zero` and `Field` are improved first by a field of cubic polynomials fitted to a few hundred cells, if
/// that lowers the residual there.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub enum Start<'a> {
    /// No displacement.
    #[default]
    Zero,
    /// The displacement found on reduced images, from no displacement on. Converges from further away.
    Pyramid,
    /// The displacement found on reduced images, from a displacement per node of the mesh on.
    PyramidFrom(&'a [[f64; PLANE]]),
    /// A displacement per node of the mesh, in the mesh's unit. Nodes of no cell may have any value.
    Field(&'a [[f64; PLANE]]),
}

/// A reference image sampled at the quadrature points of a mesh, ready to be correlated with any number of deformed images.
///
/// See the [crate's documentation](crate) for an example.
pub struct Correlator {
    dofs: Arc<Dofs<PLANE>>,
    reference: Arc<dyn ImageSource>,
    camera: Arc<dyn Camera>,
    options: Options,
    /// Columns and rows of the images.
    size: [usize; 2],
    /// Pixels of the reference image that are left out.
    mask: Option<Arc<PixelMask>>,
    level: Level<PLANE>,
    laplacian: OnceLock<Arc<Laplacian>>,
    pyramid: OnceLock<Pyramid<PLANE>>,
    /// The last deformed image, whose buffer the next one reuses.
    last: Mutex<Option<Interpolator>>,
    /// What the covariances are carried from.
    covariances: Prepared,
    pool: Option<ThreadPool>,
}

/// Full scale of an image and the pixels at the centre of saturated squares, if there are any.
fn saturation_of(view: ImageView<'_>) -> Option<(f32, PixelMask)> {
    let full_scale = view.full_scale_of_square(SATURATED_SQUARE)?;
    let saturated = PixelMask::new(view.width(), view.pixels_at(full_scale)).eroded(SATURATED_SQUARE / 2);
    Some((full_scale, saturated))
}

impl fmt::Debug for Correlator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Correlator")
            .field("size", &self.size)
            .field("num_points", &self.num_points())
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl Correlator {
    /// Samples `reference` at the quadrature points of `mesh` seen by `camera`, assembles the Hessian and factorises it.
    ///
    /// The correlator keeps the reference image, whose pixels must not change.
    ///
    /// # Errors
    ///
    /// [`Error`] if an option is out of its range, the camera does not see the mesh from its front, the mesh leaves the image, the
    /// image is flat, or it does not determine the displacement of every node.
    pub fn new(
        reference: Arc<dyn ImageSource>,
        mesh: &Mesh,
        camera: Arc<dyn Camera>,
        options: Options,
    ) -> Result<Self, Error> {
        Self::new_with(reference, mesh, camera, options, None, None, &())
    }

    /// Does what [`new`](Self::new) does, watched by a monitor, and leaves out the pixels where `mask` is true. It has one entry for
    /// each pixel of the reference image, row after row. Points within two standard deviations of the smoothing of a masked pixel
    /// are left out as well. With `gap` the regularization is that of the equilibrium gap, instead of the one on second derivatives.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new); [`Error::Option`] if `gap` does not fit the mesh, or no regularization length is given with it;
    /// [`Error::MaskSize`]; [`Error::NoUsablePoints`] if the mask leaves no cell;
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn new_with(
        reference: Arc<dyn ImageSource>,
        mesh: &Mesh,
        camera: Arc<dyn Camera>,
        options: Options,
        mask: Option<&[bool]>,
        gap: Option<&EquilibriumGap>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        options.check()?;
        if gap.is_some() && options.regularization_length.is_none() {
            let expected = "a positive wavelength in pixels with the equilibrium gap";
            return Err(OptionError::invalid("regularization_length", expected, &"none").into());
        }
        let pool = options.num_threads.map(|number| ThreadPool::new(Some(number)));
        let prepare = |view: ImageView<'_>| {
            check_visibility(mesh, camera.as_ref())?;
            let size = [view.width(), view.height()];
            if let Some(mask) = mask
                && mask.len() != size[0] * size[1]
            {
                return Err(Error::MaskSize { expected: size, found: mask.len() });
            }
            let of_image = size[0].saturating_mul(size[1]).saturating_mul(size_of::<f32>());
            let bytes = of_image.saturating_add(mesh.num_nodes().saturating_mul(BYTES_PER_NODE));
            check_memory("the preparation of the reference image", bytes, "use a coarser mesh or a part of the image")?;
            let reach = (2.0 * options.smoothing).ceil() as usize;
            let mask = mask.map(|mask| Arc::new(PixelMask::new(size[0], mask.to_vec()).dilated(reach)));
            // The order of the unknowns is computed serially: the image is prepared at the same time.
            let (dofs, sampler) = rayon::join(
                || match options.regularization_length {
                    Some(_) if gap.is_some() => Dofs::with_stars(mesh),
                    Some(_) => Dofs::with_patches(mesh),
                    None => Dofs::new(mesh),
                },
                || ImageSampler::new(view, options.interpolation, options.gradient, options.smoothing),
            );
            let (dofs, sampler) = (dofs?, sampler?);
            let smoothing = |length| match gap {
                Some(gap) => Gap::new(&dofs, camera.as_ref(), gap, length, monitor).map(Smoothing::Gap),
                None => Curvature::new(&dofs, camera.as_ref(), length, monitor).map(Smoothing::Curvature),
            };
            let smoothing = options.regularization_length.map(smoothing).transpose()?;
            let settings = LevelSettings {
                observation: ObservationSettings {
                    quadrature: options.quadrature,
                    size,
                    require_full_coverage: true,
                    mask: mask.clone(),
                    // Robust weights leave out what a crack opens, and no more.
                    cut_margin: options.robust.is_none().then(|| (CUT_MARGIN * options.smoothing).max(MIN_CUT_MARGIN)),
                    saturation: saturation_of(view),
                },
                // A penalty makes the system ill-conditioned whatever its pivots are.
                compact: smoothing.is_none() && dofs.pattern.num_dofs() >= COMPACT_DOFS,
                smoothing,
                filter: (options.smoothing > 0.0)
                    .then(|| MaterialFilter::new(options.smoothing, Arc::clone(&reference))),
            };
            let level = Level::new(&dofs, Arc::clone(&camera), sampler, settings, monitor)?;
            Ok::<_, Error>((dofs, level, size, mask))
        };
        let (dofs, level, size, mask) = in_pool(pool.as_ref(), || view_of(reference.as_ref(), prepare))???;
        let prepared = Progress { stage: Stage::Prepare, level: 0, iteration: 0, correction: 0.0, residual_rms: 0.0 };
        monitor.progress(&prepared);
        let (laplacian, pyramid, last) = (OnceLock::new(), OnceLock::new(), Mutex::default());
        let (dofs, covariances) = (Arc::new(dofs), Prepared::default());
        Ok(Self { dofs, reference, camera, options, size, mask, level, laplacian, pyramid, last, covariances, pool })
    }

    /// Options of this correlator.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Columns and rows of the images.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Threads of this correlator, if the options give their number; otherwise it runs on those of the caller.
    pub fn threads(&self) -> Option<&ThreadPool> {
        self.pool.as_ref()
    }

    /// Number of quadrature points.
    pub fn num_points(&self) -> usize {
        self.level.observation.num_points()
    }

    /// Image points of the nodes of the mesh in the reference image, in pixels; NaN at nodes that no cell uses.
    pub fn node_pixels(&self) -> Vec<[f64; 2]> {
        let nodes = project_nodes::<PLANE>(&self.dofs.mesh, self.camera.as_ref(), None);
        let pixels: Vec<[f64; 2]> = nodes.iter().map(|node| node.pixel).collect();
        self.dofs.extend(&pixels)
    }

    /// World points of the quadrature points, their weights and their cells, cell after cell.
    pub fn quadrature_points(&self) -> (Vec<[f64; 3]>, Vec<f64>, Vec<usize>) {
        let (mesh, observation) = (&self.dofs.mesh, &self.level.observation);
        let mut points = Vec::with_capacity(self.num_points());
        let mut cells = Vec::with_capacity(self.num_points());
        for cell in 0..mesh.num_cells() {
            let nodes = mesh.cell_points(cell);
            let count = observation.quadrature.range(cell).len();
            let (mut xi, mut eta) = (vec![0.0; count], vec![0.0; count]);
            observation.quadrature.coordinates(cell, 0, &mut xi, &mut eta);
            points.extend(xi.iter().zip(&eta).map(|(&x, &y)| map(mesh.cell(cell).cell_type, &nodes, [x, y])));
            cells.extend(std::iter::repeat_n(cell, count));
        }
        let weights = (0..mesh.num_cells()).flat_map(|cell| {
            let samples = observation.samples.cell(cell);
            (0..observation.quadrature.range(cell).len()).map(move |k| samples.weight(k))
        });
        (points, weights.collect(), cells)
    }

    /// Measures the displacement between the reference image and `deformed`.
    ///
    /// Iterations that end before they reach the tolerance are no error: see [`Solution::converged`].
    ///
    /// # Errors
    ///
    /// [`Error`] if the images differ in size, the deformed one is flat, the start does not fit the mesh or the iterations diverge.
    pub fn correlate(&self, deformed: ImageView<'_>, start: Start<'_>) -> Result<Solution, Error> {
        self.correlate_with(deformed, start, &())
    }

    /// Does what [`correlate`](Self::correlate) does, watched by a monitor.
    ///
    /// # Errors
    ///
    /// Those of [`correlate`](Self::correlate); [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn correlate_with(
        &self,
        deformed: ImageView<'_>,
        start: Start<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Solution, Error> {
        self.attempt(deformed, start, self.options.max_iterations, monitor)
    }

    /// Does what [`correlate_with`](Self::correlate_with) does with another largest number of iterations: an attempt from a start
    /// that may be wrong is given up after a few.
    ///
    /// # Errors
    ///
    /// Those of [`correlate_with`](Self::correlate_with).
    pub fn attempt(
        &self,
        deformed: ImageView<'_>,
        start: Start<'_>,
        max_iterations: usize,
        monitor: &dyn Monitor,
    ) -> Result<Solution, Error> {
        self.check_size(deformed)?;
        in_pool(self.threads(), || self.solve(deformed, start, max_iterations, monitor))?
    }

    /// Residual `f - g~`, in grey levels, at the pixels of the reference image, row after row; NaN at pixels whose centre lies
    /// outside the mesh, is masked, or leaves the deformed image. `displacement` has one entry per node of the mesh.
    ///
    /// # Errors
    ///
    /// Those of [`correlate`](Self::correlate).
    pub fn residual_map(&self, deformed: ImageView<'_>, displacement: &[[f64; PLANE]]) -> Result<Vec<f32>, Error> {
        self.residual_map_with(deformed, displacement, &())
    }

    /// Does what [`residual_map`](Self::residual_map) does, watched by a monitor.
    ///
    /// # Errors
    ///
    /// Those of [`correlate`](Self::correlate); [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn residual_map_with(
        &self,
        deformed: ImageView<'_>,
        displacement: &[[f64; PLANE]],
        monitor: &dyn Monitor,
    ) -> Result<Vec<f32>, Error> {
        self.check_size(deformed)?;
        let map = |reference: ImageView<'_>| {
            let displacement = self.dofs.restrict(displacement)?;
            let Options { interpolation, smoothing, .. } = self.options;
            let brightness = self.options.brightness_in_use();
            let interpolator = |view| Interpolator::smoothed(view, interpolation, smoothing);
            let (reference, deformed) = (interpolator(reference)?, interpolator(deformed)?);
            let observation = &self.level.observation;
            let mut term = self.level.image_term(&self.dofs, &deformed, brightness);
            term.estimate_gain_offset(&displacement, &self.level.subset, monitor)?;
            let robust = self.options.robust;
            let images = Comparison { deformed: &deformed, brightness, full_scale: None, robust };
            self.level.adapt(&mut term, &self.dofs, &displacement, &images, monitor)?;
            let basis = self.nodal_basis();
            term.evaluate(&displacement, &basis, monitor)?;
            let gain_offset = term.gain_offset();
            let light = term.adaptive().light.as_ref();
            let images = ImagePair { reference: &reference, deformed: &deformed, brightness, gain_offset, light };
            let mut residuals = residual_map(&self.dofs, observation, &images, &displacement, monitor)?;
            if let Some(mask) = &self.mask {
                mask.indices().for_each(|pixel| residuals[pixel] = f32::NAN);
            }
            Ok(residuals)
        };
        in_pool(self.threads(), || view_of(self.reference.as_ref(), map))??
    }

    fn solve(
        &self,
        deformed: ImageView<'_>,
        start: Start<'_>,
        max_iterations: usize,
        monitor: &dyn Monitor,
    ) -> Result<Solution, Error> {
        let brightness = self.options.brightness_in_use();
        let mut history = Vec::new();
        let field = match start {
            Start::Zero => vec![[0.0; PLANE]; self.dofs.mesh.num_nodes()],
            Start::Field(field) => self.dofs.restrict(field)?,
            Start::Pyramid | Start::PyramidFrom(_) => {
                let field = match start {
                    Start::PyramidFrom(field) => self.dofs.restrict(field)?,
                    _ => vec![[0.0; PLANE]; self.dofs.mesh.num_nodes()],
                };
                self.pyramid(monitor)?.start(&self.dofs, deformed, brightness, &field, &mut history, monitor)?
            }
        };
        let interpolator = self.prepare(deformed)?;
        let field = match start {
            Start::Pyramid | Start::PyramidFrom(_) => field,
            _ => smooth_start(&self.dofs, &self.level, &interpolator, brightness, field, monitor)?,
        };
        let iterations = GaussNewton {
            level: 0,
            hessian: self.options.hessian,
            tolerance: self.options.tolerance,
            max_iterations,
            max_increment: self.size[0].max(self.size[1]) as f64,
        };
        let images = Comparison {
            deformed: &interpolator,
            brightness,
            full_scale: deformed.full_scale_of_square(SATURATED_SQUARE),
            robust: self.options.robust,
        };
        let mut solution = self.level.solve(&self.dofs, &images, &iterations, (field, &[]), &mut history, monitor)?;
        if self.size[0] * self.size[1] <= MAX_KEPT_PIXELS {
            *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(interpolator);
        }
        let residual_rms = residual_rms(&solution.outcome.reports);
        // The first term is that of the image.
        let report = std::mem::take(&mut solution.outcome.reports).into_iter().next().unwrap_or_default();
        let judged = Judged {
            mesh: &self.dofs.mesh,
            level: &self.level,
            solution: &solution,
            cells: &report.cells,
            smoothing: self.options.smoothing,
            noise: self.options.noise,
            robust: self.options.robust,
        };
        let mut quality = judged.quality();
        let information = judged.information(&quality);
        let outcome = solution.outcome;
        let measured = |node: usize| quality.node_flags[node] & NodeFlag::NotMeasured.bit() == 0;
        let mut displacement = outcome.displacement.clone();
        let mut pixels = pixel_displacement(&self.dofs.mesh, self.camera.as_ref(), &displacement);
        for node in (0..displacement.len()).filter(|&node| !measured(node)) {
            displacement[node] = [f64::NAN; PLANE];
            pixels[node] = [f64::NAN; 2];
        }
        quality.node_flags = self.dofs.extend_by(&quality.node_flags, NodeFlag::NotMeasured.bit());
        quality.deviation = self.dofs.extend_by(&quality.deviation, f64::NAN);
        quality.conditioning = self.dofs.extend_by(&quality.conditioning, f64::NAN);
        let cells = || report.cells.iter().enumerate();
        Ok(Solution {
            displacement: self.dofs.extend(&displacement),
            unchecked_displacement: self.dofs.extend(&outcome.displacement),
            pixel_displacement: self.dofs.extend(&pixels),
            converged: outcome.converged,
            error_left: outcome.error_left,
            iterations: history.iter().filter(|iteration: &&Iteration| iteration.level == 0).count(),
            history,
            residual_rms,
            cell_residuals: cells().map(|(_, cell)| cell.residual).collect(),
            outside_cells: cells().filter(|(_, cell)| cell.is_partial).map(|(index, _)| index).collect(),
            num_points: self.num_points(),
            information,
            quality,
        })
    }

    fn nodal_basis(&self) -> NodalBasis<'_, PLANE> {
        let Level { factor, observation, .. } = &self.level;
        NodalBasis::new(&self.dofs, factor, &observation.quadrature)
    }

    /// Prepares a deformed image for interpolation.
    fn prepare(&self, deformed: ImageView<'_>) -> Result<Interpolator, ImageError> {
        let Options { interpolation, smoothing, .. } = self.options;
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner).take();
        match last {
            Some(last) => last.renewed(deformed, smoothing),
            None => Interpolator::smoothed(deformed, interpolation, smoothing),
        }
    }

    /// The levels of the reduced reference image, made when first needed.
    fn pyramid(&self, monitor: &dyn Monitor) -> Result<&Pyramid<PLANE>, Error> {
        if self.pyramid.get().is_none() {
            let pyramid = match view_of(self.reference.as_ref(), downsample)? {
                Ok(reduced) => self.pyramid_of(&reduced, monitor)?,
                Err(_) => Pyramid::empty(),
            };
            // Another thread may have made the same meanwhile.
            let _ = self.pyramid.set(pyramid);
        }
        Ok(self.pyramid.get_or_init(Pyramid::empty))
    }

    fn pyramid_of(&self, reduced: &Image, monitor: &dyn Monitor) -> Result<Pyramid<PLANE>, Error> {
        let laplacian =
            self.laplacian.get_or_init(|| Arc::new(Laplacian::new::<PLANE>(&self.dofs.mesh, &self.dofs.pattern)));
        Pyramid::new(&self.dofs, &self.camera, reduced, laplacian, self.mask.as_deref(), monitor)
    }

    fn check_size(&self, deformed: ImageView<'_>) -> Result<(), Error> {
        let found = [deformed.width(), deformed.height()];
        if found == self.size { Ok(()) } else { Err(Error::SizeMismatch { reference: self.size, deformed: found }) }
    }
}
