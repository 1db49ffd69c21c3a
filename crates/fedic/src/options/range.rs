//! Ranges of numbers.

/// Numbers that an option takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The range in words, to be read after "must be".
    pub words: &'static str,
    /// Lower bound.
    pub min: f64,
    /// Whether the lower bound itself is excluded.
    pub above_min: bool,
    /// Upper bound, itself included; infinite for none.
    pub max: f64,
}

impl Range {
    /// Numbers greater than `min`.
    #[must_use]
    pub const fn above(min: f64, words: &'static str) -> Self {
        Self { words, min, above_min: true, max: f64::INFINITY }
    }

    /// Numbers from `min` on.
    #[must_use]
    pub const fn at_least(min: f64, words: &'static str) -> Self {
        Self { words, min, above_min: false, max: f64::INFINITY }
    }

    /// The same numbers without those greater than `max`.
    #[must_use]
    pub const fn up_to(self, max: f64) -> Self {
        Self { max, ..self }
    }

    /// Whether `number` is finite and in the range.
    #[must_use]
    pub fn contains(&self, number: f64) -> bool {
        let above = if self.above_min { number > self.min } else { number >= self.min };
        number.is_finite() && above && number <= self.max
    }
}

/// Accepted densities of quadrature points.
pub(crate) const DENSITY: Range = Range::above(0.0, "a positive number of at most 10000").up_to(1e4);
/// Accepted standard deviations of the smoothing.
pub(crate) const SMOOTHING: Range = Range::at_least(0.0, "zero or a positive standard deviation in pixels");
/// Accepted standard deviations of the noise of an image.
pub(crate) const NOISE: Range = Range::at_least(0.0, "zero or a positive standard deviation in grey levels");
/// Accepted tolerances.
pub(crate) const TOLERANCE: Range = Range::above(0.0, "a positive number of pixels of at most 1").up_to(1.0);
/// Accepted numbers of iterations.
pub(crate) const MAX_ITERATIONS: Range = Range::at_least(1.0, "an integer of at least 1");
/// Accepted numbers of threads.
pub(crate) const NUM_THREADS: Range = Range::at_least(1.0, "an integer between 1 and 1024").up_to(1024.0);
/// Accepted wavelengths of the regularization.
pub(crate) const REGULARIZATION_LENGTH: Range = Range::above(0.0, "a positive wavelength in pixels");
