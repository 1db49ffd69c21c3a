//! Coarse-to-fine start: the same mesh on reduced images, with the displacement smoothed so that few pixels per cell suffice.

use std::sync::Arc;

use fedic_camera::{Camera, Scaled};
use fedic_image::{Image, ImageView, Interpolation, Interpolator, downsample};
use fedic_mesh::Rule;

use crate::equations::dofs::Dofs;
use crate::equations::terms::laplacian::Laplacian;
use crate::interpolation::image_sampler::ImageSampler;
use crate::observation::observe::ObservationSettings;
use crate::observation::pixel_mask::PixelMask;
use crate::projection::projected_points::{pixel_bounds, project_nodes};
use crate::results::solution::Iteration;
use crate::solve::gauss_newton::GaussNewton;
use crate::solve::level::{Comparison, Level, LevelSettings, Smoothing};
use crate::{Brightness, Error, Gradient, Hessian, Monitor, Quadrature};

/// Smallest extent of the mesh in the coarsest image, in pixels: so few that any motion within the image is of the order of one.
const MIN_SPAN: f64 = 6.0;
const MAX_LEVELS: usize = 12;
/// Wavelength below which the displacement is smoothed, in pixels of each level. On the coarsest level the mesh moves as a whole.
const WAVELENGTH: f64 = 24.0;
/// Tolerance in pixels of each level; the next level converges from there.
const TOLERANCE: f64 = 0.03;
const MAX_ITERATIONS: usize = 40;
const INTERPOLATION: Interpolation = Interpolation::Bspline3;

/// The levels of the reduced reference image, the first of half the size.
pub(crate) struct Pyramid<const D: usize> {
    levels: Vec<Level<D>>,
}

impl<const D: usize> Pyramid<D> {
    /// No level: the start is zero.
    pub(crate) fn empty() -> Self {
        Self { levels: Vec::new() }
    }

    /// Builds the levels from the reference image reduced once.
    pub(crate) fn new(
        dofs: &Dofs<D>,
        camera: &Arc<dyn Camera>,
        reduced: &Image,
        laplacian: &Arc<Laplacian>,
        mask: Option<&PixelMask>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let mut mask = mask.map(|mask| Arc::new(mask.reduced()));
        let mut levels: Vec<Level<D>> = Vec::new();
        let mut coarser: Vec<Image> = Vec::new();
        for depth in 1..=num_levels(dofs, camera.as_ref()) {
            if depth > 1 {
                match downsample(coarser.last().unwrap_or(reduced).view()) {
                    Ok(image) => {
                        coarser.push(image);
                        mask = mask.map(|mask| Arc::new(mask.reduced()));
                    }
                    Err(_) => break,
                }
            }
            let image = coarser.last().unwrap_or(reduced);
            let sampler = ImageSampler::new(image.view(), INTERPOLATION, Gradient::Analytic, 0.0)?;
            let settings = LevelSettings {
                observation: ObservationSettings {
                    quadrature: Quadrature::Mesh { rule: Rule::Edges, density: 1.0 },
                    size: [image.width(), image.height()],
                    require_full_coverage: false,
                    mask: mask.clone(),
                    cut_margin: None,
                    saturation: None,
                },
                smoothing: Some(Smoothing::Gradient { laplacian: Arc::clone(laplacian), wavelength: WAVELENGTH }),
                filter: None,
                compact: false,
            };
            let scaled: Arc<dyn Camera> = Arc::new(Scaled::new(Arc::clone(camera), 0.5_f64.powi(depth as i32)));
            match Level::new(dofs, scaled, sampler, settings, monitor) {
                Ok(level) => levels.push(level),
                // A texture that vanishes in a reduced image ends the pyramid, not the correlation.
                Err(Error::Flat { .. } | Error::NoUsablePoints { .. } | Error::Solve(_)) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(Self { levels })
    }

    /// Displacement found on the reduced images, from the coarsest to the finest, starting from the displacement `rest`, from which the
    /// smoothness is counted.
    ///
    /// # Errors
    ///
    /// Those of [`Level::solve`].
    pub(crate) fn start(
        &self,
        dofs: &Dofs<D>,
        deformed: ImageView<'_>,
        brightness: Brightness,
        rest: &[[f64; D]],
        history: &mut Vec<Iteration>,
        monitor: &dyn Monitor,
    ) -> Result<Vec<[f64; D]>, Error> {
        let mut displacement = rest.to_vec();
        let mut images: Vec<Image> = Vec::new();
        for _ in &self.levels {
            images.push(downsample(images.last().map_or(deformed, Image::view))?);
        }
        for (index, (level, image)) in self.levels.iter().zip(&images).enumerate().rev() {
            let interpolator = Interpolator::new(image.view(), INTERPOLATION);
            // A cell of a reduced image has too few points for gain and offset of its own.
            let brightness = if brightness == Brightness::None { Brightness::None } else { Brightness::Global };
            let iterations = GaussNewton {
                level: index + 1,
                hessian: Hessian::Initial,
                tolerance: TOLERANCE,
                max_iterations: MAX_ITERATIONS,
                max_increment: image.width().max(image.height()) as f64,
            };
            let solution = level.solve(
                dofs,
                &Comparison { deformed: &interpolator, brightness, full_scale: None, robust: None },
                &iterations,
                (displacement, rest),
                history,
                monitor,
            )?;
            displacement = solution.outcome.displacement;
        }
        Ok(displacement)
    }
}

/// Number of times that the image can be halved before the mesh becomes too small in it.
fn num_levels<const D: usize>(dofs: &Dofs<D>, camera: &dyn Camera) -> usize {
    let [u, v] = pixel_bounds(project_nodes::<D>(&dofs.mesh, camera, None).iter());
    let span = (u[1] - u[0]).min(v[1] - v[0]);
    ((span / MIN_SPAN).log2().floor().max(0.0) as usize).min(MAX_LEVELS)
}
