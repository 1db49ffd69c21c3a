//! Images and helpers shared by the tests.

#![allow(dead_code)]

use fedic_image::{Image, Interpolator};

/// An image whose grey level is `level(u, v)`.
pub(crate) fn image_of(width: usize, height: usize, level: impl Fn(usize, usize) -> f64) -> Image {
    let data = (0..width * height).map(|index| level(index % width, index / width) as f32).collect();
    Image::new(width, height, data).unwrap()
}

/// White noise between 0 and 255, the same at every call.
pub(crate) fn noise(width: usize, height: usize) -> Image {
    image_of(width, height, |u, v| {
        let mut bits = (v * 65_536 + u) as u64 + 1;
        for _ in 0..3 {
            bits = (bits ^ (bits >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
        (bits >> 56) as f64
    })
}

/// Row `v` of an image.
pub(crate) fn row(image: &Image, v: usize) -> &[f32] {
    &image.pixels()[v * image.width()..(v + 1) * image.width()]
}

/// Value at one point.
pub(crate) fn value_at(interpolator: &Interpolator, u: f64, v: f64) -> f64 {
    let mut value = [0.0];
    interpolator.values(&[u], &[v], &mut value);
    f64::from(value[0])
}

/// Value and derivatives along `u` and `v` at one point.
pub(crate) fn gradient_at(interpolator: &Interpolator, u: f64, v: f64) -> [f64; 3] {
    let (mut value, mut du, mut dv) = ([0.0], [0.0], [0.0]);
    interpolator.values_and_gradients(&[u], &[v], &mut value, &mut du, &mut dv);
    [value[0], du[0], dv[0]].map(f64::from)
}

pub(crate) fn assert_close(found: &[f32], expected: impl IntoIterator<Item = f64>, tolerance: f64) {
    let expected: Vec<f64> = expected.into_iter().collect();
    assert_eq!(found.len(), expected.len());
    for (index, (&found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((f64::from(found) - expected).abs() < tolerance, "at {index}: {found} instead of {expected}");
    }
}
