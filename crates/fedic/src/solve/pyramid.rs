//! Coarse-to-fine start: the same mesh on reduced images, the displacement smoothed so that few pixels per cell suffice.

use std::sync::Arc;

use fedic_camera::{Camera, Scaled};
use fedic_image::{Image, ImageView, Interpolation, Interpolator, downsample};
use fedic_mesh::Rule;

use crate::equations::image_term::Evaluator;
use crate::equations::unknowns::System;
use crate::observation::level::{Level, LevelSettings};
use crate::solve::gauss_newton::Iterations;
use crate::{Brightness, COMPONENTS, Error, Gradient, Hessian, Iteration, Monitor, Quadrature, Sampler};

/// The mesh must span at least this many pixels of the coarsest image: few enough that any motion that leaves the mesh in
/// the image is of the order of one of them.
const MIN_SPAN: f64 = 6.0;
const MAX_LEVELS: usize = 12;
/// Wavelength below which the displacement is smoothed, in pixels of each level: the coarsest can only move as a whole.
const WAVELENGTH: f64 = 24.0;
/// In pixels of each level: the next one starts within its reach.
const TOLERANCE: f64 = 0.03;
const MAX_ITERATIONS: usize = 40;
const INTERPOLATION: Interpolation = Interpolation::Bspline3;

/// The reduced levels of the reference image, the first one reduced once.
pub(crate) struct Pyramid {
    levels: Vec<Level>,
}

impl Pyramid {
    /// No level: the start is zero.
    pub(crate) fn empty() -> Self {
        Self { levels: Vec::new() }
    }

    /// Builds the levels from the reference image reduced once.
    pub(crate) fn new(
        system: &System,
        camera: &Arc<dyn Camera>,
        reduced: &Image,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let mut levels: Vec<Level> = Vec::new();
        let mut coarser: Vec<Image> = Vec::new();
        for depth in 1..=num_levels(system, camera.as_ref()) {
            if depth > 1 {
                match downsample(coarser.last().unwrap_or(reduced).view()) {
                    Ok(image) => coarser.push(image),
                    Err(_) => break,
                }
            }
            let image = coarser.last().unwrap_or(reduced);
            let sampler = Sampler::new(image.view(), INTERPOLATION, Gradient::Analytic, 0.0)?;
            let settings = LevelSettings {
                quadrature: Quadrature::Mesh { rule: Rule::Edges, density: 1.0 },
                size: [image.width(), image.height()],
                wavelength: Some(WAVELENGTH),
                whole_mesh: false,
                compact: false,
            };
            let scaled: Arc<dyn Camera> = Arc::new(Scaled::new(Arc::clone(camera), 0.5_f64.powi(depth as i32)));
            match Level::new(system, scaled, sampler, &settings, monitor) {
                Ok(level) => levels.push(level),
                // A texture that reduction washes out ends the pyramid, not the correlation.
                Err(Error::Flat { .. } | Error::Solve(_)) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(Self { levels })
    }

    /// Displacement found on the reduced images, from the coarsest to the finest of them.
    pub(crate) fn start(
        &self,
        system: &System,
        deformed: ImageView<'_>,
        brightness: Brightness,
        history: &mut Vec<Iteration>,
        monitor: &dyn Monitor,
    ) -> Result<Vec<[f64; COMPONENTS]>, Error> {
        let mut images: Vec<Image> = Vec::new();
        for _ in &self.levels {
            images.push(downsample(images.last().map_or(deformed, Image::view))?);
        }
        let mut displacement = vec![[0.0; COMPONENTS]; system.mesh.num_nodes()];
        for (index, (level, image)) in self.levels.iter().zip(&images).enumerate().rev() {
            let interpolator = Interpolator::new(image.view(), INTERPOLATION);
            let evaluator = Evaluator {
                system,
                level,
                deformed: &interpolator,
                // Few points lie in a cell of a reduced image: too few for a correction of its own.
                brightness: if brightness == Brightness::None { Brightness::None } else { Brightness::Global },
            };
            let iterations = Iterations {
                level: index + 1,
                hessian: Hessian::Initial,
                tolerance: TOLERANCE,
                max_iterations: MAX_ITERATIONS,
                largest_correction: image.width().max(image.height()) as f64,
            };
            displacement = iterations.run(&evaluator, displacement, history, monitor)?.displacement;
        }
        Ok(displacement)
    }
}

/// How often the image can be halved before the mesh becomes too small in it.
fn num_levels(system: &System, camera: &dyn Camera) -> usize {
    let mut low = [f64::MAX; 2];
    let mut high = [f64::MIN; 2];
    for &point in system.mesh.points() {
        for (d, c) in camera.project(point).into_iter().enumerate() {
            low[d] = low[d].min(c);
            high[d] = high[d].max(c);
        }
    }
    let span = (high[0] - low[0]).min(high[1] - low[1]);
    ((span / MIN_SPAN).log2().floor().max(0.0) as usize).min(MAX_LEVELS)
}
