//! Gaussian smoothing, central differences and pyramids.

#![allow(clippy::unwrap_used)]

mod common;

use common::{image_of, noise};
use fedic_image::{Image, ImageError, central_differences, downsample, gaussian_filter};

fn assert_close(found: &[f32], expected: impl IntoIterator<Item = f64>, tolerance: f64) {
    let expected: Vec<f64> = expected.into_iter().collect();
    assert_eq!(found.len(), expected.len());
    for (index, (&found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((f64::from(found) - expected).abs() < tolerance, "at {index}: {found} instead of {expected}");
    }
}

fn row(image: &Image, v: usize) -> &[f32] {
    &image.pixels()[v * image.width()..(v + 1) * image.width()]
}

#[test]
fn gaussian_of_an_impulse_is_the_gaussian() {
    let sigma = 1.5;
    let impulse = image_of(31, 29, |u, v| if (u, v) == (15, 14) { 1000.0 } else { 0.0 });
    let smooth = gaussian_filter(impulse.view(), sigma).unwrap();
    let bell = |x: usize, centre: usize| {
        let distance = x.abs_diff(centre);
        if distance > 6 { 0.0 } else { (-0.5 * (distance as f64 / sigma).powi(2)).exp() }
    };
    let total: f64 = (0..31).map(|u| bell(u, 15)).sum();
    let expected = image_of(31, 29, |u, v| 1000.0 * bell(u, 15) * bell(v, 14) / (total * total));
    assert_close(smooth.pixels(), expected.pixels().iter().map(|&level| f64::from(level)), 1e-4);
}

/// `scipy.ndimage.gaussian_filter(image, 1.2, mode="mirror", truncate=4)` of SciPy 1.17.1, rounded to four decimals; the filter
/// reaches beyond one reflection of this small image.
#[test]
fn gaussian_agrees_with_scipy() {
    let image = image_of(7, 6, |u, v| ((37 * u + 91 * v + 13 * u * v) % 256) as f64);
    let smooth = gaussian_filter(image.view(), 1.2).unwrap();
    assert_close(row(&smooth, 0), [108.6711, 116.6001, 131.314, 137.615, 135.5279, 137.441, 140.6091], 1e-4);
    assert_close(row(&smooth, 2), [132.5189, 135.2374, 140.5234, 143.4983, 142.205, 141.2441, 141.4945], 1e-4);
    assert_close(row(&smooth, 5), [124.1078, 124.5439, 130.9436, 141.1415, 139.5597, 127.7654, 121.5527], 1e-4);
}

#[test]
fn gaussian_of_no_width_is_a_copy() {
    let image = noise(12, 9);
    assert_eq!(gaussian_filter(image.view(), 0.0), Ok(image));
}

#[test]
fn widths_without_meaning_are_refused() {
    let image = noise(12, 9);
    for sigma in [-0.1, 12.5, f64::INFINITY] {
        assert_eq!(gaussian_filter(image.view(), sigma), Err(ImageError::InvalidSigma { sigma, largest: 12 }));
    }
    assert!(gaussian_filter(image.view(), f64::NAN).is_err());
}

#[test]
fn differences_of_a_quadratic() {
    let level = |u: f64, v: f64| 0.5 * u * u - u * v + 2.0 * v;
    let (du, dv) = central_differences(image_of(9, 6, |u, v| level(u as f64, v as f64)).view());
    let inner = |x: usize, size: usize, slope: f64| if x == 0 || x == size - 1 { 0.0 } else { slope };
    let exact_du = image_of(9, 6, |u, v| inner(u, 9, u as f64 - v as f64));
    let exact_dv = image_of(9, 6, |u, v| inner(v, 6, 2.0 - u as f64));
    assert_eq!((du, dv), (exact_du, exact_dv));
}

#[test]
fn a_constant_stays_when_reduced() {
    let half = downsample(image_of(11, 8, |_, _| 42.0).view()).unwrap();
    assert_eq!(half, image_of(6, 4, |_, _| 42.0));
}

#[test]
fn a_ramp_keeps_its_place_when_reduced() {
    let half = downsample(image_of(21, 18, |u, v| 3.0 * u as f64 - 2.0 * v as f64 + 50.0).view()).unwrap();
    assert_eq!((half.width(), half.height()), (11, 9));
    for v in 1..8 {
        let exact = (1..10).map(|u| 6.0 * u as f64 - 4.0 * v as f64 + 50.0);
        assert_close(&row(&half, v)[1..10], exact, 1e-4);
    }
    // At the border, the mirrored ramp is a roof: 4/16 of the slope and 1/16 of twice the slope, from both sides.
    assert_close(&row(&half, 4)[..1], [3.0 * 0.75 - 16.0 + 50.0], 1e-4);
}

#[test]
fn an_impulse_reduces_to_the_binomial_weights() {
    let half = downsample(image_of(16, 16, |u, v| if (u, v) == (8, 7) { 256.0 } else { 0.0 }).view()).unwrap();
    let across = [0.0, 0.0, 0.0, 1.0, 6.0, 1.0, 0.0, 0.0];
    let down = [0.0, 0.0, 0.0, 4.0, 4.0, 0.0, 0.0, 0.0];
    assert_eq!(half, image_of(8, 8, |u, v| across[u] * down[v]));
}
