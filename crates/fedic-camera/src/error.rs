//! Errors of cameras and lenses.

use thiserror::Error;

/// An invalid camera parameter, or a request that a camera or lens cannot fulfil.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A parameter is NaN or infinite.
    #[error("the camera's {parameter} is not finite")]
    NonFinite {
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// A length is zero or negative.
    #[error("the camera's {parameter} must be positive, got {value}")]
    NotPositive {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value given.
        value: f64,
    },
    /// A matrix is not a rotation.
    #[error(
        "the camera's rotation matrix is not a rotation: R R^T differs from the identity by {deviation:.1e} or its \
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
    /// No camera has a parameter of this name.
    #[error("no camera has a parameter \"{name}\": choose among {}", known.join(", "))]
    UnknownParameter {
        /// The name given.
        name: String,
        /// Names of all parameters.
        known: Vec<&'static str>,
    },
    /// This camera does not have the parameter.
    #[error("the camera has no parameter \"{name}\": its parameters are {}", known.join(", "))]
    NotAParameter {
        /// Name of the parameter.
        name: &'static str,
        /// Names of the camera's parameters.
        known: Vec<&'static str>,
    },
    /// The number of coefficients does not match the lens model.
    #[error("a lens of the model \"{model}\" has {expected} coefficients, got {got}")]
    CoefficientCount {
        /// Name of the lens model.
        model: &'static str,
        /// Number of coefficients of the model.
        expected: usize,
        /// Number of coefficients given.
        got: usize,
    },
    /// An image without pixels.
    #[error(
        "an image of {} x {} px has no pixel: the size of the image, the region or the binning of a camera is wrong",
        size[0], size[1]
    )]
    EmptyImage {
        /// Width and height.
        size: [u32; 2],
    },
    /// A region that is not inside the image.
    #[error(
        "the region of {} x {} px with its first pixel at ({}, {}) is not inside the image, which has {} x {} px",
        size[0], size[1], origin[0], origin[1], image[0], image[1]
    )]
    OutsideImage {
        /// Column and row of the first pixel of the region.
        origin: [u32; 2],
        /// Width and height of the region.
        size: [u32; 2],
        /// Width and height of the image.
        image: [u32; 2],
    },
    /// A rectangle without area.
    #[error("the domain of a spline is (x0, y0, x1, y1) with x0 < x1 and y0 < y1, got {domain:?}")]
    EmptyDomain {
        /// The rectangle given.
        domain: [f64; 4],
    },
    /// The number of coefficients does not match the intervals of a spline.
    #[error(
        "a spline has 3 coefficients more than intervals along each axis, and at least one interval; got {got} \
         coefficients for {intervals:?} intervals along x and y"
    )]
    SplineShape {
        /// Intervals along each axis.
        intervals: [usize; 2],
        /// Number of coefficients given.
        got: usize,
    },
    /// A lens that is not limited to a domain.
    #[error(
        "a lens of the model \"{model}\" is not limited to a domain: give a domain (x0, y0, x1, y1) in normalised image \
         coordinates, such as the borders of the image less the principal point, over the focal length"
    )]
    NoDomain {
        /// Name of the lens model.
        model: &'static str,
    },
    /// A lens cannot be evaluated on all of a domain.
    #[error("the lens does not reach all of {domain:?}: its model folds or has no inverse there; use a smaller domain")]
    LensOutOfReach {
        /// The rectangle, in normalised image coordinates.
        domain: [f64; 4],
    },
    /// No spline approximates a lens to the tolerance.
    #[error(
        "no spline approximates the lens to {tolerance:.1e} in normalised image coordinates, the error of the finest is \
         {error:.1e}: use a larger tolerance or a smaller domain"
    )]
    ToleranceNotReached {
        /// The largest error allowed.
        tolerance: f64,
        /// The error of the finest spline.
        error: f64,
    },
}
