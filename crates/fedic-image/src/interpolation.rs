//! The interpolations on offer and their names.

use std::fmt;
use std::str::FromStr;

use crate::error::ImageError;

/// How grey levels are interpolated between pixels.
///
/// # Examples
///
/// ```
/// use fedic_image::Interpolation;
///
/// assert_eq!("bspline5".parse(), Ok(Interpolation::Bspline5));
/// assert_eq!(Interpolation::default().to_string(), "bspline5");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Interpolation {
    /// Product of straight lines, 2 x 2 pixels: continuous, with a gradient that jumps at the pixel centres.
    Bilinear,
    /// Keys' cubic convolution with `a = -1/2`, 4 x 4 pixels: continuous gradient.
    Bicubic,
    /// Cubic B-spline through the pixels, 4 x 4 coefficients: continuous second derivatives.
    Bspline3,
    /// Quintic B-spline through the pixels, 6 x 6 coefficients: continuous fourth derivatives, least bias.
    #[default]
    Bspline5,
}

impl Interpolation {
    /// Every interpolation, from the cheapest to the most precise.
    pub const ALL: [Self; 4] = [Self::Bilinear, Self::Bicubic, Self::Bspline3, Self::Bspline5];

    /// The name it is parsed from and shown as.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Bilinear => "bilinear",
            Self::Bicubic => "bicubic",
            Self::Bspline3 => "bspline3",
            Self::Bspline5 => "bspline5",
        }
    }

    pub(crate) fn choices() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

impl fmt::Display for Interpolation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Interpolation {
    type Err = ImageError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| ImageError::UnknownInterpolation { name: name.to_owned() })
    }
}
