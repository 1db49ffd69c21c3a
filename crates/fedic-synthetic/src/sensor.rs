//! The sensor of a camera: contrast, noise and quantisation.

use fedic_image::Image;
use rayon::prelude::*;

use crate::error::SyntheticError;
use crate::random::normal;
use crate::rendering::Rendering;

/// Turns rendered means into grey levels.
///
/// By default the texture's values 0 and 1 become the grey levels 25 and 230, without noise or rounding.
///
/// # Examples
///
/// ```
/// use fedic_camera::ImageFrame;
/// use fedic_synthetic::{Plane, Render, Sensor, Speckle, SyntheticError};
///
/// let rendering = Render::new(&ImageFrame, [40, 30]).plane(&Plane::horizontal(0.0)?, &Speckle::new(5.0, 0.5, 1)?)?;
/// let image = Sensor::default().with_noise(2.0, 7).with_bits(8).expose(&rendering)?;
/// assert!(image.pixels().iter().all(|&grey| grey == grey.round() && (0.0..=255.0).contains(&grey)));
/// # Ok::<(), SyntheticError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    levels: [f64; 2],
    noise: f64,
    seed: u64,
    bits: Option<u32>,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { levels: [25.0, 230.0], noise: 0.0, seed: 0, bits: None }
    }
}

impl Sensor {
    /// Grey levels of the texture's values 0 and 1.
    #[must_use]
    pub fn with_levels(mut self, levels: [f64; 2]) -> Self {
        self.levels = levels;
        self
    }

    /// Gaussian noise of the given standard deviation in grey levels, independent from pixel to pixel. The same seed gives
    /// the same noise.
    #[must_use]
    pub fn with_noise(mut self, standard_deviation: f64, seed: u64) -> Self {
        (self.noise, self.seed) = (standard_deviation, seed);
        self
    }

    /// Rounds to whole grey levels and clips to `[0, 2^bits - 1]`.
    #[must_use]
    pub fn with_bits(mut self, bits: u32) -> Self {
        self.bits = Some(bits);
        self
    }

    /// The image that the sensor records.
    ///
    /// # Errors
    ///
    /// [`SyntheticError::InvalidOption`] if the noise is negative or not finite, or the bits are not between 1 and 16;
    /// [`SyntheticError::Image`] if the image is too small or too large for [`Image::new`], or a grey level is not finite.
    pub fn expose(&self, rendering: &Rendering) -> Result<Image, SyntheticError> {
        if !(0.0..f64::INFINITY).contains(&self.noise) {
            let (expected, value) = ("finite and at least 0", self.noise.to_string());
            return Err(SyntheticError::InvalidOption { option: "noise", expected, value });
        }
        if let Some(bits) = self.bits
            && !(1..=16).contains(&bits)
        {
            let (expected, value) = ("between 1 and 16", bits.to_string());
            return Err(SyntheticError::InvalidOption { option: "bits", expected, value });
        }
        let [dark, bright] = self.levels;
        let grey = |(index, &value): (usize, &f64)| {
            let mut grey = dark + (bright - dark) * value;
            if self.noise > 0.0 {
                grey += self.noise * normal(self.seed, index as u64);
            }
            if let Some(bits) = self.bits {
                grey = grey.round_ties_even().clamp(0.0, f64::from((1_u32 << bits) - 1));
            }
            grey as f32
        };
        let levels = rendering.values().par_iter().enumerate().map(grey).collect();
        Ok(Image::new(rendering.width(), rendering.height(), levels)?)
    }
}
