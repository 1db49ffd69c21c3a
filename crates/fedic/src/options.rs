//! What the user chooses, and the ranges it must lie in.

use std::str::FromStr;

use fedic_image::Interpolation;
use fedic_mesh::Rule;

use crate::SolveError;

/// Where the quadrature points lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quadrature {
    /// In the mesh's elements, cut into equal parts (paper, Sect. 3.2).
    Mesh {
        /// How finely the elements are cut.
        rule: Rule,
        /// Factor on the number of points.
        density: f64,
    },
    /// At the pixels whose centre falls in an element (paper, Sect. 2.2).
    Pixel,
}

impl Default for Quadrature {
    fn default() -> Self {
        Self::Mesh { rule: Rule::default(), density: 1.0 }
    }
}

/// Gradient of the reference image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Gradient {
    /// Derivative of the interpolant.
    #[default]
    Analytic,
    /// Central differences at the pixels, then interpolated, as in the paper.
    FiniteDifference,
}

/// What the mean and the standard deviation of the deformed image are matched over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Brightness {
    /// Grey levels are compared as they are.
    None,
    /// Over the whole mesh.
    #[default]
    Global,
    /// Over each element.
    Element,
}

/// When the Hessian is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Hessian {
    /// Once, with the camera's Jacobian at the reference position.
    #[default]
    Initial,
    /// At every iteration, with the camera's Jacobian at the current position.
    Updated,
}

/// Options of a correlation.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Where the quadrature points lie.
    pub quadrature: Quadrature,
    /// Interpolation of both images.
    pub interpolation: Interpolation,
    /// Gradient of the reference image.
    pub gradient: Gradient,
    /// Standard deviation, in pixels, of a Gaussian filter applied to both images first; 0 for none.
    pub smoothing: f64,
    /// Brightness and contrast correction.
    pub brightness: Brightness,
    /// When the Hessian is computed.
    pub hessian: Hessian,
    /// Wavelength, in pixels of the reference image, below which the displacement is smoothed (Tikhonov, on its gradient).
    pub regularization_length: Option<f64>,
    /// The iteration stops when no node moves by more than this, in pixels.
    pub tolerance: f64,
    /// Most iterations on the images at full resolution.
    pub max_iterations: usize,
    /// Threads to use; `None` uses the rayon pool of the caller. The result does not depend on it.
    pub num_threads: Option<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            quadrature: Quadrature::default(),
            interpolation: Interpolation::default(),
            gradient: Gradient::default(),
            smoothing: 0.8,
            brightness: Brightness::default(),
            hessian: Hessian::default(),
            regularization_length: None,
            tolerance: 1e-3,
            max_iterations: 50,
            num_threads: None,
        }
    }
}

impl Options {
    /// Checks every range.
    ///
    /// # Errors
    ///
    /// [`SolveError::InvalidOption`] for the first option out of its range.
    pub(crate) fn check(&self) -> Result<(), SolveError> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let refuse = |option, expected, value: &dyn ToString| {
            Err(SolveError::InvalidOption { option, expected, value: value.to_string() })
        };
        if let Quadrature::Mesh { density, .. } = self.quadrature
            && !(positive(density) && density <= 1e4)
        {
            return refuse("density", "a positive number of at most 10000", &density);
        }
        if !(self.smoothing.is_finite() && self.smoothing >= 0.0) {
            return refuse("smoothing", "zero or a positive standard deviation in pixels", &self.smoothing);
        }
        if let Some(length) = self.regularization_length.filter(|&length| !positive(length)) {
            return refuse("regularization_length", "a positive wavelength in pixels", &length);
        }
        if !positive(self.tolerance) {
            return refuse("tolerance", "a positive number of pixels", &self.tolerance);
        }
        if self.max_iterations == 0 {
            return refuse("max_iterations", "at least 1", &self.max_iterations);
        }
        match self.num_threads {
            Some(threads) if !(1..=1024).contains(&threads) => refuse("num_threads", "between 1 and 1024", &threads),
            _ => Ok(()),
        }
    }
}

macro_rules! names {
    ($type:ty, $option:literal, $expected:literal, $($name:literal => $value:expr),+) => {
        impl FromStr for $type {
            type Err = SolveError;

            fn from_str(name: &str) -> Result<Self, SolveError> {
                match name {
                    $($name => Ok($value),)+
                    _ => Err(SolveError::InvalidOption {
                        option: $option,
                        expected: $expected,
                        value: format!("\"{name}\""),
                    }),
                }
            }
        }
    };
}

names!(Gradient, "gradient", "\"analytic\" or \"finite-difference\"",
    "analytic" => Self::Analytic, "finite-difference" => Self::FiniteDifference);
names!(Brightness, "brightness", "\"global\", \"element\" or None",
    "none" => Self::None, "global" => Self::Global, "element" => Self::Element);
names!(Hessian, "hessian", "\"initial\" or \"updated\"", "initial" => Self::Initial, "updated" => Self::Updated);
