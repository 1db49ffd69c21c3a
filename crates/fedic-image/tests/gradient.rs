//! Central differences.

#![allow(clippy::unwrap_used)]

mod common;

use common::image_of;
use fedic_image::central_differences;

#[test]
fn central_differences_are_exact_on_quadratics() {
    let level = |u: f64, v: f64| 0.5 * u * u - u * v + 2.0 * v;
    let (du, dv) = central_differences(image_of(9, 6, |u, v| level(u as f64, v as f64)).view());
    let inner = |x: usize, size: usize, derivative: f64| if x == 0 || x == size - 1 { 0.0 } else { derivative };
    let exact_du = image_of(9, 6, |u, v| inner(u, 9, u as f64 - v as f64));
    let exact_dv = image_of(9, 6, |u, v| inner(v, 6, 2.0 - u as f64));
    assert_eq!((du, dv), (exact_du, exact_dv));
}
