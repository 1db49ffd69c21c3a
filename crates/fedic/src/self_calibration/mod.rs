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

use crate::correlator::thread_pool;
use crate::self_calibration::solve::solve;
use crate::{Error, Monitor};

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
