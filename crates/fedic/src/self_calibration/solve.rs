//! From reduced images to the covariance.

use std::f64::consts::PI;

use fedic_camera::{Camera, Parameter, Pinhole};
use fedic_image::{Image, ImageError, ImageView, Interpolation, downsample};
use fedic_mesh::Mesh;
use rayon::prelude::*;

use crate::observation::photometry::FLAT;
use crate::self_calibration::iterations::{Limits, iterate};
use crate::self_calibration::motion::{Motion, RIGID};
use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::sums::Sums;
use crate::self_calibration::view::{Frames, View};
use crate::self_calibration::{SelfCalibration, SelfCalibrationError, SelfCalibrationOptions, statistics};
use crate::{Error, Gradient, ImageSampler, Iteration, Monitor};

/// Reduced images that the iterations start on, at most, and the smallest side of one in pixels.
const LEVELS: usize = 3;
const SMALLEST_SIDE: usize = 64;
const COARSE_TOLERANCE: f64 = 0.01;
const COARSE_ITERATIONS: usize = 15;
/// How far the camera may be wrong at the start, about, as a part of the image's diagonal.
const REACH: f64 = 0.03;
/// Pixels along the border that are not read: there the interpolation knows of the image's mirror only. To these come as
/// many standard deviations of the smoothing.
const MARGIN: f64 = 5.0;
const MARGIN_DEVIATIONS: f64 = 4.0;
/// Over how many pixels the interpolation between them averages white noise, about: 1.2 to 1.3 for the splines.
const PIXELS_INTERPOLATED: f64 = 1.25;
/// A residual above this part of the texture is no match.
const LARGEST_RESIDUAL: f64 = 0.6;
/// Pixels that some node must move by.
const LEAST_MOTION: f64 = 2.0;

/// What [`calibrate_on_specimen`](super::calibrate_on_specimen) does once its input is checked.
pub(crate) fn solve(
    images: &[ImageView<'_>],
    mesh: &Mesh,
    camera: &Pinhole,
    parameters: &[Parameter],
    start: &[[f64; 2]],
    options: &SelfCalibrationOptions,
    monitor: &dyn Monitor,
) -> Result<SelfCalibration, Error> {
    let size = [images[0].width(), images[0].height()];
    let components = options.motion.components();
    let problem = Problem {
        mesh,
        parameters,
        components: if options.known_translations { &components[2..] } else { components },
        brightness: options.gain_and_offset,
        images: images.len(),
        pivot: images[0].statistics().0,
        reach: REACH * (size[0] as f64).hypot(size[1] as f64),
    };
    let count = mesh.num_nodes() as f64;
    let pivot = std::array::from_fn(|d| mesh.points().iter().map(|point| point[d]).sum::<f64>() / count);
    let mut state = State {
        camera: camera.clone(),
        motions: std::iter::once(&[0.0; 2]).chain(start).map(|&start| Motion::translation(pivot, start)).collect(),
        brightness: vec![[1.0, 0.0]; images.len()],
    };
    let mut history = Vec::new();
    start_on_reduced_images(&problem, images, camera, options.density, &mut state, &mut history, monitor)?;

    let sample = |filter: fn(ImageView<'_>, Interpolation, Gradient, f64) -> Result<ImageSampler, ImageError>| {
        let sample = |view: &ImageView<'_>| filter(*view, options.interpolation, Gradient::Analytic, options.smoothing);
        images.iter().map(sample).collect::<Result<Vec<_>, _>>()
    };
    let margin = MARGIN + MARGIN_DEVIATIONS * options.smoothing;
    let frames = Frames { samplers: sample(ImageSampler::new)?, size, factor: 1.0, margin };
    let view = View::new(&problem, frames, camera, options.density)?;
    let limits = Limits { level: 0, tolerance: options.tolerance, max_iterations: options.max_iterations };
    let (sums, sighting, converged) = iterate(&problem, &view, &mut state, &limits, &mut history, monitor)?;
    check_seen(&sums, images.len())?;
    check_match(&sums, images.len())?;
    check_motion(&problem, &state)?;
    statistics::check_determined(&problem, &sums)?;

    let averaged = (4.0 * PI * options.smoothing.powi(2)).max(PIXELS_INTERPOLATED);
    let num_points = view.num_points();
    // A filter smooths the noise before it is gathered: that is to gather it with the gradient filtered once more.
    let view = if options.smoothing > 0.0 { view.with_samplers(sample(ImageSampler::smoothed_twice)?) } else { view };
    let gathered = view.sums(&state, &sighting, |pixels| pixels * (pixels / averaged).max(1.0), monitor)?;
    let residual_rms = sums.variance().sqrt();
    let noise = options.noise.unwrap_or(residual_rms * averaged.sqrt());
    let covariance =
        statistics::covariance(&sums, &gathered, noise * noise).ok_or_else(|| SelfCalibrationError::Undetermined {
            names: parameters.iter().map(Parameter::to_string).collect(),
            advice: statistics::HOLD,
        })?;
    let sensitivities = statistics::sensitivities(&problem, &state);
    statistics::check_deviations(&problem, &covariance, &sensitivities, size)?;
    let layout = problem.layout();
    let deviations = |image: usize| {
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
        motions: state.motions[1..].iter().map(Motion::numbers).collect(),
        motion_deviations: (1..images.len()).map(deviations).collect(),
        history,
        converged,
        residual_rms,
        noise,
        num_points,
    })
}

/// Brings the state near on reduced images, the smallest first.
fn start_on_reduced_images(
    problem: &Problem<'_>,
    images: &[ImageView<'_>],
    camera: &Pinhole,
    density: f64,
    state: &mut State,
    history: &mut Vec<Iteration>,
    monitor: &dyn Monitor,
) -> Result<(), Error> {
    let mut levels: Vec<Vec<Image>> = Vec::new();
    let mut size = [images[0].width(), images[0].height()];
    while levels.len() < LEVELS && size[0].min(size[1]) >= 2 * SMALLEST_SIDE {
        let reduced: Result<Vec<Image>, _> = match levels.last() {
            Some(finer) => finer.par_iter().map(|image| downsample(image.view())).collect(),
            None => images.par_iter().map(|image| downsample(*image)).collect(),
        };
        let reduced = reduced?;
        size = [reduced[0].width(), reduced[0].height()];
        levels.push(reduced);
    }
    for (index, images) in levels.iter().enumerate().rev() {
        let level = index + 1;
        let sample = |image: &Image| ImageSampler::new(image.view(), Interpolation::Bspline3, Gradient::Analytic, 0.0);
        let samplers = images.par_iter().map(sample).collect::<Result<Vec<_>, _>>()?;
        let size = [images[0].width(), images[0].height()];
        let frames = Frames { samplers, size, factor: 0.5_f64.powi(level as i32), margin: MARGIN };
        let view = View::new(problem, frames, camera, density.min(1.0))?;
        let limits = Limits { level, tolerance: COARSE_TOLERANCE, max_iterations: COARSE_ITERATIONS };
        let (sums, ..) = iterate(problem, &view, state, &limits, history, monitor)?;
        check_seen(&sums, images.len())?;
        check_motion(problem, state)?;
        statistics::check_determined(problem, &sums)?;
    }
    Ok(())
}

/// Whether the images show something, and the same.
fn check_seen(sums: &Sums, images: usize) -> Result<(), Error> {
    if let Some(image) = (0..images).find(|&image| sums.image_variance(image).is_none()) {
        return Err(SelfCalibrationError::Unseen { image }.into());
    }
    let std = sums.texture_variance().sqrt();
    if std < FLAT { Err(Error::Flat { which: "reference", std }) } else { Ok(()) }
}

/// Whether every image shows the texture of the others.
fn check_match(sums: &Sums, images: usize) -> Result<(), Error> {
    let texture = sums.texture_variance().sqrt();
    let residuals = (0..images).map(|image| (image, sums.image_variance(image).map_or(f64::INFINITY, f64::sqrt)));
    // Of two alike the later: of a pair that is the one moved.
    match residuals.max_by(|(_, one), (_, other)| one.total_cmp(other)) {
        Some((image, residual)) if residual.is_nan() || residual > LARGEST_RESIDUAL * texture => {
            Err(SelfCalibrationError::Unmatched { image, residual, texture }.into())
        }
        _ => Ok(()),
    }
}

/// Whether the specimen has moved at all.
fn check_motion(problem: &Problem<'_>, state: &State) -> Result<(), Error> {
    let way = |motion: &Motion, &node: &[f64; 3]| {
        let [there, here] = [motion.apply(node), node].map(|place| state.camera.project(place));
        (there[0] - here[0]).hypot(there[1] - here[1])
    };
    let ways = state.motions.iter().flat_map(|motion| problem.mesh.points().iter().map(move |node| way(motion, node)));
    let largest = ways.fold(0.0, f64::max);
    if largest < LEAST_MOTION { Err(SelfCalibrationError::NoMotion { largest }.into()) } else { Ok(()) }
}
