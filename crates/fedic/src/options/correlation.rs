//! Options of a correlation.

use fedic_image::Interpolation;
use fedic_mesh::Rule;

use super::choice::choices;
use super::declare::declare_options;
use super::error::OptionError;
use super::range::{DENSITY, MAX_ITERATIONS, NOISE, NUM_THREADS, REGULARIZATION_LENGTH, Range, SMOOTHING, TOLERANCE};
use super::value::{OptionKind, OptionType, OptionValue};

/// Quadrature of the integral over the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quadrature {
    /// Points in the cells of the mesh, cut into equal parts (paper, Sect. 3.2).
    Mesh {
        /// Number of parts along each direction of a cell.
        rule: Rule,
        /// Factor on the number of points.
        density: f64,
    },
    /// The pixels whose centre falls in a cell (paper, Sect. 2.2).
    Pixel,
}

impl Default for Quadrature {
    fn default() -> Self {
        Self::Mesh { rule: Rule::default(), density: 1.0 }
    }
}

/// Name of [`Quadrature::Pixel`].
const PIXEL: &str = "pixel";

impl OptionType for Quadrature {
    const KIND: OptionKind = OptionKind::Quadrature;

    fn names() -> Vec<&'static str> {
        Rule::names().into_iter().chain([PIXEL]).collect()
    }

    fn read(value: &OptionValue) -> Option<Self> {
        let (name, density) = match value {
            OptionValue::Name(name) => (name, 1.0),
            OptionValue::Scaled(name, density) => (name, *density),
            _ => return None,
        };
        if name == PIXEL {
            return Some(Self::Pixel);
        }
        Rule::read(&OptionValue::Name(name.clone())).map(|rule| Self::Mesh { rule, density })
    }

    fn value(&self) -> OptionValue {
        match self {
            Self::Pixel => OptionValue::Scaled(PIXEL.to_owned(), 1.0),
            Self::Mesh { rule, density } => OptionValue::Scaled(rule.name().to_owned(), *density),
        }
    }

    fn check(&self, _option: &'static str, range: Option<Range>) -> Result<(), OptionError> {
        match self {
            Self::Mesh { density, .. } => density.check("density", range),
            Self::Pixel => Ok(()),
        }
    }
}

choices! {
    /// Gradient of the reference image.
    pub enum Gradient("gradient") {
        /// Derivative of the interpolant.
        #[default]
        Analytic = "analytic",
        /// Central differences at the pixels, then interpolated, as in the paper.
        FiniteDifference = "finite-difference",
    }
}

choices! {
    /// Domain over which the grey levels of the deformed image are matched to those of the reference image.
    pub enum Brightness("brightness") {
        /// [`Field`](Self::Field) with robust weights, [`Global`](Self::Global) without.
        #[default]
        Auto = "auto",
        /// The whole mesh: mean and standard deviation are matched.
        Global = "global",
        /// Each cell: mean and standard deviation are matched.
        Element = "element",
        /// A gain and an offset that vary over the mesh, smooth over about two cells.
        Field = "field",
        /// No correction: grey levels are compared as they are.
        None = "none",
    }
}

choices! {
    /// Function that weighs the points by their residual.
    pub enum Robust("robust") {
        /// Huber's: large residuals count less.
        Huber = "huber",
        /// Tukey's biweight: large residuals do not count.
        #[default]
        Tukey = "tukey",
    }
}

choices! {
    /// Time at which the Hessian is computed.
    pub enum Hessian("hessian") {
        /// Once, over all points of the reference image.
        #[default]
        Initial = "initial",
        /// At every iteration, over the points inside the deformed image.
        Updated = "updated",
    }
}

declare_options! {
    /// Options of a correlation.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic::{OptionValue, Options, Quadrature};
    ///
    /// let mut options = Options::default().smoothing(0.0).quadrature(Quadrature::Pixel);
    /// options.set("hessian", &OptionValue::Name("updated".to_owned()))?;
    /// # Ok::<(), fedic::OptionError>(())
    /// ```
    pub struct Options {
        /// Quadrature of the integral over the mesh: points in the cells, cut by a rule into equal parts, or the pixels whose
        /// centre falls in a cell.
        quadrature: Quadrature = Quadrature::default(), in DENSITY;
        /// Interpolation of both images between pixels.
        interpolation: Interpolation = Interpolation::default();
        /// Gradient of the reference image: `analytic`, that of the interpolant, or `finite-difference`, central differences at
        /// the pixels, then interpolated.
        gradient: Gradient = Gradient::default();
        /// Standard deviation, in pixels, of a Gaussian smoothing of both images; 0 for none. It removes spatial frequencies
        /// that no interpolation reproduces: with the default the bias of the interpolation is at most 1e-4 px. It raises the
        /// noise of the displacement by 0 to 7 % where speckles are about five pixels wide, and by 30 % where they are one to
        /// three.
        smoothing: f64 = 0.8, in SMOOTHING;
        /// Domain over which the grey levels of the deformed image are matched to those of the reference image: `global`, the
        /// whole mesh, `element`, each cell, `field`, a gain and an offset that vary over the mesh and are smooth over about two
        /// cells, or `none`, no correction. `auto` is `field` with robust weights and `global` without.
        brightness: Brightness = Brightness::default();
        /// Function that weighs the points by their residual, so that damage does not spoil what lies beside it: `tukey`, large
        /// residuals do not count, or `huber`, they count less. The scale of the residual is that of neighbouring cells. Cells
        /// without an outlier are not weighed. Cells that lose much of their weight are flagged, left out, and the frame is
        /// measured again. By default no weights.
        robust: Option<Robust> = None;
        /// Time at which the Hessian is computed: `initial`, once, over all points of the reference image, or `updated`, at
        /// every iteration, over the points inside the deformed image. It does not depend on the displacement otherwise.
        hessian: Hessian = Hessian::default();
        /// Wavelength, in pixels of the reference image, of the displacements whose amplitude the regularization halves: waves of
        /// twice the length keep 94 %, of half the length 6 %. It is a penalty on the second derivatives, or on the forces of
        /// linear elasticity (the argument `regularization`), whose length is that of shear waves. Rigid motions of any size and
        /// uniform strain are left alone, with free edges too. The length is accurate from five cells on; no regularization by
        /// default.
        regularization_length: Option<f64> = None, in REGULARIZATION_LENGTH;
        /// The iterations stop when the error that they leave is below this at every node, in pixels. It is estimated from the
        /// last correction and its ratio to the one before.
        tolerance: f64 = 1e-3, in TOLERANCE;
        /// Standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing: that of a static pair
        /// divided by the square root of two. The verdict on the result is relative to it. By default it is estimated from the
        /// residual of the measurement, in the cells whose images correlate.
        noise: Option<f64> = None, in NOISE;
        /// Largest number of iterations on the images at full resolution.
        max_iterations: usize = 50, in MAX_ITERATIONS;
        /// Number of threads; all processors by default. The result does not depend on it.
        num_threads: Option<usize> = None, in NUM_THREADS;
    }
}

impl Options {
    /// The brightness correction in use, [`Brightness::Auto`] resolved.
    pub(crate) fn brightness_in_use(&self) -> Brightness {
        match self.brightness {
            Brightness::Auto if self.robust.is_some() => Brightness::Field,
            Brightness::Auto => Brightness::Global,
            other => other,
        }
    }
}
