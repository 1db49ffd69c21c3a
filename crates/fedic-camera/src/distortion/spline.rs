//! The non-parametric lens that gives the distortion itself (paper, Fig. 12).

use super::{Sample, SplineField, approximation};
use crate::{CameraError, Distortion};

/// A lens that shows the retinal point `x` at `x + S(x)`, with `S` a tensor-product cubic B-spline.
///
/// It can take any smooth shape over the domain it was calibrated in; beyond, it goes on linearly and is known no more.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineDistortion {
    field: SplineField,
}

impl SplineDistortion {
    /// The lens of this displacement, a field on the undistorted retinal plane.
    pub fn new(field: SplineField) -> Self {
        Self { field }
    }

    /// The lens nearest to another over `domain = [x0, y0, x1, y1]` of the undistorted retinal plane: its intervals are halved
    /// until they differ by at most `tolerance`, a length on the retinal plane (times the focal length: in pixels).
    ///
    /// # Errors
    ///
    /// [`CameraError`] where the domain is empty, the lens folds in it or cannot be followed so closely.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, SplineDistortion};
    /// let brown = BrownDistortion::new([-0.2, 0.05, 0.0], [1e-3, 0.0], [0.0; 2])?.into();
    /// let spline = SplineDistortion::approximating(&brown, [-0.3, -0.2, 0.3, 0.2], 1e-8)?;
    /// let ([x, y], [u, v]) = (spline.distort([0.21, -0.07]), brown.distort([0.21, -0.07]));
    /// assert!((x - u).hypot(y - v) < 1e-8);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn approximating(lens: &Distortion, domain: [f64; 4], tolerance: f64) -> Result<Self, CameraError> {
        let extended = lens.extended();
        let displacement = |[x, y]: [f64; 2]| {
            let [u, v] = (!extended.folds_within([x, y])).then(|| extended.distort([x, y]))?;
            Some(Sample { value: [u - x, v - y], covered: lens.covers([x, y]) })
        };
        approximation(domain, tolerance, displacement).map(Self::new)
    }

    /// The displacement `S`.
    pub fn field(&self) -> &SplineField {
        &self.field
    }

    /// Where the lens shows the retinal point `(x, y)`.
    #[inline]
    pub fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.field.value([x, y]);
        [x + dx, y + dy]
    }

    /// [`distort`](Self::distort) and its derivatives: row 0 is `(dx_d/dx, dx_d/dy)`.
    #[inline]
    pub fn distort_with_jacobian(&self, [x, y]: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let ([dx, dy], [[xx, xy], [yx, yy]]) = self.field.value_with_jacobian([x, y]);
        ([x + dx, y + dy], [[1.0 + xx, xy], [yx, 1.0 + yy]])
    }
}
