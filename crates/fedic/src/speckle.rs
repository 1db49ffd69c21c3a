//! A synthetic speckle: a continuous texture of the physical plane, known at any point.

use crate::SolveError;

/// Spots of paint on a regular grid of squares, one per square, each of random place, radius and darkness.
///
/// A spot of radius `R` darkens the ground by `a (1 - d^2 / R^2)^3` at the distance `d` of its centre: twice continuously
/// differentiable and zero from `R` on, so that a point meets the spots of the nine squares around it only. Light passes
/// one spot after the other: the grey level is the product of `1 - darkness` over the spots.
///
/// # Examples
///
/// ```
/// use fedic::Speckle;
/// let speckle = Speckle::new(4.0, 0.5, 7)?;
/// let grey = speckle.value([12.3, -4.5]);
/// assert!((0.0..=1.0).contains(&grey) && grey == Speckle::new(4.0, 0.5, 7)?.value([12.3, -4.5]));
/// # Ok::<(), fedic::SolveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speckle {
    size: f64,
    coverage: f64,
    seed: u64,
    pitch: f64,
}

/// Radius of the support of a spot over that at which it looks half as dark: `1 / sqrt(1 - 2^(-1/3))`.
const SUPPORT: f64 = 2.201_626_6;
/// Spots differ in radius by this fraction to either side.
const SPREAD: f64 = 0.25;

impl Speckle {
    /// A speckle whose spots have the mean diameter `size` (at half darkness, in the unit of the plane) and darken about
    /// the fraction `coverage` of the ground. The same seed gives the same speckle.
    ///
    /// # Errors
    ///
    /// [`SolveError::InvalidOption`] where the size is not positive or the coverage not between 0.1 and 0.7.
    pub fn new(size: f64, coverage: f64, seed: u64) -> Result<Self, SolveError> {
        let refuse = |option, expected, value: f64| {
            Err(SolveError::InvalidOption { option, expected, value: value.to_string() })
        };
        if !(size.is_finite() && size > 0.0) {
            return refuse("size", "a positive length", size);
        }
        if !(0.1..=0.7).contains(&coverage) {
            return refuse("coverage", "between 0.1 and 0.7", coverage);
        }
        // The disks of mean diameter `size`, one per square, cover this fraction of it if they overlap at random.
        let disk = 0.25 * std::f64::consts::PI * size * size;
        let pitch = (disk / -(1.0 - coverage).ln()).sqrt();
        Ok(Self { size, coverage, seed, pitch })
    }

    /// Mean diameter of the spots.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Fraction of the ground that is dark.
    pub fn coverage(&self) -> f64 {
        self.coverage
    }

    /// Seed of the random places.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Grey level at a point of the plane: 0 black, 1 the ground's white.
    pub fn value(&self, [x, y]: [f64; 2]) -> f64 {
        let largest = 0.5 * self.size * SUPPORT * (1.0 + SPREAD);
        let reach = (largest / self.pitch).ceil() as i64;
        let (i, j) = ((x / self.pitch).floor() as i64, (y / self.pitch).floor() as i64);
        let mut light = 1.0;
        for row in j - reach..=j + reach {
            for column in i - reach..=i + reach {
                let [a, b, c, d] = random(self.seed, column, row);
                let dx = x - (column as f64 + a) * self.pitch;
                let dy = y - (row as f64 + b) * self.pitch;
                let radius = 0.5 * self.size * SUPPORT * (1.0 + SPREAD * (2.0 * c - 1.0));
                let inside = 1.0 - (dx * dx + dy * dy) / (radius * radius);
                if inside > 0.0 {
                    light *= 1.0 - (0.75 + 0.25 * d) * inside * inside * inside;
                }
            }
        }
        light
    }
}

/// Four numbers in `[0, 1)` of a square of the grid (the finaliser of SplitMix64 on its coordinates).
fn random(seed: u64, column: i64, row: i64) -> [f64; 4] {
    let mix = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let square = mix(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ column as u64).wrapping_add(row as u64));
    let second = mix(square.wrapping_add(0x9e37_79b9_7f4a_7c15));
    let unit = |bits: u64| (bits & 0xffff_ffff) as f64 / f64::from(u32::MAX) * (1.0 - 1e-9);
    [unit(square), unit(square >> 32), unit(second), unit(second >> 32)]
}
