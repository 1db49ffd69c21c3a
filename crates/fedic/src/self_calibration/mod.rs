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

mod calibration;
mod error;
mod iterations;
mod motion;
mod options;
mod problem;
mod rows;
mod solve;
mod statistics;
mod sums;
#[cfg(test)]
mod tests;
mod view;

use fedic_camera::{Parameter, Pinhole};
use fedic_image::ImageView;
use fedic_mesh::Mesh;

pub use calibration::SelfCalibration;
pub use error::SelfCalibrationError;
pub use motion::{MotionKind, RIGID};
pub use options::SelfCalibrationOptions;

use crate::parallel::thread_pool;
use crate::self_calibration::solve::solve;
use crate::{Error, Monitor};

/// Finds `parameters` of a camera from `images` of a specimen in the plane of `mesh`: first the reference image, then
/// those of the specimen moved, whose translations along `X` and `Y` are about `start`. `camera` gives the first values,
/// and those of all other parameters.
///
/// # Examples
///
/// ```
/// use fedic::{
///     BrownDistortion, CellType, Image, Parameter, Pinhole, SelfCalibrationOptions, calibrate_on_specimen,
///     rectangle_mesh, unproject,
/// };
/// use fedic_synthetic::Speckle;
///
/// // A speckled plane before a lens, at rest and moved twice.
/// let upright = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
/// let start = Pinhole::new([150.0; 2], [60.0, 50.0], upright, [0.0, 0.0, 150.0])?;
/// let camera = start.clone().with_distortion(BrownDistortion::new([-0.2, 0.0, 0.0], [0.0; 2], [0.0; 2])?);
/// let speckle = Speckle::new(6.0, 0.5, 1)?;
/// let motions = [[20.0, -8.0], [-10.0, 16.0]];
/// let image = |[x, y]: [f64; 2]| {
///     let pixels = (0..120 * 100).map(|k| [(k % 120) as f64, (k / 120) as f64]);
///     let seen = pixels.filter_map(|pixel| unproject(&camera, pixel, 0.0));
///     Image::new(120, 100, seen.map(|[px, py, _]| (200.0 * speckle.value([px - x, py - y])) as f32).collect())
/// };
/// let images = [image([0.0, 0.0])?, image(motions[0])?, image(motions[1])?];
///
/// let specimen = rectangle_mesh([-60.0, -50.0, 60.0, 50.0], 10.0, CellType::Quad)?;
/// let views = images.each_ref().map(Image::view);
/// let options = SelfCalibrationOptions::default();
/// let found = calibrate_on_specimen(&views, &specimen, &start, &[Parameter::K1], &motions, &options, &())?;
/// let k1 = found.camera.distortion().and_then(|lens| lens.brown()).map_or(0.0, |lens| lens.radial()[0]);
/// assert!(found.converged && (k1 + 0.2).abs() < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    camera.moved_by(parameters, &vec![0.0; parameters.len()])?;
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
    options.check()?;
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
