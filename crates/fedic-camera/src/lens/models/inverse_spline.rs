//! The non-parametric lens model of the correction (paper, Fig. 13).

use crate::CameraError;
use crate::lens::approximation::{MARGIN_INTERVALS, Sample, approximate};
use crate::lens::domain::{Domain, Plane};
use crate::lens::fold::folds_between;
use crate::lens::model::{Lens, invert_map};
use crate::lens::spline_field::SplineField;
use crate::newton::{Jacobian2, Root};

/// A lens that corrects the distorted point `x_d` to `x_d + C(x_d)`, with `C` a tensor-product cubic B-spline.
///
/// Undistorting a point needs no iteration; distorting it takes Newton's method. Beyond the domain in which the lens is
/// calibrated it is extrapolated linearly.
#[derive(Debug, Clone, PartialEq)]
pub struct InverseSplineDistortion {
    field: SplineField,
}

impl InverseSplineDistortion {
    /// Creates a lens from its correction, a field on the distorted plane.
    pub fn new(field: SplineField) -> Self {
        Self { field }
    }

    /// Approximates another lens over `domain = [x0, y0, x1, y1]` of the distorted plane. The intervals are halved until
    /// the corrections differ by at most `tolerance`, in normalised image coordinates (times the focal length: in pixels).
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the domain is empty, the lens does not reach all of it or the tolerance cannot be reached.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, InverseSplineDistortion, Lens};
    /// let brown = BrownDistortion::new([-0.2, 0.05, 0.0], [1e-3, 0.0], [0.0; 2])?;
    /// let spline = InverseSplineDistortion::from_lens(&brown, [-0.3, -0.2, 0.3, 0.2], 1e-8)?;
    /// let ([x, y], [u, v]) = (spline.distort([0.21, -0.07]), brown.distort([0.21, -0.07]));
    /// assert!((x - u).hypot(y - v) < 1e-8);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn from_lens(lens: &impl Lens, domain: [f64; 4], tolerance: f64) -> Result<Self, CameraError> {
        let extended = lens.extended();
        let correction = |[x, y]: [f64; 2]| {
            let [u, v] = extended.undistort([x, y])?;
            Some(Sample { value: [u - x, v - y], covered: lens.covers([u, v]) })
        };
        approximate(domain, tolerance, correction).map(Self::new)
    }

    /// Corrects a distorted point, whether or not the model folds before it.
    #[inline]
    fn correct(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.field.value([x, y]);
        [x + dx, y + dy]
    }

    #[inline]
    fn correct_with_jacobian(&self, [x, y]: [f64; 2]) -> ([f64; 2], Jacobian2) {
        let ([dx, dy], [[xx, xy], [yx, yy]]) = self.field.value_with_jacobian([x, y]);
        ([x + dx, y + dy], [[1.0 + xx, xy], [yx, 1.0 + yy]])
    }
}

impl Lens for InverseSplineDistortion {
    const MODEL: &'static str = "inverse-spline";

    #[inline]
    fn distort(&self, point: [f64; 2]) -> [f64; 2] {
        self.distort_with_jacobian(point).0
    }

    #[inline]
    fn distort_with_jacobian(&self, point: [f64; 2]) -> ([f64; 2], Jacobian2) {
        invert_map(point, point, |at| self.correct_with_jacobian(at))
            .map_or(([f64::NAN; 2], [[f64::NAN; 2]; 2]), |Root { point, inverse }| (point, inverse))
    }

    fn undistort(&self, distorted: [f64; 2]) -> Option<[f64; 2]> {
        let point = self.correct(distorted);
        (point.iter().all(|c| c.is_finite()) && !self.folds_within(point)).then_some(point)
    }

    fn folds_within(&self, point: [f64; 2]) -> bool {
        let distorted = self.distort(point);
        !self.field.is_gentle_at(distorted) && folds_between(distorted, |at| self.correct_with_jacobian(at).1)
    }

    fn domain(&self) -> Option<Domain> {
        Some(Domain { rectangle: self.field.domain(), plane: Plane::Distorted })
    }

    fn field(&self) -> Option<&SplineField> {
        Some(&self.field)
    }

    fn extended(&self) -> Self {
        Self::new(self.field.extended(MARGIN_INTERVALS))
    }
}
