//! Entry points of the specimen calibration.

use crate::error::Error;
use crate::monitor::Monitor;
use crate::self_calibration::options::SelfCalibrationOptions;
use crate::self_calibration::result::SelfCalibration;
use crate::self_calibration::solve::solve;
use crate::self_calibration::specimen_images::SpecimenImages;
use crate::threads::{ThreadPool, in_pool};

/// Estimates camera parameters from images of the specimen at rest and after rigid motions.
///
/// A flat speckled specimen is recorded at rest and after rigid motions `T_j`. With the true parameters `p`, the camera
/// `P_p` maps all images to one texture on the specimen. The unknowns are the parameters, the motions, and a gain `a_j`
/// and an offset `b_j` of each moved image. They minimise
///
/// ```text
/// sum over j and the points X of the mesh of [ a_j g_j(P_p(T_j X)) + b_j - m(X) ]^2
/// ```
///
/// where `g_0` is the reference image, `T_0` the identity, `a_0 = 1` and `b_0 = 0`. The texture `m(X)` that minimises
/// the sum is the mean of the images that see `X`. With one moved image, the sum is half the squared difference
/// `f - g`. With several moved images, the differences `f - g_j` would count the noise of the reference image once each.
/// Residuals relative to the mean weight all images equally, and the estimate is the maximum-likelihood estimate. A
/// point outside an image is compared in the others.
///
/// Gauss-Newton requires the derivative of `g_j(P_p(T_j X))` with respect to the unknowns. Let `G(X)` be the gradient
/// of the texture along the specimen, averaged over the images, and `B_j = d P_p(T_j X) / dX`. The derivative is
/// `q_j . dP`, where `q_j = B_j^-T G` is the texture gradient as it appears in image `j`, and `dP` the displacement of the
/// image point: `dP_p/dp (T_j X)` for the parameters and `dP_p/dX dT_j` for the motion. A change that is the same in
/// all images only moves the texture. Subtracting the mean over the images removes it exactly; it contains what no
/// image determines: the position and the scale of the specimen.
///
/// # Examples
///
/// ```
/// use fedic::{
///     BrownDistortion, CellType, Image, Parameter, Pinhole, SelfCalibrationOptions, SpecimenImages,
///     calibrate_on_specimen, rectangle_mesh, unproject,
/// };
/// use fedic_synthetic::Speckle;
///
/// // A speckled plane before a lens, at rest and moved twice.
/// let upright = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
/// let start = Pinhole::new([150.0; 2], [60.0, 50.0], upright, [0.0, 0.0, 150.0])?;
/// let camera = start.clone().with_distortion(BrownDistortion::new([-0.2, 0.0, 0.0], [0.0; 2], [0.0; 2])?);
/// let speckle = Speckle::new(6.0, 0.5, 1)?;
/// let translations = [[20.0, -8.0], [-10.0, 16.0]];
/// let image = |[x, y]: [f64; 2]| {
///     let pixels = (0..120 * 100).map(|k| [(k % 120) as f64, (k / 120) as f64]);
///     let points = pixels.filter_map(|pixel| unproject(&camera, pixel, 0.0));
///     Image::new(120, 100, points.map(|[px, py, _]| (200.0 * speckle.value([px - x, py - y])) as f32).collect())
/// };
/// let images = [image([0.0, 0.0])?, image(translations[0])?, image(translations[1])?];
///
/// let input = SpecimenImages {
///     images: &images.each_ref().map(Image::view),
///     mesh: &rectangle_mesh([-60.0, -50.0, 60.0, 50.0], 10.0, CellType::Quad)?,
///     camera: &start,
///     parameters: &[Parameter::Lens("k1")],
///     translations: &translations,
/// };
/// let found = calibrate_on_specimen(&input, &SelfCalibrationOptions::default())?;
/// let k1 = found.camera.distortion().and_then(|lens| lens.coefficient("k1")).unwrap_or(0.0);
/// assert!(found.converged && (k1 + 0.2).abs() < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`Error`] if an input or option is invalid, the images do not match, or they do not determine a parameter. It is not
/// an error if the iterations do not reach the tolerance; see [`SelfCalibration::converged`].
pub fn calibrate_on_specimen(
    input: &SpecimenImages<'_>,
    options: &SelfCalibrationOptions,
) -> Result<SelfCalibration, Error> {
    calibrate_on_specimen_with(input, options, &())
}

/// [`calibrate_on_specimen`], reporting progress to `monitor`.
///
/// # Errors
///
/// Those of [`calibrate_on_specimen`]; [`Error::Cancelled`] if `monitor` asks to stop.
pub fn calibrate_on_specimen_with(
    input: &SpecimenImages<'_>,
    options: &SelfCalibrationOptions,
    monitor: &dyn Monitor,
) -> Result<SelfCalibration, Error> {
    options.check()?;
    input.check()?;
    let (mesh, _) = input.mesh.collapsed_as_triangles().compact();
    let input = SpecimenImages { mesh: &mesh, ..*input };
    let pool = options.num_threads.map(|number| ThreadPool::new(Some(number)));
    in_pool(pool.as_ref(), || solve(&input, options, monitor))?
}
