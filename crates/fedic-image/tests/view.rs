//! Views and owned images: what they accept, how they read, their statistics.

#![allow(clippy::unwrap_used)]

mod common;

use common::noise;
use fedic_image::{Image, ImageError, ImageView, Interpolation, MAX_PIXELS, Pixels, downsample, gaussian_filter};
use proptest::prelude::*;

#[test]
fn sizes_and_lengths_are_checked() {
    let data = [0_u8; 100];
    let view = |width, height, length| ImageView::new(width, height, Pixels::U8(&data[..length])).map(|_| ());
    assert_eq!(view(0, 5, 0), Err(ImageError::Empty { width: 0, height: 5 }));
    assert_eq!(view(5, 3, 15), Err(ImageError::TooSmall { width: 5, height: 3 }));
    let mismatch = ImageError::LengthMismatch { width: 5, height: 6, expected: 30, found: 29 };
    assert_eq!(view(5, 6, 29), Err(mismatch));
    assert_eq!(view(4, 4, 16), Ok(()));
    assert!(view(usize::MAX, 2, 100).is_err());
}

#[test]
fn an_image_too_large_to_be_numbered_is_refused() {
    let height = MAX_PIXELS / 4 + 1;
    // Memory that nothing touches is never fetched.
    let data = vec![0_u8; 4 * height];
    let view = |height| ImageView::new(4, height, Pixels::U8(&data[..4 * height])).map(|_| ());
    assert_eq!(view(height), Err(ImageError::TooLarge { width: 4, height }));
    assert_eq!(view(height - 1), Ok(()));
}

#[test]
fn levels_that_are_not_finite_are_located() {
    let mut data = vec![1.0; 30];
    data[17] = f32::NAN;
    data[23] = f32::INFINITY;
    let error = ImageView::new(5, 6, Pixels::F32(&data)).unwrap_err();
    assert_eq!(error, ImageError::NonFinite { u: 2, v: 3 });
    assert_eq!(Image::new(5, 6, data).unwrap_err(), error);
}

#[test]
fn errors_speak_to_people() {
    let text = |error: ImageError| error.to_string();
    assert_eq!(text(ImageError::Empty { width: 0, height: 5 }), "the image is empty: 0 x 5 pixels");
    assert_eq!(
        text(ImageError::TooSmall { width: 5, height: 3 }),
        "the image is too small: 5 x 3 pixels, at least 4 x 4 are needed"
    );
    assert_eq!(
        text(ImageError::TooLarge { width: 40_000, height: 30_000 }),
        "the image is too large: 40000 x 30000 pixels, at most 1073741824 are possible; cut it in parts"
    );
    assert_eq!(
        text(ImageError::LengthMismatch { width: 5, height: 6, expected: 30, found: 29 }),
        "an image of 5 x 6 pixels has 30 grey levels, but 29 were given"
    );
    assert_eq!(
        text(ImageError::NonFinite { u: 2, v: 3 }),
        "the grey level of pixel (u = 2, v = 3) is not a finite number"
    );
    assert_eq!(
        text(gaussian_filter(noise(8, 6).view(), -1.0).unwrap_err()),
        "the standard deviation of the Gaussian filter must lie between 0 and 8 pixels, got -1"
    );
    assert_eq!(
        text("lanczos".parse::<Interpolation>().unwrap_err()),
        "unknown interpolation \"lanczos\"; choose one of bilinear, bicubic, bspline3, bspline5"
    );
}

#[test]
fn names_of_interpolations_parse_back() {
    for kind in Interpolation::ALL {
        assert_eq!(kind.to_string().parse(), Ok(kind));
    }
    assert_eq!(Interpolation::default(), Interpolation::Bspline5);
}

#[test]
fn stored_types_read_the_same() {
    let image = noise(7, 5);
    let bytes: Vec<u8> = image.pixels().iter().map(|&level| level as u8).collect();
    let words: Vec<u16> = bytes.iter().map(|&byte| u16::from(byte)).collect();
    assert_eq!(ImageView::new(7, 5, Pixels::U8(&bytes)).unwrap().to_image(), image);
    assert_eq!(ImageView::new(7, 5, Pixels::U16(&words)).unwrap().to_image(), image);
    assert_eq!(image.view().to_image(), image);
    assert_eq!(image.clone().into_pixels(), image.pixels());
}

#[test]
fn too_small_results_are_refused() {
    let error = downsample(noise(20, 6).view()).unwrap_err();
    assert_eq!(error, ImageError::TooSmall { width: 10, height: 3 });
}

proptest! {
    #[test]
    fn statistics_are_mean_and_standard_deviation(
        (width, height) in (4..40_usize, 4..40_usize),
        offset in 0_u16..60_000,
        levels in prop::collection::vec(0_u16..500, 1600),
    ) {
        let levels: Vec<u16> = levels[..width * height].iter().map(|level| level + offset).collect();
        let (mean, deviation) = ImageView::new(width, height, Pixels::U16(&levels)).unwrap().statistics();
        let sum: u64 = levels.iter().map(|&level| u64::from(level)).sum();
        let squares: u64 = levels.iter().map(|&level| u64::from(level).pow(2)).sum();
        let count = levels.len() as u64;
        let variance = (count * squares - sum * sum) as f64 / (count * count) as f64;
        prop_assert!((mean - sum as f64 / count as f64).abs() < 1e-9);
        prop_assert!((deviation - variance.sqrt()).abs() < 1e-9);
    }
}
