//! Named coefficients of a lens model.

use crate::CameraError;

/// Coefficients that are given together, such as `radial = (k1, k2, k3)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CoefficientGroup {
    /// Name of the group.
    pub name: &'static str,
    /// Names of its coefficients.
    pub coefficients: &'static [&'static str],
}

/// Names of all coefficients in some groups.
pub(super) fn names(groups: &'static [CoefficientGroup]) -> impl Iterator<Item = &'static str> {
    groups.iter().flat_map(|group| group.coefficients).copied()
}

/// Converts the coefficients of a lens model to an array.
///
/// # Errors
///
/// [`CameraError`] if their number is not `N` or one of them is not finite.
pub(super) fn checked<const N: usize>(
    model: &'static str,
    groups: &'static [CoefficientGroup],
    coefficients: &[f64],
) -> Result<[f64; N], CameraError> {
    let array: [f64; N] = coefficients.try_into().map_err(|_| CameraError::CoefficientCount {
        model,
        expected: N,
        got: coefficients.len(),
    })?;
    match names(groups).zip(array).find(|(_, coefficient)| !coefficient.is_finite()) {
        Some((parameter, _)) => Err(CameraError::NonFinite { parameter }),
        None => Ok(array),
    }
}
