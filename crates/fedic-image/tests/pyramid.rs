//! Image pyramids.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_close, image_of, noise, row};
use fedic_image::{ImageError, MIN_SIZE, downsample};

#[test]
fn a_constant_image_stays_constant() {
    let half = downsample(image_of(11, 8, |_, _| 42.0).view()).unwrap();
    assert_eq!(half, image_of(6, 4, |_, _| 42.0));
}

#[test]
fn a_ramp_keeps_its_position() {
    let half = downsample(image_of(21, 18, |u, v| 3.0 * u as f64 - 2.0 * v as f64 + 50.0).view()).unwrap();
    assert_eq!((half.width(), half.height()), (11, 9));
    for v in 1..8 {
        let exact = (1..10).map(|u| 6.0 * u as f64 - 4.0 * v as f64 + 50.0);
        assert_close(&row(&half, v)[1..10], exact, 1e-4);
    }
    // The mirrored ramp has a kink at the border: neighbours on both sides add 4/16 and 2/16 of the slope.
    assert_close(&row(&half, 4)[..1], [3.0 * 0.75 - 16.0 + 50.0], 1e-4);
}

#[test]
fn an_impulse_becomes_the_binomial_weights() {
    let half = downsample(image_of(16, 16, |u, v| if (u, v) == (8, 7) { 256.0 } else { 0.0 }).view()).unwrap();
    let across = [0.0, 0.0, 0.0, 1.0, 6.0, 1.0, 0.0, 0.0];
    let down = [0.0, 0.0, 0.0, 4.0, 4.0, 0.0, 0.0, 0.0];
    assert_eq!(half, image_of(8, 8, |u, v| across[u] * down[v]));
}

#[test]
fn results_below_the_smallest_size_are_refused() {
    let error = downsample(noise(20, 6).view()).unwrap_err();
    assert_eq!(error, ImageError::TooSmall { width: 10, height: 3, minimum: MIN_SIZE });
}
