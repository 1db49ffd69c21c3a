//! The non-parametric lens model of the distortion (paper, Fig. 12).

use crate::CameraError;
use crate::lens::approximation::{MARGIN_INTERVALS, Sample, approximate};
use crate::lens::domain::{Domain, Plane};
use crate::lens::fold::folds_between;
use crate::lens::model::Lens;
use crate::lens::spline_field::SplineField;
use crate::newton::Jacobian2;

/// A lens that distorts the point `x` to `x + S(x)`, with `S` a tensor-product cubic B-spline.
///
/// It can take any smooth shape over the domain in which it is calibrated; beyond, it is extrapolated linearly.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineDistortion {
    field: SplineField,
}

impl SplineDistortion {
    /// Creates a lens from its displacement, a field on the undistorted plane.
    pub fn new(field: SplineField) -> Self {
        Self { field }
    }

    /// Approximates another lens over `domain = [x0, y0, x1, y1]` of the undistorted plane. The intervals are halved until
    /// the lenses differ by at most `tolerance`, in normalised image coordinates (times the focal length: in pixels).
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the domain is empty, the lens folds in it or the tolerance cannot be reached.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, Lens, SplineDistortion};
    /// let brown = BrownDistortion::new([-0.2, 0.05, 0.0], [1e-3, 0.0], [0.0; 2])?;
    /// let spline = SplineDistortion::from_lens(&brown, [-0.3, -0.2, 0.3, 0.2], 1e-8)?;
    /// let ([x, y], [u, v]) = (spline.distort([0.21, -0.07]), brown.distort([0.21, -0.07]));
    /// assert!((x - u).hypot(y - v) < 1e-8);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn from_lens(lens: &impl Lens, domain: [f64; 4], tolerance: f64) -> Result<Self, CameraError> {
        let extended = lens.extended();
        let displacement = |[x, y]: [f64; 2]| {
            let [u, v] = (!extended.folds_within([x, y])).then(|| extended.distort([x, y]))?;
            Some(Sample { value: [u - x, v - y], covered: lens.covers([x, y]) })
        };
        approximate(domain, tolerance, displacement).map(Self::new)
    }
}

impl Lens for SplineDistortion {
    const MODEL: &'static str = "spline";

    #[inline]
    fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.field.value([x, y]);
        [x + dx, y + dy]
    }

    #[inline]
    fn distort_with_jacobian(&self, [x, y]: [f64; 2]) -> ([f64; 2], Jacobian2) {
        let ([dx, dy], [[xx, xy], [yx, yy]]) = self.field.value_with_jacobian([x, y]);
        ([x + dx, y + dy], [[1.0 + xx, xy], [yx, 1.0 + yy]])
    }

    fn folds_within(&self, point: [f64; 2]) -> bool {
        !self.field.is_gentle_at(point) && folds_between(point, |at| self.distort_with_jacobian(at).1)
    }

    fn domain(&self) -> Option<Domain> {
        Some(Domain { rectangle: self.field.domain(), plane: Plane::Undistorted })
    }

    fn field(&self) -> Option<&SplineField> {
        Some(&self.field)
    }

    fn extended(&self) -> Self {
        Self::new(self.field.extended(MARGIN_INTERVALS))
    }
}
