//! What can be wrong with a camera.

use thiserror::Error;

/// Camera parameters that describe no camera, or a point that a camera cannot take back.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CameraError {
    /// A parameter is NaN or infinite.
    #[error("the camera's {parameter} is not finite")]
    NonFinite {
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// A length that must not be zero or negative.
    #[error("the camera's {parameter} must be positive, got {value}")]
    NotPositive {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given.
        value: f64,
    },
    /// The matrix given is not a rotation.
    #[error(
        "the camera's rotation matrix is no rotation: R R^T differs from the identity by {deviation:.1e} or its \
         determinant is not +1; give an orthonormal, right-handed matrix or a rotation vector"
    )]
    NotARotation {
        /// Largest entry of `|R R^T - I|`, or of `|det R - 1|`.
        deviation: f64,
    },
    /// The angle between the pixel axes is not strictly between 0 and pi.
    #[error("the camera's skew_angle is the angle between the pixel axes, in radians between 0 and pi; got {value}")]
    SkewAngle {
        /// The angle given.
        value: f64,
    },
    /// No parameter of a pinhole camera has this name.
    #[error(
        "\"{name}\" is no parameter of a pinhole camera: choose among fx, fy, cx, cy (pixels), k1, k2, k3, d1, d2, p1, p2 \
         (lens), rx, ry, rz, tx, ty, tz (pose)"
    )]
    UnknownParameter {
        /// The name given.
        name: String,
    },
}
