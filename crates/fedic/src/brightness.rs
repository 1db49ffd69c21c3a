//! Brightness and contrast: the gain and offset that bring the deformed image to the reference image.

/// Standard deviations below this many grey levels count as no texture at all.
pub(crate) const FLAT: f64 = 1e-3;

/// Weighted moments of the two images over some quadrature points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Moments {
    pub(crate) weight: f64,
    pub(crate) f: f64,
    pub(crate) g: f64,
    pub(crate) ff: f64,
    pub(crate) fg: f64,
    pub(crate) gg: f64,
}

/// `g~ = gain g + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Correction {
    pub(crate) gain: f64,
    pub(crate) offset: f64,
}

impl Correction {
    pub(crate) const NONE: Self = Self { gain: 1.0, offset: 0.0 };
}

impl Moments {
    #[inline]
    pub(crate) fn add_point(&mut self, weight: f64, f: f64, g: f64) {
        self.weight += weight;
        self.f += weight * f;
        self.g += weight * g;
        self.ff += weight * f * f;
        self.fg += weight * f * g;
        self.gg += weight * g * g;
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.weight += other.weight;
        self.f += other.f;
        self.g += other.g;
        self.ff += other.ff;
        self.fg += other.fg;
        self.gg += other.gg;
    }

    fn std(&self, sum: f64, squares: f64) -> f64 {
        (squares / self.weight - (sum / self.weight).powi(2)).max(0.0).sqrt()
    }

    pub(crate) fn std_f(&self) -> f64 {
        self.std(self.f, self.ff)
    }

    pub(crate) fn std_g(&self) -> f64 {
        self.std(self.g, self.gg)
    }

    /// Brings mean and standard deviation of `g` to those of `f`; only the mean where `g` is flat, nothing without points.
    pub(crate) fn correction(&self) -> Correction {
        if self.weight <= 0.0 {
            return Correction::NONE;
        }
        let (std_f, std_g) = (self.std_f(), self.std_g());
        let gain = if std_f > FLAT && std_g > FLAT { std_f / std_g } else { 1.0 };
        Correction { gain, offset: (self.f - gain * self.g) / self.weight }
    }

    /// `sum of w (f - gain g - offset)^2`.
    pub(crate) fn squared_residual(&self, c: Correction) -> f64 {
        let Correction { gain: a, offset: b } = c;
        let sum = self.ff + a * a * self.gg + b * b * self.weight - 2.0 * (a * self.fg + b * self.f - a * b * self.g);
        sum.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correction_matches_mean_and_standard_deviation() {
        let points = [(0.5, 10.0, 3.0), (1.0, 14.0, 4.0), (2.0, 9.0, 8.0), (0.7, 11.0, 5.5)];
        let mut moments = Moments::default();
        for (w, f, g) in points {
            moments.add_point(w, f, g);
        }
        let c = moments.correction();
        let mut corrected = Moments::default();
        let mut squares = 0.0;
        for (w, f, g) in points {
            let g = c.gain * g + c.offset;
            corrected.add_point(w, f, g);
            squares += w * (f - g) * (f - g);
        }
        assert!((corrected.g - corrected.f).abs() < 1e-12 && (corrected.std_g() - corrected.std_f()).abs() < 1e-12);
        assert!((moments.squared_residual(c) - squares).abs() < 1e-10);
    }

    #[test]
    fn a_flat_deformed_cell_is_shifted_only() {
        let mut moments = Moments::default();
        moments.add_point(1.0, 10.0, 4.0);
        moments.add_point(1.0, 20.0, 4.0);
        assert_eq!(moments.correction(), Correction { gain: 1.0, offset: 11.0 });
        assert_eq!(Moments::default().correction(), Correction::NONE);
    }
}
