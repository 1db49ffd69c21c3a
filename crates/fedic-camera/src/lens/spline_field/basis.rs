//! Uniform cubic B-splines on one axis.

/// The four basis functions that are not zero at a point.
pub(super) struct BasisFunctions {
    /// Index of the first of them.
    pub(super) first: usize,
    pub(super) values: [f64; 4],
    pub(super) slopes: [f64; 4],
}

impl BasisFunctions {
    /// Evaluates them at `t` intervals from the start of the axis; beyond its ends, each function continues linearly.
    #[inline]
    pub(super) fn new(t: f64, intervals: usize, density: f64) -> Self {
        const SIXTH: f64 = 1.0 / 6.0;
        let first = (t as usize).min(intervals - 1);
        let s = t - first as f64;
        let inside = s.clamp(0.0, 1.0);
        let r = 1.0 - inside;
        let slopes = [-0.5 * r * r, inside * (1.5 * inside - 2.0), r * (2.0 - 1.5 * r), 0.5 * inside * inside];
        let mut values = [
            SIXTH * r * r * r,
            inside * inside * (0.5 * inside - 1.0) + 2.0 / 3.0,
            r * r * (0.5 * r - 1.0) + 2.0 / 3.0,
            SIXTH * inside * inside * inside,
        ];
        for (value, slope) in values.iter_mut().zip(slopes) {
            *value += slope * (s - inside);
        }
        Self { first, values, slopes: slopes.map(|slope| slope * density) }
    }
}
