//! Stages of a specimen calibration: reduced images, images at full resolution, checks, covariance.

use fedic_camera::{Camera, Parameter};
use fedic_image::{Image, ImageError, ImageView, Interpolation, downsample};
use rayon::prelude::*;

use crate::error::self_calibration::SelfCalibrationError;
use crate::interpolation::image_sampler::ImageSampler;
use crate::observation::photometry::is_flat;
use crate::results::covariance::noise_pass::pixels_averaged;
use crate::self_calibration::image_stack::{ImageStack, LevelImages};
use crate::self_calibration::levenberg_marquardt::{Criterion, Minimum, minimize};
use crate::self_calibration::motion::{Motion, RIGID};
use crate::self_calibration::normal_equations::CalibrationEquations;
use crate::self_calibration::options::SelfCalibrationOptions;
use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::result::SelfCalibration;
use crate::self_calibration::specimen_images::SpecimenImages;
use crate::self_calibration::statistics;
use crate::{Error, Gradient, Iteration, Monitor};

/// Largest number of levels of reduced images, and the smallest side of such an image in pixels.
const MAX_LEVELS: usize = 3;
const MIN_SIDE: usize = 64;
/// Stopping criterion on the reduced images.
const COARSE_TOLERANCE: f64 = 0.01;
const COARSE_ITERATIONS: usize = 15;
/// Prior standard deviation of the projection error, relative to the diagonal of the image.
const PRIOR_DEVIATION: f64 = 0.03;
/// Width of the unused border in pixels, where the interpolation depends on the mirrored image, and the number of standard
/// deviations of the smoothing that is added to it.
const MARGIN: f64 = 5.0;
const MARGIN_DEVIATIONS: f64 = 4.0;
/// Largest residual, relative to the texture, of an image that matches the others.
const MAX_RESIDUAL: f64 = 0.6;
/// Smallest displacement in pixels that some node must have.
const MIN_MOTION: f64 = 2.0;

/// Runs all stages on checked input.
pub(crate) fn solve(
    input: &SpecimenImages<'_>,
    options: &SelfCalibrationOptions,
    monitor: &dyn Monitor,
) -> Result<SelfCalibration, Error> {
    let &SpecimenImages { images, mesh, camera, parameters, translations } = input;
    let size = [images[0].width(), images[0].height()];
    let components = options.motion.components();
    let problem = Problem {
        mesh,
        parameters,
        components: if options.known_translations { &components[2..] } else { components },
        gain_and_offset: options.gain_and_offset,
        num_images: images.len(),
        grey_origin: images[0].statistics().0,
        prior_deviation: PRIOR_DEVIATION * (size[0] as f64).hypot(size[1] as f64),
    };
    let count = mesh.num_nodes() as f64;
    let centre = std::array::from_fn(|d| mesh.points().iter().map(|point| point[d]).sum::<f64>() / count);
    let translations = std::iter::once(&[0.0; 2]).chain(translations);
    let mut state = State {
        camera: camera.clone(),
        motions: translations.map(|&translation| Motion::translation(centre, translation)).collect(),
        brightness: vec![[1.0, 0.0]; images.len()],
    };
    let mut history = Vec::new();
    solve_on_reduced_images(&problem, input, options.density, &mut state, &mut history, monitor)?;

    let samplers = |prepare: fn(ImageView<'_>, Interpolation, Gradient, f64) -> Result<ImageSampler, ImageError>| {
        let sampler =
            |view: &ImageView<'_>| prepare(*view, options.interpolation, Gradient::Analytic, options.smoothing);
        images.iter().map(sampler).collect::<Result<Vec<_>, _>>()
    };
    let margin = MARGIN + MARGIN_DEVIATIONS * options.smoothing;
    let level_images = LevelImages { samplers: samplers(ImageSampler::new)?, size, factor: 1.0, margin };
    let stack = ImageStack::new(&problem, level_images, camera, options.density)?;
    let criterion = Criterion { level: 0, tolerance: options.tolerance, max_iterations: options.max_iterations };
    let Minimum { equations, visibility, converged } =
        minimize(&problem, &stack, &mut state, &criterion, &mut history, monitor)?;
    check_texture(&equations, problem.grey_origin, images.len())?;
    check_match(&equations, images.len())?;
    check_motion(&problem, &state)?;
    statistics::check_determined(&problem, &equations)?;

    let averaged = pixels_averaged(options.smoothing);
    let num_points = stack.num_points();
    // Smoothing smooths the noise, too; see `results::covariance`.
    let stack =
        if options.smoothing > 0.0 { stack.with_samplers(samplers(ImageSampler::smoothed_twice)?) } else { stack };
    let noise_weight = |pixels: f64| pixels * (pixels / averaged).max(1.0);
    let rhs_covariance = stack.assemble(&state, &visibility, noise_weight, monitor)?;
    let residual_rms = equations.residual_variance().sqrt();
    let noise = options.noise.unwrap_or(residual_rms * averaged.sqrt());
    let covariance = statistics::covariance(&equations, &rhs_covariance, noise * noise).ok_or_else(|| {
        SelfCalibrationError::Undetermined {
            names: parameters.iter().map(Parameter::to_string).collect(),
            advice: statistics::FIX_SOME,
        }
    })?;
    let sensitivities = statistics::sensitivities(&problem, &state);
    statistics::check_deviations(&problem, &covariance, &sensitivities, size)?;
    let layout = problem.layout();
    let motion_standard_deviations = |image: usize| {
        let mut deviations = [0.0; RIGID];
        for (&component, unknown) in problem.components.iter().zip(layout.block(image)) {
            deviations[component] = covariance[(unknown, unknown)].sqrt();
        }
        deviations
    };
    let np = layout.parameters;
    Ok(SelfCalibration {
        camera: state.camera,
        covariance: (0..np * np).map(|k| covariance[(k / np, k % np)]).collect(),
        sensitivities,
        motions: state.motions[1..].iter().map(|motion| motion.to_array()).collect(),
        motion_standard_deviations: (1..images.len()).map(motion_standard_deviations).collect(),
        history,
        converged,
        residual_rms,
        noise,
        num_points,
    })
}

/// Solves on reduced images, the smallest first, starting from `state`, which becomes the solution.
fn solve_on_reduced_images(
    problem: &Problem<'_>,
    &SpecimenImages { images, camera, .. }: &SpecimenImages<'_>,
    density: f64,
    state: &mut State,
    history: &mut Vec<Iteration>,
    monitor: &dyn Monitor,
) -> Result<(), Error> {
    for (index, images) in reduced_images(images)?.iter().enumerate().rev() {
        let level = index + 1;
        let sampler = |image: &Image| ImageSampler::new(image.view(), Interpolation::Bspline3, Gradient::Analytic, 0.0);
        let level_images = LevelImages {
            samplers: images.par_iter().map(sampler).collect::<Result<Vec<_>, _>>()?,
            size: [images[0].width(), images[0].height()],
            factor: 0.5_f64.powi(level as i32),
            margin: MARGIN,
        };
        let stack = ImageStack::new(problem, level_images, camera, density.min(1.0))?;
        let criterion = Criterion { level, tolerance: COARSE_TOLERANCE, max_iterations: COARSE_ITERATIONS };
        let Minimum { equations, .. } = minimize(problem, &stack, state, &criterion, history, monitor)?;
        check_texture(&equations, problem.grey_origin, images.len())?;
        check_motion(problem, state)?;
        statistics::check_determined(problem, &equations)?;
    }
    Ok(())
}

/// Reduces all images by factors of two; level 1 comes first.
fn reduced_images(images: &[ImageView<'_>]) -> Result<Vec<Vec<Image>>, ImageError> {
    let mut levels: Vec<Vec<Image>> = Vec::new();
    let mut size = [images[0].width(), images[0].height()];
    while levels.len() < MAX_LEVELS && size[0].min(size[1]) >= 2 * MIN_SIDE {
        let reduced: Result<Vec<Image>, _> = match levels.last() {
            Some(finer) => finer.par_iter().map(|image| downsample(image.view())).collect(),
            None => images.par_iter().map(|image| downsample(*image)).collect(),
        };
        let reduced = reduced?;
        size = [reduced[0].width(), reduced[0].height()];
        levels.push(reduced);
    }
    Ok(levels)
}

/// Checks that every image shows a part of the mesh that another one shows, and that there is a texture.
fn check_texture(equations: &CalibrationEquations, grey_origin: f64, num_images: usize) -> Result<(), Error> {
    if let Some(image) = (0..num_images).find(|&image| equations.image_variance(image).is_none()) {
        return Err(SelfCalibrationError::Unseen { image }.into());
    }
    let std = equations.texture_variance().sqrt();
    if is_flat(std, grey_origin) { Err(Error::Flat { which: "reference", std }) } else { Ok(()) }
}

/// Checks that every image shows the texture of the others.
fn check_match(equations: &CalibrationEquations, num_images: usize) -> Result<(), Error> {
    let texture = equations.texture_variance().sqrt();
    let residual = |image| equations.image_variance(image).map_or(f64::INFINITY, f64::sqrt);
    let residuals = (0..num_images).map(|image| (image, residual(image)));
    // Of images with equal residuals the last one: of a pair, the moved image.
    match residuals.max_by(|(_, one), (_, other)| one.total_cmp(other)) {
        Some((image, residual)) if residual.is_nan() || residual > MAX_RESIDUAL * texture => {
            Err(SelfCalibrationError::Unmatched { image, residual, texture }.into())
        }
        _ => Ok(()),
    }
}

/// Checks that the specimen has moved.
fn check_motion(problem: &Problem<'_>, state: &State) -> Result<(), Error> {
    let displacement = |motion: &Motion, &node: &[f64; 3]| {
        let [to, from] = [motion.apply(node), node].map(|point| state.camera.project(point));
        (to[0] - from[0]).hypot(to[1] - from[1])
    };
    let nodes = problem.mesh.points();
    let displacements =
        state.motions.iter().flat_map(|motion| nodes.iter().map(move |node| displacement(motion, node)));
    let largest = displacements.fold(0.0, f64::max);
    if largest < MIN_MOTION { Err(SelfCalibrationError::NoMotion { largest }.into()) } else { Ok(()) }
}
