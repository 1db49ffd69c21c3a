//! The interface of all lens models.

use std::fmt::Debug;

use super::coefficients::{CoefficientGroup, checked};
use super::domain::{Domain, Plane};
use super::fold::folds_between;
use super::spline_field::SplineField;
use crate::CameraError;
use crate::newton::{Jacobian2, Root, Verdict, solve};

/// Residual below which one more Newton step leaves rounding errors only, relative to one plus the largest coordinate.
const NEARLY_SOLVED: f64 = 1e-8;

/// A lens model: a map of the plane of normalised image coordinates `(x, y)` to distorted ones.
///
/// A new model needs [`MODEL`](Self::MODEL), [`distort`](Self::distort),
/// [`distort_with_jacobian`](Self::distort_with_jacobian), and the methods of its coefficients if it has any.
pub trait Lens: Debug + Clone + PartialEq + Send + Sync {
    /// Name of the model in camera files and calibrations, such as `brown`.
    const MODEL: &'static str;

    /// The coefficients by groups, in the order of [`coefficients`](Self::coefficients); none for a lens made of a field.
    const GROUPS: &'static [CoefficientGroup] = &[];

    /// Distorted point of `point`; NaN if it does not exist.
    fn distort(&self, point: [f64; 2]) -> [f64; 2];

    /// [`distort`](Self::distort) and its derivatives: row 0 is `(dx_d/dx, dx_d/dy)`.
    fn distort_with_jacobian(&self, point: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]);

    /// Point whose distorted point is `distorted`; `None` if there is none, or only beyond a fold of the model.
    fn undistort(&self, distorted: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.distort(distorted);
        let start = [2.0 * distorted[0] - x, 2.0 * distorted[1] - y];
        let Root { point, .. } = invert_map(distorted, start, |at| self.distort_with_jacobian(at))?;
        (!self.folds_within(point)).then_some(point)
    }

    /// Returns `true` if the model folds between the optical axis and `point`: the determinant of its Jacobian changes
    /// sign, and distorted points beyond the fold occur twice.
    fn folds_within(&self, point: [f64; 2]) -> bool {
        folds_between(point, |at| self.distort_with_jacobian(at).1)
    }

    /// Region in which the lens is calibrated; `None` for the whole plane.
    fn domain(&self) -> Option<Domain> {
        None
    }

    /// Bounding box `[x0, y0, x1, y1]` of the domain in the given plane.
    ///
    /// # Errors
    ///
    /// [`CameraError::NoDomain`] if the lens is not limited to a domain; [`CameraError::LensOutOfReach`] if it folds at
    /// the border of its domain.
    fn bounding_box(&self, plane: Plane) -> Result<[f64; 4], CameraError> {
        let domain = self.domain().ok_or(CameraError::NoDomain { model: Self::MODEL })?;
        let bounds = match (domain.plane, plane) {
            (Plane::Undistorted, Plane::Distorted) => domain.bounding_box_of(|point| Some(self.distort(point))),
            (Plane::Distorted, Plane::Undistorted) => domain.bounding_box_of(|point| self.undistort(point)),
            _ => Some(domain.rectangle),
        };
        bounds.ok_or(CameraError::LensOutOfReach { domain: domain.rectangle })
    }

    /// Returns `true` if the lens is calibrated at `point`.
    fn covers(&self, point: [f64; 2]) -> bool {
        self.domain().is_none_or(|domain| domain.contains(point, |at| self.distort(at)))
    }

    /// Returns `true` if the lens is a piecewise polynomial, whose third derivatives jump between the pieces.
    fn is_piecewise(&self) -> bool {
        self.field().is_some()
    }

    /// The field of a lens that is made of one.
    fn field(&self) -> Option<&SplineField> {
        None
    }

    /// The lens with a domain somewhat larger than its own, over which it is smooth. Another lens can approximate this
    /// one up to the border of its domain; the lens itself has a kink there.
    #[must_use]
    fn extended(&self) -> Self {
        self.clone()
    }

    /// Values of the coefficients.
    fn coefficients(&self) -> &[f64] {
        &[]
    }

    /// The lens with other values of its coefficients.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the number of coefficients is wrong or one of them is not finite.
    fn with_coefficients(&self, coefficients: &[f64]) -> Result<Self, CameraError> {
        checked(Self::MODEL, Self::GROUPS, coefficients).map(|[]| self.clone())
    }

    /// Derivative of [`distort`](Self::distort) at `point` with respect to a coefficient, by its index; NaN if there is
    /// no such coefficient.
    fn coefficient_derivative(&self, _point: [f64; 2], _index: usize) -> [f64; 2] {
        [f64::NAN; 2]
    }
}

/// Solves `map(x) = target` by Newton's method, to rounding errors.
#[inline]
pub(super) fn invert_map(
    target: [f64; 2],
    start: [f64; 2],
    map: impl Fn([f64; 2]) -> ([f64; 2], Jacobian2),
) -> Option<Root> {
    let size = 1.0 + target[0].abs().max(target[1].abs());
    solve(target, start, map, |error| match error {
        _ if !error.is_finite() => Verdict::Fail,
        _ if error <= NEARLY_SOLVED * size => Verdict::Finish,
        _ => Verdict::Iterate,
    })
}
