//! Images shared by the tests.

use fedic_image::Image;

/// An image whose grey level is `level(u, v)`.
pub(crate) fn image_of(width: usize, height: usize, level: impl Fn(usize, usize) -> f64) -> Image {
    let data = (0..width * height).map(|index| level(index % width, index / width) as f32).collect();
    Image::new(width, height, data).unwrap()
}

/// White noise between 0 and 255, always the same.
pub(crate) fn noise(width: usize, height: usize) -> Image {
    image_of(width, height, |u, v| {
        let mut bits = (v * 65_536 + u) as u64 + 1;
        for _ in 0..3 {
            bits = (bits ^ (bits >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
        (bits >> 56) as f64
    })
}
