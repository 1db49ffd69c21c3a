//! Grey levels and gradients between pixels, for many points at once.

use std::fmt;

use fedic_memory::AlignedBuffer;

use crate::error::ImageError;
use crate::filter::gaussian::gaussian_weights;
use crate::filter::line::LineFilter;
use crate::interpolation::coefficients::Coefficients;
use crate::interpolation::derivatives::evaluate_derivatives;
use crate::interpolation::evaluate::{Points, evaluate};
use crate::interpolation::kernel::AnyKernel;
use crate::interpolation::method::Interpolation;
use crate::view::ImageView;

/// Pixels prefetched beyond the nearest on either side, as the stencils of four taps need.
const PREFETCH_MARGIN: isize = 1;

/// An image prepared for evaluation between its pixels.
///
/// Its domain is the extent of the pixels, `[-0.5, width - 0.5] x [-0.5, height - 0.5]`; outside it, values and gradients
/// are NaN. Preparation runs in the current rayon pool; evaluation is sequential and may be called from many threads.
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
    interpolation: Interpolation,
    width: usize,
    height: usize,
    coefficients: Coefficients,
}

impl Interpolator {
    /// Prepares an image.
    #[must_use]
    pub fn new(view: ImageView<'_>, interpolation: Interpolation) -> Self {
        Self::with_weights(view, interpolation, &[1.0], AlignedBuffer::default())
    }

    /// Prepares an image smoothed by a Gaussian filter of standard deviation `smoothing`, in pixels, without storing the
    /// smoothed image that [`gaussian_filter`](crate::gaussian_filter) returns.
    ///
    /// # Errors
    ///
    /// [`ImageError::InvalidSmoothing`] if `smoothing` is negative, NaN, or larger than the image.
    pub fn smoothed(view: ImageView<'_>, interpolation: Interpolation, smoothing: f64) -> Result<Self, ImageError> {
        let weights = gaussian_weights(view, smoothing)?;
        Ok(Self::with_weights(view, interpolation, &weights, AlignedBuffer::default()))
    }

    /// Prepares another image as [`smoothed`](Self::smoothed) does, in the memory of this one.
    ///
    /// # Errors
    ///
    /// Those of [`smoothed`](Self::smoothed).
    pub fn renewed(self, view: ImageView<'_>, smoothing: f64) -> Result<Self, ImageError> {
        let weights = gaussian_weights(view, smoothing)?;
        Ok(Self::with_weights(view, self.interpolation, &weights, self.coefficients.into_memory()))
    }

    /// Prepares an image smoothed by a symmetric filter of these weights.
    fn with_weights(
        view: ImageView<'_>,
        interpolation: Interpolation,
        weights: &[f32],
        memory: AlignedBuffer<f32>,
    ) -> Self {
        let filter = LineFilter { weights, poles: interpolation.method().poles };
        let coefficients = Coefficients::new(view, &filter, memory);
        Self { interpolation, width: view.width(), height: view.height(), coefficients }
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

    /// The interpolation the image was prepared for.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// True if the point, in pixels, lies in the extent of the pixels; false for NaN.
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
        self.evaluate(Points::Absolute(u, v), [out]);
    }

    /// Grey level at each point and the derivatives of the interpolant along the columns `u` and the rows `v`, per pixel. NaN where the image does not [contain](Self::contains) the point.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_and_gradients(&self, u: &[f64], v: &[f64], value: &mut [f32], du: &mut [f32], dv: &mut [f32]) {
        self.evaluate(Points::Absolute(u, v), [value, du, dv]);
    }

    /// Grey level at each point, given by its distance `(u[i], v[i])` in pixels from the pixel `origin`; NaN where the image
    /// does not [contain](Self::contains) the point. For points close to each other, single precision is enough in images
    /// of any size.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_near(&self, origin: [isize; 2], u: &[f32], v: &[f32], out: &mut [f32]) {
        self.evaluate(Points::Near(origin, u, v), [out]);
    }

    /// [`values_and_gradients`](Self::values_and_gradients) at points given as in [`values_near`](Self::values_near).
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
        self.evaluate(Points::Near(origin, u, v), [value, du, dv]);
    }

    /// Second derivatives of the interpolant at each point `(u[i], v[i])`: twice along the columns, along both, and twice along the
    /// rows. NaN where the image does not [contain](Self::contains) the point.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn second_derivatives(&self, u: &[f64], v: &[f64], out: [&mut [f32]; 3]) {
        self.evaluate_derivatives([u, v], [[2, 0], [1, 1], [0, 2]], out);
    }

    /// Fourth derivatives of the interpolant at each point `(u[i], v[i])`: four, three, two, one and no times along the columns, the
    /// other times along the rows. NaN where the image does not [contain](Self::contains) the point.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn fourth_derivatives(&self, u: &[f64], v: &[f64], out: [&mut [f32]; 5]) {
        self.evaluate_derivatives([u, v], [[4, 0], [3, 1], [2, 2], [1, 3], [0, 4]], out);
    }

    fn evaluate_derivatives<const OUTPUTS: usize>(
        &self,
        points: [&[f64]; 2],
        orders: [[usize; 2]; OUTPUTS],
        out: [&mut [f32]; OUTPUTS],
    ) {
        let [u, v] = points;
        assert!(
            u.len() == v.len() && out.iter().all(|out| out.len() == u.len()),
            "u, v and each output must have one element per point"
        );
        let (coefficients, size) = (&self.coefficients, [self.width, self.height]);
        match &self.interpolation.method().kernel {
            AnyKernel::Two(kernel) => evaluate_derivatives(coefficients, size, kernel, points, orders, out),
            AnyKernel::Four(kernel) => evaluate_derivatives(coefficients, size, kernel, points, orders, out),
            AnyKernel::Six(kernel) => evaluate_derivatives(coefficients, size, kernel, points, orders, out),
        }
    }

    /// Prefetches the coefficients that points between the pixel coordinates `low` and `high` need. A hint only: results do
    /// not change.
    pub fn prefetch(&self, low: [f64; 2], high: [f64; 2]) {
        let range = |c: usize| {
            // Casts saturate, and a NaN is zero.
            let [first, last] = [low[c] as isize, high[c] as isize];
            first.saturating_sub(PREFETCH_MARGIN)..last.saturating_add(PREFETCH_MARGIN + 2)
        };
        self.coefficients.prefetch(range(0), range(1));
    }

    /// Grey levels (one output), or these and their derivatives (three).
    fn evaluate<const OUTPUTS: usize>(&self, points: Points<'_>, out: [&mut [f32]; OUTPUTS]) {
        let count = points.len();
        assert!(
            count.is_some_and(|count| out.iter().all(|out| out.len() == count)),
            "u, v and each output must have one element per point"
        );
        let (coefficients, size) = (&self.coefficients, [self.width, self.height]);
        match &self.interpolation.method().kernel {
            AnyKernel::Two(kernel) => evaluate::<1, 2, OUTPUTS>(coefficients, size, kernel, points, out),
            AnyKernel::Four(kernel) => evaluate::<2, 4, OUTPUTS>(coefficients, size, kernel, points, out),
            AnyKernel::Six(kernel) => evaluate::<3, 6, OUTPUTS>(coefficients, size, kernel, points, out),
        }
    }
}

impl fmt::Debug for Interpolator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Interpolator({} x {} {})", self.width, self.height, self.interpolation)
    }
}
