//! What the user chooses.

use fedic_image::Interpolation;

use crate::self_calibration::motion::MotionKind;
use crate::{Options, Quadrature, Rule, SolveError};

/// Options of [`calibrate_on_specimen`](crate::calibrate_on_specimen).
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
    pub smoothing: f64,
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
            smoothing: 0.8,
            brightness: true,
            noise: None,
            tolerance: 1e-5,
            max_iterations: 50,
            num_threads: None,
        }
    }
}

impl SelfCalibrationOptions {
    /// Checks every range.
    pub(crate) fn check(&self) -> Result<(), SolveError> {
        let shared = Options {
            quadrature: Quadrature::Mesh { rule: Rule::default(), density: self.density },
            smoothing: self.smoothing,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            num_threads: self.num_threads,
            ..Options::default()
        };
        shared.check()?;
        if let Some(noise) = self.noise.filter(|noise| !(noise.is_finite() && *noise >= 0.0)) {
            let expected = "zero or a positive standard deviation in grey levels";
            return Err(SolveError::InvalidOption { option: "noise", expected, value: noise.to_string() });
        }
        Ok(())
    }
}
