//! The non-parametric lens that gives the correction of the distortion (paper, Fig. 13).

use super::newton::solve;
use super::{Sample, SplineField, approximation};
use crate::{CameraError, Distortion};

/// A lens whose distorted point `x_d` comes from the retinal point `x_d + C(x_d)`, with `C` a tensor-product cubic B-spline.
///
/// Taking a pixel back to the retinal plane needs no iteration; showing a point does, by Newton's method. Beyond the domain it was calibrated in it goes on linearly and is known no
/// more.
#[derive(Debug, Clone, PartialEq)]
pub struct InverseSplineDistortion {
    field: SplineField,
}

impl InverseSplineDistortion {
    /// The lens of this correction, a field on the distorted retinal plane.
    pub fn new(field: SplineField) -> Self {
        Self { field }
    }

    /// The lens nearest to another over `domain = [x0, y0, x1, y1]` of the distorted retinal plane: its intervals are halved until
    /// the corrections differ by at most `tolerance`, a length on the retinal plane (times the focal length: in pixels).
    ///
    /// # Errors
    ///
    /// [`CameraError`] where the domain is empty, the lens does not reach all of it or cannot be followed so closely.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, InverseSplineDistortion};
    /// let brown = BrownDistortion::new([-0.2, 0.05, 0.0], [1e-3, 0.0], [0.0; 2])?.into();
    /// let spline = InverseSplineDistortion::approximating(&brown, [-0.3, -0.2, 0.3, 0.2], 1e-8)?;
    /// let ([x, y], [u, v]) = (spline.distort([0.21, -0.07]), brown.distort([0.21, -0.07]));
    /// assert!((x - u).hypot(y - v) < 1e-8);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn approximating(lens: &Distortion, domain: [f64; 4], tolerance: f64) -> Result<Self, CameraError> {
        let extended = lens.extended();
        let correction = |[x, y]: [f64; 2]| {
            let [u, v] = extended.undistort([x, y])?;
            Some(Sample { value: [u - x, v - y], covered: lens.covers([u, v]) })
        };
        approximation(domain, tolerance, correction).map(Self::new)
    }

    /// The correction `C`.
    pub fn field(&self) -> &SplineField {
        &self.field
    }

    /// The retinal point that the lens shows at `(x, y)`.
    #[inline]
    pub fn undistort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.field.value([x, y]);
        [x + dx, y + dy]
    }

    /// Where the lens shows the retinal point `(x, y)`, by Newton's method; NaN where that does not converge.
    #[inline]
    pub fn distort(&self, point: [f64; 2]) -> [f64; 2] {
        self.distort_with_jacobian(point).0
    }

    /// [`distort`](Self::distort) and its derivatives: row 0 is `(dx_d/dx, dx_d/dy)`.
    #[inline]
    pub fn distort_with_jacobian(&self, point: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        solve(point, point, |at| self.undistort_with_jacobian(at)).unwrap_or(([f64::NAN; 2], [[f64::NAN; 2]; 2]))
    }

    #[inline]
    pub(super) fn undistort_with_jacobian(&self, [x, y]: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let ([dx, dy], [[xx, xy], [yx, yy]]) = self.field.value_with_jacobian([x, y]);
        ([x + dx, y + dy], [[1.0 + xx, xy], [yx, 1.0 + yy]])
    }
}
