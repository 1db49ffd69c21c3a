//! Views and owned images: accepted sizes and values, conversion, statistics.

#![allow(clippy::unwrap_used)]

mod common;

use common::noise;
use fedic_image::{Image, ImageError, ImageView, MAX_PIXELS, MIN_SIZE, Pixels};
use proptest::prelude::*;

#[test]
fn sizes_and_lengths_are_checked() {
    let data = [0_u8; 100];
    let view = |width, height, length| ImageView::new(width, height, Pixels::U8(&data[..length])).map(|_| ());
    assert_eq!(view(0, 5, 0), Err(ImageError::Empty { width: 0, height: 5 }));
    assert_eq!(view(5, 3, 15), Err(ImageError::TooSmall { width: 5, height: 3, minimum: MIN_SIZE }));
    let mismatch = ImageError::LengthMismatch { width: 5, height: 6, expected: 30, found: 29 };
    assert_eq!(view(5, 6, 29), Err(mismatch));
    assert_eq!(view(4, 4, 16), Ok(()));
    assert!(view(usize::MAX, 2, 100).is_err());
}

#[test]
fn images_with_more_than_the_largest_number_of_pixels_are_refused() {
    let height = MAX_PIXELS / 4 + 1;
    // Zeroed pages that are never written occupy no memory.
    let data = vec![0_u8; 4 * height];
    let view = |height| ImageView::new(4, height, Pixels::U8(&data[..4 * height])).map(|_| ());
    assert_eq!(view(height), Err(ImageError::TooLarge { width: 4, height, maximum: MAX_PIXELS }));
    assert_eq!(view(height - 1), Ok(()));
}

#[test]
fn the_first_grey_level_that_is_not_finite_is_located() {
    let mut data = vec![1.0; 30];
    data[17] = f32::NAN;
    data[23] = f32::INFINITY;
    let error = ImageView::new(5, 6, Pixels::F32(&data)).unwrap_err();
    assert_eq!(error, ImageError::NonFinite { u: 2, v: 3 });
    assert_eq!(Image::new(5, 6, data).unwrap_err(), error);
}

#[test]
fn all_stored_types_convert_alike() {
    let image = noise(7, 5);
    let bytes: Vec<u8> = image.pixels().iter().map(|&level| level as u8).collect();
    let words: Vec<u16> = bytes.iter().map(|&byte| u16::from(byte)).collect();
    assert_eq!(ImageView::new(7, 5, Pixels::U8(&bytes)).unwrap().to_image(), image);
    assert_eq!(ImageView::new(7, 5, Pixels::U16(&words)).unwrap().to_image(), image);
    assert_eq!(image.view().to_image(), image);
    assert_eq!(image.clone().into_pixels(), image.pixels());
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
