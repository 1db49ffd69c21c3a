//! Folds of a lens model.

use crate::newton::Jacobian2;

/// Points between the optical axis and the given point at which the Jacobian is evaluated.
const FOLD_SAMPLES: u32 = 32;

/// Returns `true` if the determinant of a Jacobian is not positive somewhere between the optical axis and `end`.
pub(super) fn folds_between(end: [f64; 2], jacobian: impl Fn([f64; 2]) -> Jacobian2) -> bool {
    (1..=FOLD_SAMPLES).any(|k| {
        let [[xx, xy], [yx, yy]] = jacobian(end.map(|c| c * f64::from(k) / f64::from(FOLD_SAMPLES)));
        xx * yy - xy * yx <= 0.0
    })
}
