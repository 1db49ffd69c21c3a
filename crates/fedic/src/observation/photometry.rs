//! Brightness and contrast: the gain and offset that bring the deformed image to the reference image.

/// Standard deviations below this many grey levels count as no texture at all.
pub(crate) const FLAT: f64 = 1e-3;

/// Weighted moments of the two images over some quadrature points, their grey levels counted from a pivot near the mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Moments {
    pub(crate) weight: f64,
    pub(crate) f: f64,
    pub(crate) ff: f64,
    pub(crate) g: f64,
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

    /// The same correction of grey levels that are not counted from a pivot.
    pub(crate) fn without_pivot(self, pivot: f64) -> Self {
        Self { gain: self.gain, offset: self.offset + pivot * (1.0 - self.gain) }
    }
}

/// Sum and sum of squares of grey levels counted from `pivot`, where `sums` are those of the same counted from `before`;
/// `weight` is the sum of their weights.
pub(crate) fn counted_from(pivot: f64, sums: [f64; 2], weight: f64, before: f64) -> [f64; 2] {
    let ([sum, squares], shift) = (sums, before - pivot);
    [sum + weight * shift, squares + shift * (2.0 * sum + weight * shift)]
}

impl Moments {
    pub(crate) fn add_point(&mut self, weight: f64, f: f64, g: f64) {
        self.weight += weight;
        self.f += weight * f;
        self.ff += weight * f * f;
        self.g += weight * g;
        self.gg += weight * g * g;
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.weight += other.weight;
        self.f += other.f;
        self.ff += other.ff;
        self.g += other.g;
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
        for (w, f, g) in points {
            let g = c.gain * g + c.offset;
            corrected.add_point(w, f, g);
        }
        assert!((corrected.g - corrected.f).abs() < 1e-12 && (corrected.std_g() - corrected.std_f()).abs() < 1e-12);
        let mut shifted = Moments::default();
        points.iter().for_each(|&(w, f, g)| shifted.add_point(w, f - 7.0, g - 7.0));
        let same = shifted.correction().without_pivot(7.0);
        assert!((same.gain - c.gain).abs() < 1e-12 && (same.offset - c.offset).abs() < 1e-11);
    }

    #[test]
    fn sums_are_counted_from_another_level() {
        let points = [(0.5, 10.0, 3.0), (1.0, 14.0, 4.0), (2.0, 9.0, 8.0)];
        let from = |level: f64| {
            let mut moments = Moments::default();
            points.iter().for_each(|&(w, f, g)| moments.add_point(w, f, g - level));
            moments
        };
        let ([one, other], weight) = ([from(5.0), from(-3.5)], 3.5);
        let [g, gg] = counted_from(-3.5, [one.g, one.gg], weight, 5.0);
        assert!((g - other.g).abs() < 1e-12 && (gg - other.gg).abs() < 1e-11, "{g} {gg} {other:?}");
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
