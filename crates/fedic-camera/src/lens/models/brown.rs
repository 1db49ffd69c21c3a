//! Brown's lens model (paper, Fig. 11).

use crate::CameraError;
use crate::lens::coefficients::{CoefficientGroup, checked};
use crate::lens::fold::folds_between;
use crate::lens::model::Lens;
use crate::newton::Jacobian2;

/// Brown's model: radial, decentering and prismatic distortion (paper, eq. 27-30).
///
/// With `r2 = x^2 + y^2`, the point `(x, y)` is distorted to
///
/// ```text
/// x + x (k1 r2 + k2 r2^2 + k3 r2^3) + 2 d1 x y + d2 (r2 + 2 x^2) + p1 r2
/// y + y (k1 r2 + k2 r2^2 + k3 r2^3) + d1 (r2 + 2 y^2) + 2 d2 x y + p2 r2
/// ```
///
/// In OpenCV's names `d1 = p1`, `d2 = p2`, `p1 = s1`, `p2 = s3`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BrownDistortion {
    /// `k1, k2, k3, d1, d2, p1, p2`.
    coefficients: [f64; 7],
}

impl BrownDistortion {
    /// The lens without distortion: all its coefficients are zero.
    pub const UNDISTORTED: Self = Self { coefficients: [0.0; 7] };

    /// Creates a lens from its coefficients, all dimensionless.
    ///
    /// # Errors
    ///
    /// [`CameraError::NonFinite`] if a coefficient is not finite.
    pub fn new(radial: [f64; 3], decentering: [f64; 2], prism: [f64; 2]) -> Result<Self, CameraError> {
        let ([k1, k2, k3], [d1, d2], [p1, p2]) = (radial, decentering, prism);
        Self::default().with_coefficients(&[k1, k2, k3, d1, d2, p1, p2])
    }

    /// Radial coefficients `k1, k2, k3`.
    pub fn radial(&self) -> [f64; 3] {
        let [k1, k2, k3, ..] = self.coefficients;
        [k1, k2, k3]
    }

    /// Decentering coefficients `d1, d2`.
    pub fn decentering(&self) -> [f64; 2] {
        let [.., d1, d2, _, _] = self.coefficients;
        [d1, d2]
    }

    /// Prismatic coefficients `p1, p2`.
    pub fn prism(&self) -> [f64; 2] {
        let [.., p1, p2] = self.coefficients;
        [p1, p2]
    }

    /// Derivatives of the distorted point: row 0 is `(dx_d/dx, dx_d/dy)`.
    #[inline]
    fn jacobian(&self, [x, y]: [f64; 2]) -> Jacobian2 {
        let [k1, k2, k3, d1, d2, p1, p2] = self.coefficients;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
        let cross = slope * x * y + 2.0 * (d1 * x + d2 * y);
        [
            [radial + slope * x * x + 2.0 * d1 * y + 6.0 * d2 * x + 2.0 * p1 * x, cross + 2.0 * p1 * y],
            [cross + 2.0 * p2 * x, radial + slope * y * y + 6.0 * d1 * y + 2.0 * d2 * x + 2.0 * p2 * y],
        ]
    }

    /// Returns `true` if the coefficients are so small that the model cannot fold between the optical axis and `(x, y)`.
    fn is_gentle_within(&self, [x, y]: [f64; 2]) -> bool {
        let r = x.hypot(y);
        let r2 = r * r;
        // A bound of the distance of the Jacobian from the identity on the way, in the spectral norm.
        let [k1, k2, k3, d1, d2, ..] = self.coefficients.map(f64::abs);
        let [p1, p2] = self.prism();
        let radial = r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3));
        radial + r * (7.0 * (d1 + d2) + 2.0 * p1.hypot(p2)) < 1.0
    }
}

impl Lens for BrownDistortion {
    const MODEL: &'static str = "brown";
    const GROUPS: &'static [CoefficientGroup] = &[
        CoefficientGroup { name: "radial", coefficients: &["k1", "k2", "k3"] },
        CoefficientGroup { name: "decentering", coefficients: &["d1", "d2"] },
        CoefficientGroup { name: "prism", coefficients: &["p1", "p2"] },
    ];

    #[inline]
    fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [k1, k2, k3, d1, d2, p1, p2] = self.coefficients;
        let (r2, xy) = (x * x + y * y, x * y);
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        [
            x * radial + 2.0 * d1 * xy + d2 * (r2 + 2.0 * x * x) + p1 * r2,
            y * radial + d1 * (r2 + 2.0 * y * y) + 2.0 * d2 * xy + p2 * r2,
        ]
    }

    #[inline]
    fn distort_with_jacobian(&self, point: [f64; 2]) -> ([f64; 2], Jacobian2) {
        (self.distort(point), self.jacobian(point))
    }

    fn folds_within(&self, point: [f64; 2]) -> bool {
        !self.is_gentle_within(point) && folds_between(point, |at| self.jacobian(at))
    }

    fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    fn with_coefficients(&self, coefficients: &[f64]) -> Result<Self, CameraError> {
        checked(Self::MODEL, Self::GROUPS, coefficients).map(|coefficients| Self { coefficients })
    }

    #[inline]
    fn coefficient_derivative(&self, [x, y]: [f64; 2], index: usize) -> [f64; 2] {
        let (r2, xy) = (x * x + y * y, x * y);
        match index {
            0 => [x * r2, y * r2],
            1 => [x * r2 * r2, y * r2 * r2],
            2 => [x * r2 * r2 * r2, y * r2 * r2 * r2],
            3 => [2.0 * xy, r2 + 2.0 * y * y],
            4 => [r2 + 2.0 * x * x, 2.0 * xy],
            5 => [r2, 0.0],
            6 => [0.0, r2],
            _ => [f64::NAN; 2],
        }
    }
}
