//! Gaussian smoothing.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_close, image_of, noise, row};
use fedic_image::{ImageError, gaussian_filter};

/// Weights of the filter along a line: the response to an impulse, and the amplitude left of a wave.
fn line_weights(smoothing: f64) -> Vec<f64> {
    let impulse = image_of(41, 41, |u, v| if (u, v) == (20, 20) { 1000.0 } else { 0.0 });
    let smooth = gaussian_filter(impulse.view(), smoothing).unwrap();
    // Sums over the columns: the filter is separable and normalised.
    (0..41).map(|u| (0..41).map(|v| f64::from(row(&smooth, v)[u])).sum::<f64>() / 1000.0).collect()
}

fn amplitude(weights: &[f64], wavenumber: f64) -> f64 {
    weights.iter().enumerate().map(|(u, weight)| weight * (wavenumber * (u as f64 - 20.0)).cos()).sum()
}

#[test]
fn the_frequency_response_is_that_of_a_gaussian() {
    for (smoothing, accepted) in [(0.5, 1e-3), (0.8, 1e-4), (1.2, 1e-6), (2.0, 1e-5), (3.5, 2.5e-5)] {
        let weights = line_weights(smoothing);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-6);
        for step in 0..=30 {
            let wavenumber = 0.05 * f64::from(step);
            let expected = (-0.5 * (smoothing * wavenumber).powi(2)).exp();
            let error = amplitude(&weights, wavenumber) - expected;
            assert!(error.abs() < accepted, "{smoothing} px, {wavenumber} rad/px: {error:e}");
        }
    }
}

#[test]
fn a_narrow_sampled_gaussian_has_aliases() {
    let bell: Vec<f64> = (0..41).map(|u| (-0.5 * ((f64::from(u) - 20.0) / 0.8).powi(2)).exp()).collect();
    let total: f64 = bell.iter().sum();
    let sampled: Vec<f64> = bell.iter().map(|weight| weight / total).collect();
    let error = amplitude(&sampled, 1.5) - (-0.5 * (0.8_f64 * 1.5).powi(2)).exp();
    assert!((6e-4..7e-4).contains(&error.abs()), "{error:e}");
}

#[test]
fn a_wide_filter_is_the_sampled_gaussian() {
    let (smoothing, weights) = (3.5, line_weights(3.5));
    let bell = |u: usize| (-0.5 * ((u as f64 - 20.0) / smoothing).powi(2)).exp();
    let total: f64 = (0..41).map(bell).sum();
    for (u, weight) in weights.iter().enumerate() {
        assert!((weight - bell(u) / total).abs() < 1.5e-4, "{u}");
    }
}

#[test]
fn the_border_is_mirrored() {
    let image = noise(14, 11);
    let smooth = gaussian_filter(image.view(), 1.2).unwrap();
    let reflect = |x: i64, size: i64| {
        if x < 0 {
            -x
        } else if x >= size {
            2 * (size - 1) - x
        } else {
            x
        }
    };
    let around = image_of(14 + 12, 11 + 12, |u, v| {
        let [u, v] = [(u as i64 - 6, 14), (v as i64 - 6, 11)].map(|(x, size)| reflect(x, size) as usize);
        f64::from(row(&image, v)[u])
    });
    let inside = gaussian_filter(around.view(), 1.2).unwrap();
    for v in 0..11 {
        assert_close(row(&smooth, v), row(&inside, v + 6)[6..20].iter().map(|&level| f64::from(level)), 1e-3);
    }
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
