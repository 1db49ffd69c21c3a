//! Grey levels and gradients between pixels, for many points at once.

use std::fmt;

use crate::axis::{Axis, BLOCK};
use crate::coefficients::Coefficients;
use crate::interpolation::Interpolation;
use crate::kernel::{AnyKernel, BICUBIC, BILINEAR, BSPLINE3, BSPLINE5, Kernel};
use crate::prefilter::{CUBIC, QUINTIC};
use crate::view::ImageView;

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
        let (kernel, coefficients) = match kind {
            Interpolation::Bilinear => (AnyKernel::Two(BILINEAR), Coefficients::samples(view)),
            Interpolation::Bicubic => (AnyKernel::Four(BICUBIC), Coefficients::samples(view)),
            Interpolation::Bspline3 => (AnyKernel::Four(BSPLINE3), Coefficients::bspline(view, &CUBIC)),
            Interpolation::Bspline5 => (AnyKernel::Six(BSPLINE5), Coefficients::bspline(view, &QUINTIC)),
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
        match &self.kernel {
            AnyKernel::Two(kernel) => self.values_by(kernel, u, v, out),
            AnyKernel::Four(kernel) => self.values_by(kernel, u, v, out),
            AnyKernel::Six(kernel) => self.values_by(kernel, u, v, out),
        }
    }

    /// Grey level at each point, and its derivatives along the columns `u` and the rows `v`, per pixel: those of the
    /// interpolant itself. NaN where the image does not [contain](Self::contains) the point.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_and_gradients(&self, u: &[f64], v: &[f64], value: &mut [f32], du: &mut [f32], dv: &mut [f32]) {
        match &self.kernel {
            AnyKernel::Two(kernel) => self.gradients_by(kernel, u, v, value, du, dv),
            AnyKernel::Four(kernel) => self.gradients_by(kernel, u, v, value, du, dv),
            AnyKernel::Six(kernel) => self.gradients_by(kernel, u, v, value, du, dv),
        }
    }

    fn values_by<const TAPS: usize, const TERMS: usize>(
        &self,
        kernel: &Kernel<TAPS, TERMS>,
        u: &[f64],
        v: &[f64],
        out: &mut [f32],
    ) {
        assert!(u.len() == v.len() && u.len() == out.len(), "one u, one v and one value for each point");
        let (mut columns, mut rows) = (Axis::new(), Axis::new());
        let mut terms = [[0.0; TAPS]; BLOCK];
        for ((u, v), out) in u.chunks(BLOCK).zip(v.chunks(BLOCK)).zip(out.chunks_mut(BLOCK)) {
            columns.locate(kernel, u, self.width);
            rows.locate(kernel, v, self.height);
            for i in 0..u.len() {
                let [level] = self.weigh_rows(rows.first[i], columns.first[i], [&rows.weights[i]]);
                multiply(&level, &columns.weights[i], &mut terms[i]);
            }
            add_up(&terms, out);
        }
    }

    fn gradients_by<const TAPS: usize, const TERMS: usize>(
        &self,
        kernel: &Kernel<TAPS, TERMS>,
        u: &[f64],
        v: &[f64],
        value: &mut [f32],
        du: &mut [f32],
        dv: &mut [f32],
    ) {
        let count = u.len();
        assert!(
            [v.len(), value.len(), du.len(), dv.len()] == [count; 4],
            "one u, one v, one value and two derivatives for each point"
        );
        let (mut columns, mut rows) = (Axis::new(), Axis::new());
        let mut terms = [[[0.0; TAPS]; BLOCK]; 3];
        for start in (0..count).step_by(BLOCK) {
            let block = start..count.min(start + BLOCK);
            columns.locate(kernel, &u[block.clone()], self.width);
            columns.differentiate(kernel, block.len());
            rows.locate(kernel, &v[block.clone()], self.height);
            rows.differentiate(kernel, block.len());
            for i in 0..block.len() {
                let weights = [&rows.weights[i], &rows.slopes[i]];
                let [level, slope] = self.weigh_rows(rows.first[i], columns.first[i], weights);
                multiply(&level, &columns.weights[i], &mut terms[0][i]);
                multiply(&level, &columns.slopes[i], &mut terms[1][i]);
                multiply(&slope, &columns.weights[i], &mut terms[2][i]);
            }
            add_up(&terms[0], &mut value[block.clone()]);
            add_up(&terms[1], &mut du[block.clone()]);
            add_up(&terms[2], &mut dv[block]);
        }
    }

    /// The stencil that begins at `row` and `column`, its rows combined with each set of `weights`: `TAPS` columns are left.
    #[inline]
    fn weigh_rows<const TAPS: usize, const SETS: usize>(
        &self,
        row: u32,
        column: u32,
        weights: [&[f32; TAPS]; SETS],
    ) -> [[f32; TAPS]; SETS] {
        let mut lines = [[0.0; TAPS]; SETS];
        let mut offset = row as usize * self.coefficients.stride() + column as usize;
        for tap_v in 0..TAPS {
            let coefficients = &self.coefficients.as_slice()[offset..offset + TAPS];
            for (line, weights) in lines.iter_mut().zip(weights) {
                for tap_u in 0..TAPS {
                    line[tap_u] += weights[tap_v] * coefficients[tap_u];
                }
            }
            offset += self.coefficients.stride();
        }
        lines
    }
}

impl fmt::Debug for Interpolator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Interpolator({} x {} {})", self.width, self.height, self.kind)
    }
}

#[inline]
fn multiply<const TAPS: usize>(line: &[f32; TAPS], weights: &[f32; TAPS], terms: &mut [f32; TAPS]) {
    for tap in 0..TAPS {
        terms[tap] = line[tap] * weights[tap];
    }
}

#[inline]
fn add_up<const TAPS: usize>(terms: &[[f32; TAPS]; BLOCK], out: &mut [f32]) {
    for (terms, out) in terms.iter().zip(out) {
        *out = terms[1..].iter().fold(terms[0], |sum, term| sum + term);
    }
}
