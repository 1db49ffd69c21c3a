//! Gaussian smoothing.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_close, image_of, noise, row};
use fedic_image::{ImageError, gaussian_filter};

#[test]
fn smoothing_an_impulse_gives_the_gaussian() {
    let smoothing = 1.5;
    let impulse = image_of(31, 29, |u, v| if (u, v) == (15, 14) { 1000.0 } else { 0.0 });
    let smooth = gaussian_filter(impulse.view(), smoothing).unwrap();
    let bell = |x: usize, centre: usize| {
        let distance = x.abs_diff(centre);
        if distance > 6 { 0.0 } else { (-0.5 * (distance as f64 / smoothing).powi(2)).exp() }
    };
    let total: f64 = (0..31).map(|u| bell(u, 15)).sum();
    let expected = image_of(31, 29, |u, v| 1000.0 * bell(u, 15) * bell(v, 14) / (total * total));
    assert_close(smooth.pixels(), expected.pixels().iter().map(|&level| f64::from(level)), 1e-4);
}

/// `scipy.ndimage.gaussian_filter(image, 1.2, mode="mirror", truncate=4)` of SciPy 1.17.1, rounded to four decimals; the filter
/// reaches beyond one reflection of this small image.
#[test]
fn smoothing_agrees_with_scipy() {
    let image = image_of(7, 6, |u, v| ((37 * u + 91 * v + 13 * u * v) % 256) as f64);
    let smooth = gaussian_filter(image.view(), 1.2).unwrap();
    assert_close(row(&smooth, 0), [108.6711, 116.6001, 131.314, 137.615, 135.5279, 137.441, 140.6091], 1e-4);
    assert_close(row(&smooth, 2), [132.5189, 135.2374, 140.5234, 143.4983, 142.205, 141.2441, 141.4945], 1e-4);
    assert_close(row(&smooth, 5), [124.1078, 124.5439, 130.9436, 141.1415, 139.5597, 127.7654, 121.5527], 1e-4);
}

#[test]
fn smoothing_by_zero_copies_the_image() {
    let image = noise(12, 9);
    assert_eq!(gaussian_filter(image.view(), 0.0), Ok(image));
}

#[test]
fn negative_or_excessive_smoothing_is_refused() {
    let image = noise(12, 9);
    for smoothing in [-0.1, 12.5, f64::INFINITY] {
        assert_eq!(
            gaussian_filter(image.view(), smoothing),
            Err(ImageError::InvalidSmoothing { smoothing, largest: 12 })
        );
    }
    assert!(gaussian_filter(image.view(), f64::NAN).is_err());
}
