//! Grey levels and gradients between pixels, for many points at once.

use std::fmt;

use fedic_memory::Row;

use crate::coefficients::Coefficients;
use crate::error::ImageError;
use crate::gaussian::gaussian_weights;
use crate::interpolation::Interpolation;
use crate::kernel::{AnyKernel, BICUBIC, BILINEAR, BSPLINE3, BSPLINE5};
use crate::line_filter::LineFilter;
use crate::prefilter::{CUBIC, QUINTIC};
use crate::reading::{Points, read};
use crate::view::ImageView;

/// Pixels beyond the nearest that some kernels read.
const REACH: isize = 1;

/// An image prepared for reading between its pixels.
///
/// Its domain is the extent of the pixels, `[-0.5, width - 0.5] x [-0.5, height - 0.5]`; outside it, values and gradients
/// are NaN. Preparation runs in the current rayon pool; evaluation is sequential, to be called from as many threads as
/// wanted.
///
/// # Examples
///
/// ```
/// use fedic_image::{Image, Interpolation, Interpolator};
///
/// let ramp: Vec<f32> = (0..48).map(|index| (index % 8) as f32).collect();
/// let image = Image::new(8, 6, ramp)?;
/// let interpolator = Interpolator::new(image.view(), Interpolation::Bilinear);
///
/// let (mut value, mut du, mut dv) = ([0.0; 2], [0.0; 2], [0.0; 2]);
/// interpolator.values_and_gradients(&[2.25, 9.0], &[3.5, 3.5], &mut value, &mut du, &mut dv);
/// assert_eq!((value[0], du[0], dv[0]), (2.25, 1.0, 0.0));
/// assert!(value[1].is_nan());
/// # Ok::<(), fedic_image::ImageError>(())
/// ```
#[derive(Clone)]
pub struct Interpolator {
    kind: Interpolation,
    kernel: AnyKernel,
    width: usize,
    height: usize,
    coefficients: Coefficients,
}

impl Interpolator {
    /// Prepares the image behind `view` for interpolation of this `kind`.
    #[must_use]
    pub fn new(view: ImageView<'_>, kind: Interpolation) -> Self {
        Self::filtered(view, kind, &[1.0], Row::default())
    }

    /// Prepares the image smoothed by a Gaussian of standard deviation `sigma`, in pixels: as [`new`](Self::new) does of the
    /// image that [`gaussian_filter`](crate::gaussian_filter) returns, without holding it.
    ///
    /// # Errors
    ///
    /// [`ImageError::InvalidSigma`] if `sigma` is negative, not a number, or larger than the image.
    pub fn smoothed(view: ImageView<'_>, kind: Interpolation, sigma: f64) -> Result<Self, ImageError> {
        Ok(Self::filtered(view, kind, &gaussian_weights(view, sigma)?, Row::default()))
    }

    /// Prepares the next image of a series as [`smoothed`](Self::smoothed) does, in the memory that this one leaves.
    ///
    /// # Errors
    ///
    /// Those of [`smoothed`](Self::smoothed).
    pub fn renewed(self, view: ImageView<'_>, sigma: f64) -> Result<Self, ImageError> {
        Ok(Self::filtered(view, self.kind, &gaussian_weights(view, sigma)?, self.coefficients.into_memory()))
    }

    fn filtered(view: ImageView<'_>, kind: Interpolation, weights: &[f32], memory: Row<f32>) -> Self {
        let (kernel, prefilter) = match kind {
            Interpolation::Bilinear => (AnyKernel::Two(BILINEAR), None),
            Interpolation::Bicubic => (AnyKernel::Four(BICUBIC), None),
            Interpolation::Bspline3 => (AnyKernel::Four(BSPLINE3), Some(&CUBIC)),
            Interpolation::Bspline5 => (AnyKernel::Six(BSPLINE5), Some(&QUINTIC)),
        };
        let coefficients = if weights.len() == 1 && prefilter.is_none() {
            Coefficients::samples(view, memory)
        } else {
            Coefficients::filtered(view, &LineFilter { weights, prefilter }, memory)
        };
        Self { kind, kernel, width: view.width(), height: view.height(), coefficients }
    }

    /// Number of columns of the image.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows of the image.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The interpolation it was prepared for.
    #[must_use]
    pub fn kind(&self) -> Interpolation {
        self.kind
    }

    /// Whether the point, in pixels, lies in the extent of the pixels. A NaN does not.
    #[inline]
    #[must_use]
    pub fn contains(&self, u: f64, v: f64) -> bool {
        u >= -0.5 && u <= self.width as f64 - 0.5 && v >= -0.5 && v <= self.height as f64 - 0.5
    }

    /// Grey level at each point `(u[i], v[i])`, in pixels; NaN where the image does not [contain](Self::contains) it.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values(&self, u: &[f64], v: &[f64], out: &mut [f32]) {
        self.read(Points::Absolute(u, v), [out]);
    }

    /// Grey level at each point, and its derivatives along the columns `u` and the rows `v`, per pixel: those of the
    /// interpolant itself. NaN where the image does not [contain](Self::contains) the point.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_and_gradients(&self, u: &[f64], v: &[f64], value: &mut [f32], du: &mut [f32], dv: &mut [f32]) {
        self.read(Points::Absolute(u, v), [value, du, dv]);
    }

    /// Grey level at each point, given by its distance `(u[i], v[i])` in pixels from the pixel `origin`: for points close
    /// together, single precision is then enough however large the image. NaN where the image does not
    /// [contain](Self::contains) the point.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_near(&self, origin: [isize; 2], u: &[f32], v: &[f32], out: &mut [f32]) {
        self.read(Points::Near(origin, u, v), [out]);
    }

    /// Grey level and derivatives at each point given as in [`values_near`](Self::values_near).
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_and_gradients_near(
        &self,
        origin: [isize; 2],
        u: &[f32],
        v: &[f32],
        value: &mut [f32],
        du: &mut [f32],
        dv: &mut [f32],
    ) {
        self.read(Points::Near(origin, u, v), [value, du, dv]);
    }

    /// Asks the memory for what points between the pixel coordinates `low` and `high` will need when they are read. It changes
    /// no result: what nobody asked for in time is waited for.
    pub fn prefetch(&self, low: [f64; 2], high: [f64; 2]) {
        let range = |c: usize| {
            // Casts saturate, and a NaN is zero.
            let [first, last] = [low[c] as isize, high[c] as isize];
            first.saturating_sub(REACH)..last.saturating_add(REACH + 2)
        };
        self.coefficients.prefetch(range(0), range(1));
    }

    /// Grey levels (one slice), or these and their derivatives (three).
    fn read<const READINGS: usize>(&self, points: Points<'_>, out: [&mut [f32]; READINGS]) {
        let count = points.len();
        assert!(
            count.is_some_and(|count| out.iter().all(|out| out.len() == count)),
            "one u, one v and one of each reading for each point"
        );
        let (coefficients, size) = (&self.coefficients, [self.width, self.height]);
        match &self.kernel {
            AnyKernel::Two(kernel) => read::<1, 2, READINGS>(coefficients, size, kernel, points, out),
            AnyKernel::Four(kernel) => read::<2, 4, READINGS>(coefficients, size, kernel, points, out),
            AnyKernel::Six(kernel) => read::<3, 6, READINGS>(coefficients, size, kernel, points, out),
        }
    }
}

impl fmt::Debug for Interpolator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Interpolator({} x {} {})", self.width, self.height, self.kind)
    }
}
