//! From samples to B-spline coefficients along one direction (Unser, Aldroubi and Eden, 1993; Thévenaz, 2000).
//!
//! A B-spline goes through the samples if its coefficients solve a banded system with the same row everywhere. That system
//! factors into first-order recursions, one down and one up the line for each pole. They are sequential along a line, so
//! many lines are filtered side by side: a line of samples is a slice of lanes, one lane per line.

use crate::lanes::{Fusing, fused};

/// Lines filtered together.
pub(crate) const LANES: usize = 32;

/// What a truncated sum may lose, relative to the samples.
const INITIAL_TOLERANCE: f64 = 1e-12;

/// What a line cut short may lose, relative to the samples: well below the resolution of `f32`.
const WARM_UP_TOLERANCE: f64 = 1e-10;

/// The interpolating prefilter of one B-spline degree, known by the poles inside the unit circle.
pub(crate) struct Prefilter {
    poles: &'static [f64],
}

/// For cubic B-splines: `sqrt(3) - 2`.
pub(crate) const CUBIC: Prefilter = Prefilter { poles: &[-0.267_949_192_431_122_7] };

/// For quintic B-splines: `sqrt(135/2 -+ sqrt(17745/4)) +- sqrt(105/4) - 13/2`.
pub(crate) const QUINTIC: Prefilter = Prefilter { poles: &[-0.430_575_347_099_973_8, -0.043_096_288_203_264_65] };

impl Prefilter {
    /// Number of samples after which those further away no longer matter.
    pub(crate) fn warm_up(&self) -> usize {
        self.poles.iter().map(|&pole| reach(pole, WARM_UP_TOLERANCE)).max().unwrap_or(0)
    }

    /// Replaces the samples of at least two per lane by their coefficients, mirror boundary at both ends.
    #[inline(always)]
    pub(crate) fn apply<S: Fusing>(&self, lines: &mut [[f32; LANES]]) {
        for &pole in self.poles {
            apply_pole::<S>(pole, lines);
        }
    }
}

fn reach(pole: f64, tolerance: f64) -> usize {
    (tolerance.ln() / pole.abs().ln()).ceil() as usize
}

#[inline(always)]
fn apply_pole<S: Fusing>(pole: f64, lines: &mut [[f32; LANES]]) {
    let gain = ((1.0 - pole) * (1.0 - 1.0 / pole)) as f32;
    let last_factor = (pole / (pole * pole - 1.0)) as f32;
    let mut state = first_causal(pole, lines);
    state.iter_mut().for_each(|value| *value *= gain);
    let pole = pole as f32;

    let mut before_last = state;
    for (index, line) in lines.iter_mut().enumerate() {
        if index > 0 {
            before_last = state;
            for (state, &sample) in state.iter_mut().zip(&*line) {
                *state = fused::<S>(pole, *state, gain * sample);
            }
        }
        *line = state;
    }

    for (state, &before_last) in state.iter_mut().zip(&before_last) {
        *state = last_factor * (*state + pole * before_last);
    }
    for (index, line) in lines.iter_mut().rev().enumerate() {
        if index > 0 {
            for (state, &causal) in state.iter_mut().zip(&*line) {
                *state = fused::<S>(pole, *state, -pole * causal);
            }
        }
        *line = state;
    }
}

/// State of the recursion down the line at its first sample: the sum of `pole^k` times sample `-k` of the mirrored line, over
/// one period when the line is short, as far as it matters when it is long.
#[inline(always)]
fn first_causal(pole: f64, lines: &[[f32; LANES]]) -> [f32; LANES] {
    let last = lines.len() - 1;
    let period = 2 * last;
    let power = |exponent: usize| pole.powf(exponent as f64);
    let mut sum = [0.0; LANES];
    for (k, line) in lines.iter().enumerate().take(reach(pole, INITIAL_TOLERANCE)) {
        let twice = k > 0 && k < last;
        let weight = (power(k) + if twice { power(period - k) } else { 0.0 }) / (1.0 - power(period));
        for (sum, &sample) in sum.iter_mut().zip(line) {
            *sum += weight as f32 * sample;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Solves `sum over d of b_spline[|d|] c[mirror(k + d)] = sample[k]` by Gaussian elimination with pivoting.
    fn dense_solve(spline: &[f64], samples: &[f64]) -> Vec<f64> {
        let size = samples.len();
        let mut matrix = vec![vec![0.0; size + 1]; size];
        for (k, row) in matrix.iter_mut().enumerate() {
            row[size] = samples[k];
            for d in 1 - spline.len() as isize..spline.len() as isize {
                row[crate::mirror::mirror(k as isize + d, size)] += spline[d.unsigned_abs()];
            }
        }
        for pivot in 0..size {
            let best = (pivot..size).max_by(|&a, &b| matrix[a][pivot].abs().total_cmp(&matrix[b][pivot].abs()));
            matrix.swap(pivot, best.unwrap_or(pivot));
            for row in 0..size {
                if row != pivot {
                    let factor = matrix[row][pivot] / matrix[pivot][pivot];
                    for column in pivot..=size {
                        matrix[row][column] -= factor * matrix[pivot][column];
                    }
                }
            }
        }
        (0..size).map(|k| matrix[k][size] / matrix[k][k]).collect()
    }

    fn check(prefilter: &Prefilter, spline: &[f64], samples: &[f64]) {
        let mut lines: Vec<[f32; LANES]> =
            samples.iter().map(|&sample| std::array::from_fn(|lane| (sample + lane as f64) as f32)).collect();
        prefilter.apply::<pulp::Scalar>(&mut lines);
        for (k, coefficient) in dense_solve(spline, samples).into_iter().enumerate() {
            for lane in [0, LANES - 1] {
                let found = f64::from(lines[k][lane]);
                let expected = coefficient + lane as f64;
                assert!((found - expected).abs() < 1e-3, "coefficient {k} of {}: {found} {expected}", samples.len());
            }
        }
    }

    proptest! {
        #[test]
        fn coefficients_solve_the_interpolation_system(samples in prop::collection::vec(0.0..255.0_f64, 2..60)) {
            check(&CUBIC, &[4.0 / 6.0, 1.0 / 6.0], &samples);
            check(&QUINTIC, &[66.0 / 120.0, 26.0 / 120.0, 1.0 / 120.0], &samples);
        }
    }

    #[test]
    fn warm_up_is_long_enough() {
        for (prefilter, expected) in [(&CUBIC, 18), (&QUINTIC, 28)] {
            assert_eq!(prefilter.warm_up(), expected);
            let mut impulse = vec![[0.0; LANES]; 2 * expected + 1];
            impulse[0] = [1.0; LANES];
            prefilter.apply::<pulp::Scalar>(&mut impulse);
            assert!(impulse[expected][0].abs() < 1e-8, "{}", impulse[expected][0]);
        }
    }
}
