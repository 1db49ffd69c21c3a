//! Error texts.

#![allow(clippy::unwrap_used)]

mod common;

use common::noise;
use fedic_image::{ImageError, Interpolation, MAX_PIXELS, MIN_SIZE, gaussian_filter};

#[test]
fn errors_name_the_values_and_the_limits() {
    let text = |error: ImageError| error.to_string();
    assert_eq!(text(ImageError::Empty { width: 0, height: 5 }), "the image is empty: 0 x 5 pixels");
    assert_eq!(
        text(ImageError::TooSmall { width: 5, height: 3, minimum: MIN_SIZE }),
        "the image is too small: 5 x 3 pixels, at least 4 x 4 are needed"
    );
    assert_eq!(
        text(ImageError::TooLarge { width: 40_000, height: 30_000, maximum: MAX_PIXELS }),
        "the image is too large: 40000 x 30000 pixels, at most 1073741824 are possible; split it"
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
