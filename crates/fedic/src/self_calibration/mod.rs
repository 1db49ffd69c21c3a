//! The camera from the specimen itself: its parameters as unknowns of the grey-level problem over rigid motions.
//!
//! A flat speckled specimen is seen at rest and after some rigid motions `T_j`. The camera `P_p` with the right parameters
//! `p` shows one texture on it in all images: wanted are the parameters, the motions, and a gain `a_j` and an offset `b_j`
//! of each image that minimise
//!
//! ```text
//! sum over j and the points X of the mesh of [ a_j g_j(P_p(T_j X)) + b_j - m(X) ]^2
//! ```
//!
//! where `g_0` is the reference image, `T_0` the identity, `a_0 = 1`, `b_0 = 0`, and the texture `m(X)` is the mean of the
//! images that see `X`: what minimises the sum. With one moved image that is half the squared difference `f - g`. With
//! several the images share the noise of the reference, which the differences `f - g_j` would count once each: with the
//! mean the residuals weigh every image alike, and the estimate is that of largest likelihood. A point that has left an
//! image is compared in the others.
//!
//! Gauss-Newton needs the derivative of `g_j(P_p(T_j X))` by the unknowns. With `G(X)` the gradient of the texture along
//! the specimen, the mean over the images, and `B_j = d P_p(T_j X) / dX`, it is `q_j . dP` where `q_j = B_j^-T G` is the
//! gradient as image `j` shows it and `dP` the motion of the image point: `dP_p/dp (T_j X)` for the parameters and
//! `dP_p/dX dT_j` for the motion. What is the same on the specimen in all images only moves the texture: taking the mean
//! off removes it exactly, and with it what no image can show, the place of the specimen and its scale.

mod error;
mod iterations;
mod motion;
mod statistics;
mod sums;
mod view;

use std::f64::consts::PI;

use fedic_camera::{Camera, Parameter, Pinhole};
use fedic_image::{Image, ImageView, Interpolation, downsample};
use fedic_mesh::{Mesh, Rule};
use rayon::prelude::*;

pub use error::SelfCalibrationError;
pub use motion::{MotionKind, RIGID};

use crate::brightness::FLAT;
use crate::correlator::thread_pool;
use crate::self_calibration::iterations::{Limits, iterate};
use crate::self_calibration::motion::Motion;
use crate::self_calibration::sums::Sums;
use crate::self_calibration::view::{Problem, State, View};
use crate::{Error, Gradient, Iteration, Monitor, Options, Quadrature, Sampler};

/// Reduced images that the iterations start on, at most, and the smallest side of one in pixels.
const LEVELS: usize = 3;
const SMALLEST_SIDE: usize = 64;
const COARSE_TOLERANCE: f64 = 0.01;
const COARSE_ITERATIONS: usize = 15;
/// How far the camera may be wrong at the start, about, as a part of the image's diagonal.
const REACH: f64 = 0.01;
/// Pixels along the border that are not read: there the interpolation knows of the image's mirror only. To these come as
/// many standard deviations of the prefilter.
const MARGIN: f64 = 5.0;
const MARGIN_DEVIATIONS: f64 = 4.0;
/// Over how many pixels the interpolation between them averages white noise, about: 1.2 to 1.3 for the splines.
const PIXELS_INTERPOLATED: f64 = 1.25;
/// A residual above this part of the texture is no match.
const LARGEST_RESIDUAL: f64 = 0.6;
/// Pixels that some node must move by.
const LEAST_MOTION: f64 = 2.0;

/// Options of [`calibrate_on_specimen`].
#[derive(Debug, Clone, PartialEq)]
pub struct SelfCalibrationOptions {
    /// Which motions the specimen may have made.
    pub motion: MotionKind,
    /// Whether the translations given as the start are true: they are then held, and give the scale.
    pub known_translations: bool,
    /// Quadrature points per pixel of the reference image.
    pub density: f64,
    /// Interpolation of the images.
    pub interpolation: Interpolation,
    /// Standard deviation, in pixels, of a Gaussian filter applied to the images first; 0 for none.
    pub prefilter: f64,
    /// Whether gain and offset of each image are unknown too.
    pub brightness: bool,
    /// Standard deviation of the noise of one image as recorded, in grey levels; from the residual where it is `None`.
    pub noise: Option<f64>,
    /// The iteration stops when the root mean square of what a correction moves in the images is below this, in pixels.
    pub tolerance: f64,
    /// Most iterations on the images at full resolution.
    pub max_iterations: usize,
    /// Threads to use; `None` uses the rayon pool of the caller. The result does not depend on it.
    pub num_threads: Option<usize>,
}

impl Default for SelfCalibrationOptions {
    fn default() -> Self {
        Self {
            motion: MotionKind::default(),
            known_translations: false,
            density: 1.0,
            interpolation: Interpolation::Bspline5,
            prefilter: 0.8,
            brightness: true,
            noise: None,
            tolerance: 1e-5,
            max_iterations: 50,
            num_threads: None,
        }
    }
}

/// A camera found on the specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfCalibration {
    /// The camera.
    pub camera: Pinhole,
    /// Covariance of the parameters, row after row.
    pub covariance: Vec<f64>,
    /// For each parameter the largest way in pixels that one unit of it moves a node in an image.
    pub sensitivities: Vec<f64>,
    /// Rigid motion of each moved image: translation in the mesh's unit, and rotation vector about the mesh's middle.
    pub motions: Vec<[f64; RIGID]>,
    /// Standard deviations of these; 0 for what was held.
    pub motion_deviations: Vec<[f64; RIGID]>,
    /// Every iteration, coarsest level first.
    pub history: Vec<Iteration>,
    /// Whether the last correction was within the tolerance.
    pub converged: bool,
    /// Standard deviation of the grey levels of one image about the texture, as filtered, in grey levels.
    pub residual_std: f64,
    /// Standard deviation of the noise of one image as recorded that the covariance stands on, in grey levels.
    pub noise: f64,
    /// Number of quadrature points.
    pub num_points: usize,
}

/// Finds `parameters` of a camera from `images` of a specimen in the plane of `mesh`: first the reference image, then
/// those of the specimen moved, whose translations along `X` and `Y` are about `start`. `camera` gives the first values,
/// and those of all other parameters.
///
/// # Errors
///
/// [`Error`] where an input or option can't be used, the images don't match, or they do not determine a parameter;
/// [`Error::Cancelled`] where `monitor` asks to stop. Iterations that end before they reach the tolerance are no error:
/// see [`SelfCalibration::converged`].
pub fn calibrate_on_specimen(
    images: &[ImageView<'_>],
    mesh: &Mesh,
    camera: &Pinhole,
    parameters: &[Parameter],
    start: &[[f64; 2]],
    options: &SelfCalibrationOptions,
    monitor: &dyn Monitor,
) -> Result<SelfCalibration, Error> {
    check(images, parameters, start, options)?;
    let (mesh, _) = mesh.compact();
    let solve = || solve(images, &mesh, camera, parameters, start, options, monitor);
    match options.num_threads.map(thread_pool).transpose()? {
        Some(pool) => pool.install(solve),
        None => solve(),
    }
}

fn check(
    images: &[ImageView<'_>],
    parameters: &[Parameter],
    start: &[[f64; 2]],
    options: &SelfCalibrationOptions,
) -> Result<(), Error> {
    let shared = Options {
        quadrature: quadrature(options.density),
        prefilter: options.prefilter,
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        num_threads: options.num_threads,
        ..Options::default()
    };
    shared.check()?;
    if let Some(noise) = options.noise.filter(|noise| !(noise.is_finite() && *noise >= 0.0)) {
        let expected = "zero or a positive standard deviation in grey levels";
        return Err(crate::SolveError::InvalidOption { option: "noise", expected, value: noise.to_string() }.into());
    }
    if images.len() < 2 || start.len() + 1 != images.len() || !start.iter().flatten().all(|t| t.is_finite()) {
        let found = format!("got {} images and {} finite translations", images.len(), start.len());
        return Err(SelfCalibrationError::Images { found }.into());
    }
    let size = |image: &ImageView<'_>| [image.width(), image.height()];
    if let Some(other) = images.iter().find(|image| size(image) != size(&images[0])) {
        return Err(Error::SizeMismatch { reference: size(&images[0]), deformed: size(other) });
    }
    let twice = parameters.iter().enumerate().find(|(index, parameter)| parameters[..*index].contains(parameter));
    if let Some((_, parameter)) = twice {
        return Err(SelfCalibrationError::Parameters { found: format!("{parameter} is named twice") }.into());
    }
    if parameters.is_empty() {
        return Err(SelfCalibrationError::Parameters { found: "got none".to_owned() }.into());
    }
    Ok(())
}

fn quadrature(density: f64) -> Quadrature {
    Quadrature::Mesh { rule: Rule::default(), density }
}

fn solve(
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
        brightness: options.brightness,
        images: images.len(),
        pivot: images[0].statistics().0,
        reach: REACH * (size[0] as f64).hypot(size[1] as f64),
    };
    let count = mesh.num_nodes() as f64;
    let pivot = std::array::from_fn(|d| mesh.points().iter().map(|point| point[d]).sum::<f64>() / count);
    let mut state = State {
        camera: *camera,
        motions: std::iter::once(&[0.0; 2]).chain(start).map(|&start| Motion::translation(pivot, start)).collect(),
        brightness: vec![[1.0, 0.0]; images.len()],
    };
    let mut history = Vec::new();
    start_on_reduced_images(&problem, images, camera, &mut state, &mut history, monitor)?;

    let sample =
        |filter: fn(ImageView<'_>, Interpolation, Gradient, f64) -> Result<Sampler, fedic_image::ImageError>| {
            let sample =
                |view: &ImageView<'_>| filter(*view, options.interpolation, Gradient::Analytic, options.prefilter);
            images.iter().map(sample).collect::<Result<Vec<_>, _>>()
        };
    let margin = MARGIN + MARGIN_DEVIATIONS * options.prefilter;
    let view = View::new(&problem, sample(Sampler::new)?, size, margin, camera, 1.0, quadrature(options.density))?;
    let limits = Limits { level: 0, tolerance: options.tolerance, max_iterations: options.max_iterations };
    let (sums, converged) = iterate(&problem, &view, &mut state, &limits, &mut history, monitor)?;
    check_match(&sums, images.len())?;
    check_motion(&problem, &state)?;
    statistics::check_determined(&problem, &sums)?;

    let averaged = (4.0 * PI * options.prefilter.powi(2)).max(PIXELS_INTERPOLATED);
    let num_points = view.num_points();
    // A filter smooths the noise before it is gathered: that is to gather it with the gradient filtered once more.
    let view = if options.prefilter > 0.0 { view.with_samplers(sample(Sampler::filtered_twice)?) } else { view };
    let gathered = view.sums(&state, |pixels| pixels * (pixels / averaged).max(1.0), monitor)?;
    let residual_std = sums.variance().sqrt();
    let noise = options.noise.unwrap_or(residual_std * averaged.sqrt());
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
        residual_std,
        noise,
        num_points,
    })
}

/// Brings the state near on reduced images, the smallest first.
fn start_on_reduced_images(
    problem: &Problem<'_>,
    images: &[ImageView<'_>],
    camera: &Pinhole,
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
        let sample = |image: &Image| Sampler::new(image.view(), Interpolation::Bspline3, Gradient::Analytic, 0.0);
        let samplers = images.par_iter().map(sample).collect::<Result<Vec<_>, _>>()?;
        let size = [images[0].width(), images[0].height()];
        let factor = 0.5_f64.powi(level as i32);
        let view = View::new(problem, samplers, size, MARGIN, camera, factor, quadrature(1.0))?;
        let limits = Limits { level, tolerance: COARSE_TOLERANCE, max_iterations: COARSE_ITERATIONS };
        let (sums, _) = iterate(problem, &view, state, &limits, history, monitor)?;
        check_motion(problem, state)?;
        statistics::check_determined(problem, &sums)?;
    }
    Ok(())
}

/// Whether every image shows the texture of the others.
fn check_match(sums: &Sums, images: usize) -> Result<(), Error> {
    for image in 0..images {
        let residual = sums.image_variance(image).ok_or(SelfCalibrationError::Unseen { image })?.sqrt();
        let texture = sums.texture_variance().sqrt();
        if texture < FLAT {
            return Err(Error::Flat { which: "reference", std: texture });
        }
        if residual.is_nan() || residual > LARGEST_RESIDUAL * texture {
            return Err(SelfCalibrationError::Unmatched { image, residual, texture }.into());
        }
    }
    Ok(())
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
