//! Names of the parameters of cameras.

use std::fmt;
use std::str::FromStr;

use crate::{CameraError, Distortion};

/// A parameter of a camera.
///
/// # Examples
///
/// ```
/// use fedic_camera::Parameter;
/// assert_eq!("fx".parse(), Ok(Parameter::Fx));
/// assert_eq!("k1".parse(), Ok(Parameter::Lens("k1")));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Parameter {
    /// Focal length along the columns, in pixels.
    Fx,
    /// Focal length along the rows, in pixels.
    Fy,
    /// Column of the principal point.
    Cx,
    /// Row of the principal point.
    Cy,
    /// Coefficient of the lens, by its name in [`Lens::GROUPS`](crate::Lens::GROUPS).
    Lens(&'static str),
    /// Rotation of the world about its origin and the `x` axis of the camera, in radians, relative to the present pose.
    Rx,
    /// Rotation about the `y` axis of the camera.
    Ry,
    /// Rotation about the `z` axis of the camera.
    Rz,
    /// Translation along the `x` axis of the camera, in the world unit.
    Tx,
    /// Translation along the `y` axis of the camera.
    Ty,
    /// Translation along the `z` axis of the camera.
    Tz,
    /// Column of the image point of the world origin.
    U0,
    /// Row of the image point of the world origin.
    V0,
    /// Angle by which the world is rotated counter-clockwise in the image, in radians.
    Angle,
    /// Pixels per world unit.
    Scale,
}

/// The parameters that are not coefficients of a lens.
const NAMES: [(Parameter, &str); 14] = [
    (Parameter::Fx, "fx"),
    (Parameter::Fy, "fy"),
    (Parameter::Cx, "cx"),
    (Parameter::Cy, "cy"),
    (Parameter::Rx, "rx"),
    (Parameter::Ry, "ry"),
    (Parameter::Rz, "rz"),
    (Parameter::Tx, "tx"),
    (Parameter::Ty, "ty"),
    (Parameter::Tz, "tz"),
    (Parameter::U0, "u0"),
    (Parameter::V0, "v0"),
    (Parameter::Angle, "angle"),
    (Parameter::Scale, "scale"),
];

impl Parameter {
    /// Name of the parameter, such as `fx`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lens(name) => name,
            _ => NAMES.iter().find(|(parameter, _)| *parameter == self).map_or("", |(_, name)| name),
        }
    }

    /// All parameters of all cameras and lens models.
    fn all() -> impl Iterator<Item = Self> {
        let coefficients =
            Distortion::MODELS.iter().flat_map(|model| model.groups).flat_map(|group| group.coefficients);
        NAMES.into_iter().map(|(parameter, _)| parameter).chain(coefficients.map(|name| Self::Lens(name)))
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for Parameter {
    type Err = CameraError;

    fn from_str(name: &str) -> Result<Self, CameraError> {
        Self::all().find(|parameter| parameter.name() == name).ok_or_else(|| CameraError::UnknownParameter {
            name: name.to_owned(),
            known: Self::all().map(Self::name).collect(),
        })
    }
}
