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
    /// A rectangle without area.
    #[error("the domain of a spline is (x0, y0, x1, y1) with x0 < x1 and y0 < y1, got {domain:?}")]
    EmptyDomain {
        /// The rectangle given.
        domain: [f64; 4],
    },
    /// Coefficients that do not make a spline.
    #[error(
        "a spline of {intervals:?} intervals along x and y has 3 coefficients more along each, and at least one interval; \
         got {got} coefficients in all"
    )]
    SplineShape {
        /// Intervals along each axis.
        intervals: [usize; 2],
        /// How many coefficients were given.
        got: usize,
    },
    /// A lens that does not reach all of the domain wanted.
    #[error(
        "the lens does not reach all of {domain:?}: its model folds, or has no inverse there; take a smaller domain"
    )]
    LensOutOfReach {
        /// The rectangle wanted.
        domain: [f64; 4],
    },
    /// A lens that no spline follows.
    #[error(
        "no spline follows the lens to {tolerance:.1e} on the retinal plane, the finest is {error:.1e} off: allow more, or \
         take a smaller domain"
    )]
    TooRough {
        /// The difference allowed.
        tolerance: f64,
        /// The difference left.
        error: f64,
    },
    /// A parameter that the lens does not have.
    #[error("\"{name}\" is a coefficient of Brown's lens, and the camera has another: a spline")]
    NotOfThisLens {
        /// Name of the parameter.
        name: &'static str,
    },
}
