//! Fields on the retinal plane: tensor-product cubic B-splines.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::CameraError;

/// Samples per interval of a field that is approximated.
const SAMPLES: usize = 4;

/// A field of two components on a rectangle of the retinal plane: a tensor-product cubic B-spline on equal intervals.
///
/// Beyond the rectangle it goes on linearly, along `x` and along `y`, with the value and slope of the border.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineField {
    domain: [f64; 4],
    intervals: [usize; 2],
    /// Intervals per unit along each axis.
    density: [f64; 2],
    coefficients: Arc<[[f64; 2]]>,
    steepest: f64,
}

/// The four basis functions of one axis that are not zero at a point.
struct Basis {
    first: usize,
    values: [f64; 4],
    slopes: [f64; 4],
}

impl SplineField {
    /// The field on `domain = [x0, y0, x1, y1]` cut into `intervals` along `x` and `y`, with `intervals[0] + 3` coefficients
    /// per row and `intervals[1] + 3` rows, row after row.
    ///
    /// # Errors
    ///
    /// [`CameraError`] where the domain is empty, there is no interval, the number of coefficients is another, or a number
    /// is not finite.
    pub fn new(domain: [f64; 4], intervals: [usize; 2], coefficients: Vec<[f64; 2]>) -> Result<Self, CameraError> {
        check_domain(domain)?;
        let shape = intervals.map(|count| count + 3);
        if intervals.contains(&0) || shape[0].checked_mul(shape[1]) != Some(coefficients.len()) {
            return Err(CameraError::SplineShape { intervals, got: coefficients.len() });
        }
        if !coefficients.as_flattened().iter().all(|c| c.is_finite()) {
            return Err(CameraError::NonFinite { parameter: "spline coefficients" });
        }
        let density = [0, 1].map(|axis| intervals[axis] as f64 / (domain[axis + 2] - domain[axis]));
        let mut field = Self { domain, intervals, density, coefficients: coefficients.into(), steepest: 0.0 };
        field.steepest = field.bound_of_slopes();
        Ok(field)
    }

    /// The field nearest to a function, by least squares over a grid of four points per interval, or `None` where the
    /// function has no value.
    ///
    /// # Errors
    ///
    /// [`CameraError`] where the domain is empty, there is no interval, or a value is not finite.
    pub fn approximating(
        domain: [f64; 4],
        intervals: [usize; 2],
        function: impl Fn([f64; 2]) -> Option<[f64; 2]>,
    ) -> Result<Option<Self>, CameraError> {
        check_domain(domain)?;
        let axis = |axis: usize| Sampling::new(domain[axis], domain[axis + 2], intervals[axis]);
        let (Some(along), Some(across)) = (axis(0), axis(1)) else {
            return Err(CameraError::SplineShape { intervals, got: 0 });
        };
        let mut samples = [(); 2].map(|()| DMatrix::zeros(across.places.len(), along.places.len()));
        for (row, &y) in across.places.iter().enumerate() {
            for (column, &x) in along.places.iter().enumerate() {
                let Some(value) = function([x, y]) else { return Ok(None) };
                samples.iter_mut().zip(value).for_each(|(samples, value)| samples[(row, column)] = value);
            }
        }
        let [x, y] = samples.map(|samples| &across.projection * samples * along.projection.transpose());
        let coefficients = x.transpose().iter().zip(y.transpose().iter()).map(|(&x, &y)| [x, y]).collect();
        Self::new(domain, intervals, coefficients).map(Some)
    }

    /// `[x0, y0, x1, y1]`.
    pub fn domain(&self) -> [f64; 4] {
        self.domain
    }

    /// Intervals along `x` and along `y`.
    pub fn intervals(&self) -> [usize; 2] {
        self.intervals
    }

    /// The coefficients, row after row.
    pub fn coefficients(&self) -> &[[f64; 2]] {
        &self.coefficients
    }

    /// A bound of the slopes of the field over its rectangle, in the Frobenius norm of its Jacobian.
    pub fn steepest(&self) -> f64 {
        self.steepest
    }

    /// The same field on a rectangle larger by some intervals on each side, over which the outermost pieces go on as the
    /// polynomials they are.
    #[must_use]
    pub fn extended(&self, by: usize) -> Self {
        let [x0, y0, x1, y1] = self.domain;
        let [dx, dy] = self.density.map(|density| by as f64 / density);
        let [nx, ny] = self.intervals;
        let [width, height] = [nx + 3 + 2 * by, ny + 3 + 2 * by];
        let mut coefficients = vec![[0.0; 2]; width * height];
        for (row, given) in self.coefficients.chunks_exact(nx + 3).enumerate() {
            let start = (row + by) * width;
            coefficients[start + by..start + by + nx + 3].copy_from_slice(given);
            extrapolate(&mut coefficients[start..start + width], by, 1);
        }
        for column in 0..width {
            extrapolate(&mut coefficients[column..], by, width);
        }
        let mut field = Self {
            domain: [x0 - dx, y0 - dy, x1 + dx, y1 + dy],
            intervals: [nx + 2 * by, ny + 2 * by],
            density: self.density,
            coefficients: coefficients.into(),
            steepest: 0.0,
        };
        field.steepest = field.bound_of_slopes();
        field
    }

    /// Whether a point lies in the rectangle.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let [x0, y0, x1, y1] = self.domain;
        (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
    }

    /// The field at a point.
    #[inline]
    pub fn value(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (along, across) = (self.basis(0, x), self.basis(1, y));
        let mut sum = [0.0; 2];
        for (row, wy) in across.values.into_iter().enumerate() {
            let mut value = [0.0; 2];
            for (c, wx) in self.stencil(&along, &across, row).iter().zip(along.values) {
                value[0] += wx * c[0];
                value[1] += wx * c[1];
            }
            sum[0] += wy * value[0];
            sum[1] += wy * value[1];
        }
        sum
    }

    /// The field at a point and its Jacobian: row 0 is the derivatives of the first component by `x` and `y`.
    #[inline]
    pub fn value_with_jacobian(&self, [x, y]: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let (along, across) = (self.basis(0, x), self.basis(1, y));
        let (mut sum, mut by_x, mut by_y) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for row in 0..4 {
            let (mut value, mut slope) = ([0.0; 2], [0.0; 2]);
            for (i, c) in self.stencil(&along, &across, row).iter().enumerate() {
                for k in 0..2 {
                    value[k] += along.values[i] * c[k];
                    slope[k] += along.slopes[i] * c[k];
                }
            }
            for k in 0..2 {
                sum[k] += across.values[row] * value[k];
                by_x[k] += across.values[row] * slope[k];
                by_y[k] += across.slopes[row] * value[k];
            }
        }
        (sum, [[by_x[0], by_y[0]], [by_x[1], by_y[1]]])
    }

    /// What each coefficient counts for at a point, in the value and in its slopes along `x` and `y`: the products of the basis
    /// functions, added to three rows in the order of the coefficients.
    ///
    /// # Panics
    ///
    /// If a row does not have one entry per coefficient.
    pub fn add_basis(&self, [x, y]: [f64; 2], [value, by_x, by_y]: [&mut [f64]; 3]) {
        let (along, across) = (self.basis(0, x), self.basis(1, y));
        for j in 0..4 {
            let start = (across.first + j) * (self.intervals[0] + 3) + along.first;
            for i in 0..4 {
                value[start + i] += along.values[i] * across.values[j];
                by_x[start + i] += along.slopes[i] * across.values[j];
                by_y[start + i] += along.values[i] * across.slopes[j];
            }
        }
    }

    #[inline]
    fn basis(&self, axis: usize, place: f64) -> Basis {
        Basis::new((place - self.domain[axis]) * self.density[axis], self.intervals[axis], self.density[axis])
    }

    #[inline]
    fn stencil(&self, along: &Basis, across: &Basis, row: usize) -> &[[f64; 2]] {
        let start = (across.first + row) * (self.intervals[0] + 3) + along.first;
        &self.coefficients[start..start + 4]
    }

    /// The slope of a spline is a spline of the differences of its coefficients, and a spline lies within its coefficients.
    fn bound_of_slopes(&self) -> f64 {
        let width = self.intervals[0] + 3;
        let largest = |offset: usize, density: f64, ends_row: bool| {
            let pairs = self.coefficients.iter().zip(&self.coefficients[offset..]).enumerate();
            let within = pairs.filter(|(index, _)| !(ends_row && (index + 1) % width == 0));
            within.fold([0.0_f64; 2], |largest, (_, (a, b))| {
                [0, 1].map(|k| largest[k].max((b[k] - a[k]).abs() * density))
            })
        };
        let ([xx, yx], [xy, yy]) = (largest(1, self.density[0], true), largest(width, self.density[1], false));
        xx.hypot(yx).hypot(xy.hypot(yy))
    }
}

impl Basis {
    /// At `t` intervals from the start of the axis; beyond its ends each function goes on linearly.
    #[inline]
    fn new(t: f64, intervals: usize, density: f64) -> Self {
        const SIXTH: f64 = 1.0 / 6.0;
        let first = (t as usize).min(intervals - 1);
        let s = t - first as f64;
        let inside = s.clamp(0.0, 1.0);
        let r = 1.0 - inside;
        let slopes = [-0.5 * r * r, inside * (1.5 * inside - 2.0), r * (2.0 - 1.5 * r), 0.5 * inside * inside];
        let mut values = [
            SIXTH * r * r * r,
            inside * inside * (0.5 * inside - 1.0) + 2.0 / 3.0,
            r * r * (0.5 * r - 1.0) + 2.0 / 3.0,
            SIXTH * inside * inside * inside,
        ];
        for (value, slope) in values.iter_mut().zip(slopes) {
            *value += slope * (s - inside);
        }
        Self { first, values, slopes: slopes.map(|slope| slope * density) }
    }
}

/// Continues a row of coefficients, every `stride`th of a slice, by `by` on both sides: those of a cubic have no fourth
/// difference.
fn extrapolate(coefficients: &mut [[f64; 2]], by: usize, stride: usize) {
    let last = (coefficients.len() - 1) / stride;
    for k in (0..by).rev() {
        for (at, next) in [(k, 1_isize), (last - k, -1)] {
            let [a, b, c, d] = [1, 2, 3, 4].map(|step| coefficients[at.wrapping_add_signed(step * next) * stride]);
            coefficients[at * stride] = [0, 1].map(|i| 4.0 * (a[i] + c[i]) - 6.0 * b[i] - d[i]);
        }
    }
}

/// The places of one axis where a function is sampled, and the matrix that takes samples to coefficients.
struct Sampling {
    places: Vec<f64>,
    projection: DMatrix<f64>,
}

impl Sampling {
    /// `None` where there is no interval.
    fn new(start: f64, end: f64, intervals: usize) -> Option<Self> {
        let last = SAMPLES * intervals;
        let mut basis = DMatrix::zeros(last + 1, intervals + 3);
        let mut places = Vec::with_capacity(last + 1);
        for row in 0..if intervals > 0 { last + 1 } else { 0 } {
            places.push(start + (end - start) * row as f64 / last as f64);
            let at = Basis::new(row as f64 / SAMPLES as f64, intervals, 1.0);
            at.values.into_iter().enumerate().for_each(|(i, value)| basis[(row, at.first + i)] = value);
        }
        let projection = (basis.transpose() * &basis).cholesky()?.solve(&basis.transpose());
        Some(Self { places, projection })
    }
}

fn check_domain(domain: [f64; 4]) -> Result<(), CameraError> {
    let [x0, y0, x1, y1] = domain;
    if !domain.iter().all(|c| c.is_finite()) {
        return Err(CameraError::NonFinite { parameter: "spline domain" });
    }
    let sides = [x1 - x0, y1 - y0];
    if !sides.iter().all(|side| *side > 0.0 && (1e3 / side).is_finite()) {
        Err(CameraError::EmptyDomain { domain })
    } else {
        Ok(())
    }
}
