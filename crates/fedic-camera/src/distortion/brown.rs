//! The lens of few coefficients (paper, Fig. 11).

use crate::CameraError;

/// Brown's model: radial, decentering and prismatic distortion (paper, eq. 27-30).
///
/// With `r2 = x^2 + y^2` a retinal point `(x, y)` is seen at
///
/// ```text
/// x + x (k1 r2 + k2 r2^2 + k3 r2^3) + 2 d1 x y + d2 (r2 + 2 x^2) + p1 r2
/// y + y (k1 r2 + k2 r2^2 + k3 r2^3) + d1 (r2 + 2 y^2) + 2 d2 x y + p2 r2
/// ```
///
/// In OpenCV's names `d1 = p1`, `d2 = p2`, `p1 = s1`, `p2 = s3`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BrownDistortion {
    radial: [f64; 3],
    decentering: [f64; 2],
    prism: [f64; 2],
}

impl BrownDistortion {
    /// The lens with these coefficients, all without unit.
    ///
    /// # Errors
    ///
    /// [`CameraError::NonFinite`] where a coefficient is not finite.
    pub fn new(radial: [f64; 3], decentering: [f64; 2], prism: [f64; 2]) -> Result<Self, CameraError> {
        for (parameter, values) in
            [("radial distortion", &radial[..]), ("decentering", &decentering[..]), ("prism", &prism[..])]
        {
            if !values.iter().all(|c| c.is_finite()) {
                return Err(CameraError::NonFinite { parameter });
            }
        }
        Ok(Self { radial, decentering, prism })
    }

    /// Radial coefficients `k1, k2, k3`.
    pub fn radial(&self) -> [f64; 3] {
        self.radial
    }

    /// Decentering coefficients `d1, d2`.
    pub fn decentering(&self) -> [f64; 2] {
        self.decentering
    }

    /// Prismatic coefficients `p1, p2`.
    pub fn prism(&self) -> [f64; 2] {
        self.prism
    }

    /// Where the lens shows the retinal point `(x, y)`.
    #[inline]
    pub fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([k1, k2, k3], [d1, d2], [p1, p2]) = (self.radial, self.decentering, self.prism);
        let (r2, xy) = (x * x + y * y, x * y);
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        [
            x * radial + 2.0 * d1 * xy + d2 * (r2 + 2.0 * x * x) + p1 * r2,
            y * radial + d1 * (r2 + 2.0 * y * y) + 2.0 * d2 * xy + p2 * r2,
        ]
    }

    /// Derivatives of [`distort`](Self::distort): row 0 is `(dx_d/dx, dx_d/dy)`.
    #[inline]
    pub fn jacobian(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let ([k1, k2, k3], [d1, d2], [p1, p2]) = (self.radial, self.decentering, self.prism);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
        let cross = slope * x * y + 2.0 * (d1 * x + d2 * y);
        [
            [radial + slope * x * x + 2.0 * d1 * y + 6.0 * d2 * x + 2.0 * p1 * x, cross + 2.0 * p1 * y],
            [cross + 2.0 * p2 * x, radial + slope * y * y + 6.0 * d1 * y + 2.0 * d2 * x + 2.0 * p2 * y],
        ]
    }

    /// Whether the coefficients are so small that the model cannot fold between the optical axis and `(x, y)`.
    pub(super) fn is_gentle_within(&self, [x, y]: [f64; 2]) -> bool {
        let r = x.hypot(y);
        let r2 = r * r;
        // Bounds the Jacobian's distance from the identity on the way, in the spectral norm.
        let [k1, k2, k3] = self.radial.map(f64::abs);
        let [d1, d2] = self.decentering.map(f64::abs);
        let radial = r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3));
        radial + r * (7.0 * (d1 + d2) + 2.0 * self.prism[0].hypot(self.prism[1])) < 1.0
    }
}
