//! What a calibration gives back.

use fedic_camera::Pinhole;

use crate::Iteration;
use crate::self_calibration::motion::RIGID;

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
    pub residual_rms: f64,
    /// Standard deviation of the noise of one image as recorded that the covariance stands on, in grey levels.
    pub noise: f64,
    /// Number of quadrature points.
    pub num_points: usize,
}
