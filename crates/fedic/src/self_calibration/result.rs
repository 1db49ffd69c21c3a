//! Result of a specimen calibration.

use fedic_camera::Pinhole;

use crate::results::solution::Iteration;
use crate::self_calibration::motion::RIGID;

/// A camera calibrated on the specimen itself.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SelfCalibration {
    /// The camera with the estimated parameters.
    pub camera: Pinhole,
    /// Covariance of the parameters, row by row.
    pub covariance: Vec<f64>,
    /// For each parameter, the largest displacement of a node in any image per unit of the parameter, in pixels.
    pub sensitivities: Vec<f64>,
    /// Rigid motion of each moved image: translation in the unit of the mesh, and rotation vector in radians about the mean of
    /// the nodes.
    pub motions: Vec<[f64; RIGID]>,
    /// Standard deviations of the motions; 0 for fixed components.
    pub motion_standard_deviations: Vec<[f64; RIGID]>,
    /// Every iteration, coarsest level first.
    pub history: Vec<Iteration>,
    /// Whether the last correction was within the tolerance.
    pub converged: bool,
    /// RMS of the difference between the grey levels of one image, as smoothed, and the common texture.
    pub residual_rms: f64,
    /// Standard deviation, in grey levels, of the noise of one image as recorded that the covariance assumes.
    pub noise: f64,
    /// Number of quadrature points.
    pub num_points: usize,
}
