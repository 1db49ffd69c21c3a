//! Squared second derivatives on a patch of nodes, from the quadratic polynomial that fits the values there.

use nalgebra::{DMatrix, Dyn, Matrix3, OMatrix, U3};

/// Ridge of the fit, relative to unit coefficients on a patch of unit radius: second derivatives that the nodes hardly determine are
/// taken as small, such as those across a row of cells.
const RIDGE: f64 = 2e-3;
/// Weight of the mean square of what the polynomial does not fit, on a patch of unit radius. Of the order of the second derivatives of
/// such waves; waves of five cells then cost nearly the same in all directions.
const REST: f64 = 25.0;

/// Matrix `R` of the quadratic form `u^T R u` of the values `u` at some points: `area` times the squared second derivatives.
///
/// The fit is a ridge regression on the quadratic monomials, iterated once to keep what the points determine, after the affine part of
/// the values is removed. Affine values therefore cost nothing. With the radius `h` of the patch the form is `area (|D^2 q|^2 + REST /
/// h^4 mean (u - q)^2)`; it vanishes for affine values alone.
pub(super) fn patch_matrix(points: &[[f64; 2]], area: f64) -> DMatrix<f64> {
    let n = points.len();
    let count = n as f64;
    let middle = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let offset = |k: usize| [points[k][0] - middle[0], points[k][1] - middle[1]];
    let radius = ((0..n).map(|k| offset(k)[0].powi(2) + offset(k)[1].powi(2)).sum::<f64>() / count).sqrt();
    let scaled = |k: usize| offset(k).map(|x| x / radius);
    let affine = DMatrix::from_fn(n, 3, |k, j| if j == 0 { 1.0 } else { scaled(k)[j - 1] }).qr().q();
    let without_affine = DMatrix::identity(n, n) - &affine * affine.transpose();
    let monomials = OMatrix::<f64, Dyn, U3>::from_fn(n, |k, j| {
        let [x, y] = scaled(k);
        [0.5 * x * x, x * y, 0.5 * y * y][j]
    });
    let monomials = &without_affine * monomials;
    // |D^2 q|^2 counts the mixed derivative twice.
    let norm = Matrix3::from_diagonal(&[1.0, 2.0, 1.0].into());
    let normal = monomials.tr_mul(&monomials) / count + norm * RIDGE;
    let ridge_fit = normal.try_inverse().unwrap_or_else(Matrix3::zeros) * monomials.transpose() / count;
    let fit = &ridge_fit * 2.0 - &ridge_fit * &monomials * &ridge_fit;
    let rest = without_affine - monomials * &fit;
    let form = fit.tr_mul(&(norm * &fit)) + rest.tr_mul(&rest) * (REST / count);
    form * (area / radius.powi(4))
}
