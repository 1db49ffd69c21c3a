//! A field of two components on a rectangle.

use std::sync::Arc;

use super::basis::BasisFunctions;
use crate::CameraError;

/// A field of two components on a rectangle of normalised image coordinates: a tensor-product cubic B-spline on equal
/// intervals.
///
/// Beyond the rectangle it continues linearly, along `x` and along `y`, with the value and slope of the border.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineField {
    domain: [f64; 4],
    intervals: [usize; 2],
    /// Intervals per unit along each axis.
    density: [f64; 2],
    coefficients: Arc<[[f64; 2]]>,
    slope_bound: f64,
}

impl SplineField {
    /// Creates a field on `domain = [x0, y0, x1, y1]`, divided into `intervals` along `x` and `y`, from `intervals[1] + 3`
    /// rows of `intervals[0] + 3` coefficients, row by row.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the domain is empty, there is no interval, the number of coefficients is wrong or a number is not
    /// finite.
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
        let mut field = Self { domain, intervals, density, coefficients: coefficients.into(), slope_bound: 0.0 };
        field.slope_bound = field.bound_slopes();
        Ok(field)
    }

    /// `[x0, y0, x1, y1]`.
    pub fn domain(&self) -> [f64; 4] {
        self.domain
    }

    /// Intervals along `x` and along `y`.
    pub fn intervals(&self) -> [usize; 2] {
        self.intervals
    }

    /// The coefficients, row by row.
    pub fn coefficients(&self) -> &[[f64; 2]] {
        &self.coefficients
    }

    /// An upper bound of the Frobenius norm of the Jacobian of the field over its rectangle.
    pub fn slope_bound(&self) -> f64 {
        self.slope_bound
    }

    /// Returns `true` if adding the field to the identity gives a map that cannot fold between the origin and a point.
    pub(in crate::lens) fn is_gentle_at(&self, point: [f64; 2]) -> bool {
        self.slope_bound < 1.0 && self.contains(point)
    }

    /// The field on a rectangle larger by some intervals on each side, over which the outermost pieces continue as
    /// polynomials.
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
            slope_bound: 0.0,
        };
        field.slope_bound = field.bound_slopes();
        field
    }

    /// Returns `true` if the rectangle contains a point.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let [x0, y0, x1, y1] = self.domain;
        (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
    }

    /// Value of the field at a point.
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

    /// Value of the field at a point and its Jacobian: row 0 is the derivatives of the first component along `x` and `y`.
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

    /// Adds the basis functions at a point, and their derivatives along `x` and `y`, to three rows in the order of the
    /// coefficients.
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
    fn basis(&self, axis: usize, position: f64) -> BasisFunctions {
        BasisFunctions::new(
            (position - self.domain[axis]) * self.density[axis],
            self.intervals[axis],
            self.density[axis],
        )
    }

    #[inline]
    fn stencil(&self, along: &BasisFunctions, across: &BasisFunctions, row: usize) -> &[[f64; 2]] {
        let start = (across.first + row) * (self.intervals[0] + 3) + along.first;
        &self.coefficients[start..start + 4]
    }

    /// Bounds the slopes: the derivative of a spline is a spline of the differences of its coefficients, and a spline lies in
    /// the convex hull of its coefficients.
    fn bound_slopes(&self) -> f64 {
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

/// Extrapolates a row of coefficients, every `stride`th of a slice, by `by` entries on both sides: the fourth differences
/// of the coefficients of a cubic are zero.
fn extrapolate(coefficients: &mut [[f64; 2]], by: usize, stride: usize) {
    let last = (coefficients.len() - 1) / stride;
    for k in (0..by).rev() {
        for (at, next) in [(k, 1_isize), (last - k, -1)] {
            let [a, b, c, d] = [1, 2, 3, 4].map(|step| coefficients[at.wrapping_add_signed(step * next) * stride]);
            coefficients[at * stride] = [0, 1].map(|i| 4.0 * (a[i] + c[i]) - 6.0 * b[i] - d[i]);
        }
    }
}

pub(super) fn check_domain(domain: [f64; 4]) -> Result<(), CameraError> {
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
