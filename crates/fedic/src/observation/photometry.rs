//! Gain and offset that bring the grey levels of the deformed image to those of the reference image.

/// Rounding of grey levels in single precision and by the interpolation, relative to their size.
const ROUNDING: f64 = 1e-6;

/// Returns `true` if a standard deviation is no larger than the rounding of grey levels of this size: a constant image.
pub(crate) fn is_flat(std: f64, level: f64) -> bool {
    std.is_nan() || std <= ROUNDING * level.abs()
}

/// Weighted moments of the two images over some quadrature points. Grey levels are counted from an origin near their mean.
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
pub(crate) struct GainOffset {
    pub(crate) gain: f64,
    pub(crate) offset: f64,
}

impl GainOffset {
    pub(crate) const IDENTITY: Self = Self { gain: 1.0, offset: 0.0 };

    /// Gain and offset of grey levels counted from zero, if these are of grey levels counted from `origin`.
    pub(crate) fn counted_from_zero(self, origin: f64) -> Self {
        Self { gain: self.gain, offset: self.offset + origin * (1.0 - self.gain) }
    }
}

/// Changes the origin of a weighted sum of grey levels and of their squares from `old` to `new`. `weight` is the sum of the
/// weights.
pub(crate) fn change_origin(new: f64, sums: [f64; 2], weight: f64, old: f64) -> [f64; 2] {
    let ([sum, squares], shift) = (sums, old - new);
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

    /// Returns `true` if the reference image is constant. Grey levels are counted from `origin`.
    pub(crate) fn is_flat_f(&self, origin: f64) -> bool {
        is_flat(self.std_f(), origin + self.f / self.weight)
    }

    /// Returns `true` if the deformed image is constant. Grey levels are counted from `origin`.
    pub(crate) fn is_flat_g(&self, origin: f64) -> bool {
        is_flat(self.std_g(), origin + self.g / self.weight)
    }

    /// Standard deviation of the residual `f - a g - b` with the best `a` and `b`, and the correlation coefficient of `f` and `g`.
    /// `squares` is the sum of the squared residuals with this gain and offset, of grey levels counted from the same `origin`.
    pub(crate) fn regression(&self, squares: f64, GainOffset { gain, offset }: GainOffset, origin: f64) -> (f64, f64) {
        let Self { weight, f, ff, g, gg } = *self;
        let of_squares = ff + gain * gain * gg + offset * offset * weight + 2.0 * offset * (gain * g - f);
        let product = (of_squares - squares) / (2.0 * gain);
        let covariance = product / weight - (f / weight) * (g / weight);
        let (std_f, std_g) = (self.std_f(), self.std_g());
        if self.is_flat_f(origin) || self.is_flat_g(origin) {
            return (std_f, 0.0);
        }
        let correlation = (covariance / (std_f * std_g)).clamp(-1.0, 1.0);
        // The residual variance, unlike 1 - correlation^2, is accurate for images that agree well.
        let mean = (f - gain * g - offset * weight) / weight;
        let slope = (covariance - gain * std_g * std_g) / std_g;
        let variance = squares / weight - mean * mean - slope * slope;
        (variance.max(0.0).sqrt(), correlation)
    }

    /// Matches mean and standard deviation of `g` to those of `f`; the mean alone if an image is flat; the identity without points.
    ///
    /// Grey levels are counted from `origin`.
    pub(crate) fn gain_offset(&self, origin: f64) -> GainOffset {
        if self.weight <= 0.0 {
            return GainOffset::IDENTITY;
        }
        let gain = if self.is_flat_f(origin) || self.is_flat_g(origin) { 1.0 } else { self.std_f() / self.std_g() };
        GainOffset { gain, offset: (self.f - gain * self.g) / self.weight }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_and_offset_match_mean_and_standard_deviation() {
        let points = [(0.5, 10.0, 3.0), (1.0, 14.0, 4.0), (2.0, 9.0, 8.0), (0.7, 11.0, 5.5)];
        let mut moments = Moments::default();
        for (w, f, g) in points {
            moments.add_point(w, f, g);
        }
        let c = moments.gain_offset(0.0);
        let mut corrected = Moments::default();
        for (w, f, g) in points {
            let g = c.gain * g + c.offset;
            corrected.add_point(w, f, g);
        }
        assert!((corrected.g - corrected.f).abs() < 1e-12 && (corrected.std_g() - corrected.std_f()).abs() < 1e-12);
        let mut shifted = Moments::default();
        points.iter().for_each(|&(w, f, g)| shifted.add_point(w, f - 7.0, g - 7.0));
        let same = shifted.gain_offset(7.0).counted_from_zero(7.0);
        assert!((same.gain - c.gain).abs() < 1e-12 && (same.offset - c.offset).abs() < 1e-11);
    }

    #[test]
    fn changing_the_origin_equals_summing_from_it() {
        let points = [(0.5, 10.0, 3.0), (1.0, 14.0, 4.0), (2.0, 9.0, 8.0)];
        let from = |level: f64| {
            let mut moments = Moments::default();
            points.iter().for_each(|&(w, f, g)| moments.add_point(w, f, g - level));
            moments
        };
        let ([one, other], weight) = ([from(5.0), from(-3.5)], 3.5);
        let [g, gg] = change_origin(-3.5, [one.g, one.gg], weight, 5.0);
        assert!((g - other.g).abs() < 1e-12 && (gg - other.gg).abs() < 1e-11, "{g} {gg} {other:?}");
    }

    #[test]
    fn regression_is_that_of_the_points() {
        let points = [(0.5, 10.0, 3.0), (1.0, 14.0, 4.0), (2.0, 9.0, 8.0), (0.7, 11.0, 5.5)];
        let mut moments = Moments::default();
        points.iter().for_each(|&(w, f, g)| moments.add_point(w, f, g));
        let weight: f64 = points.iter().map(|p| p.0).sum();
        let mean = |k: usize| points.iter().map(|p| p.0 * [p.1, p.2][k]).sum::<f64>() / weight;
        let (mf, mg) = (mean(0), mean(1));
        let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(w, f, g)| w * of(f - mf, g - mg)).sum::<f64>();
        let (ff, gg, fg) = (sum(&|f, _| f * f), sum(&|_, g| g * g), sum(&|f, g| f * g));
        let expected = ((ff - fg * fg / gg) / weight).sqrt();
        for (gain, offset) in [(1.0, 0.0), (0.7, 3.0), (-1.2, 20.0)] {
            let squares = points.iter().map(|&(w, f, g)| w * (f - gain * g - offset).powi(2)).sum();
            let (scatter, correlation) = moments.regression(squares, GainOffset { gain, offset }, 0.0);
            assert!((scatter - expected).abs() < 1e-12 && (correlation - fg / (ff * gg).sqrt()).abs() < 1e-12);
        }
        let flat = Moments { gg: moments.weight * 16.0, g: moments.weight * 4.0, ..moments };
        assert_eq!(flat.regression(1.0, GainOffset::IDENTITY, 0.0).1, 0.0);
    }

    #[test]
    fn a_flat_deformed_image_is_only_shifted() {
        let mut moments = Moments::default();
        moments.add_point(1.0, 10.0, 4.0);
        moments.add_point(1.0, 20.0, 4.0);
        assert_eq!(moments.gain_offset(0.0), GainOffset { gain: 1.0, offset: 11.0 });
        assert_eq!(Moments::default().gain_offset(0.0), GainOffset::IDENTITY);
    }

    #[test]
    fn flatness_is_relative_to_the_grey_levels() {
        for scale in [1e-12, 1e-6, 1.0, 65_535.0, 1e9] {
            for (contrast, expected) in [(1e-4, false), (1e-7, true), (0.0, true)] {
                let mut moments = Moments::default();
                [-1.0, 1.0].iter().for_each(|sign| moments.add_point(1.0, sign * contrast * scale, 0.0));
                assert_eq!(moments.is_flat_f(scale), expected, "{scale} {contrast}");
                assert!(moments.is_flat_g(scale));
            }
        }
    }
}
