//! The B-spline prefilter: from samples to coefficients along one direction (Unser, Aldroubi and Eden, 1993; Thévenaz,
//! 2000).
//!
//! The coefficients of the B-spline through the samples solve a banded system with the same row everywhere. It factors into
//! a causal and an anticausal first-order recursion for each pole. Recursions are sequential along a line, so many lines
//! are filtered side by side: `lines[k]` holds sample `k` of each of them.

use crate::simd::lanes::{Fusing, fused};

/// Lines filtered together.
pub(crate) const LINES: usize = 32;

/// Truncation error of the initial sum, relative to the samples.
const INITIAL_TOLERANCE: f64 = 1e-12;

/// Influence of a sample beyond [`warm_up`], relative to the samples: well below the resolution of `f32`.
const WARM_UP_TOLERANCE: f64 = 1e-10;

/// Distance in samples beyond which a sample has no influence in `f32`.
pub(crate) fn warm_up(poles: &[f64]) -> usize {
    poles.iter().map(|&pole| decay_length(pole, WARM_UP_TOLERANCE)).max().unwrap_or(0)
}

/// Replaces the samples of lines of at least two samples by their coefficients, with a mirror boundary at both ends.
#[inline(always)]
pub(crate) fn apply<S: Fusing>(poles: &[f64], lines: &mut [[f32; LINES]]) {
    for &pole in poles {
        apply_pole::<S>(pole, lines);
    }
}

/// Number of samples after which the powers of the pole fall below `tolerance`.
fn decay_length(pole: f64, tolerance: f64) -> usize {
    (tolerance.ln() / pole.abs().ln()).ceil() as usize
}

#[inline(always)]
fn apply_pole<S: Fusing>(pole: f64, lines: &mut [[f32; LINES]]) {
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

/// State of the causal recursion at the first sample: the sum of `pole^k` times sample `-k` of the mirrored line, truncated
/// at [`INITIAL_TOLERANCE`], or over one period if the line is shorter.
#[inline(always)]
fn first_causal(pole: f64, lines: &[[f32; LINES]]) -> [f32; LINES] {
    let last = lines.len() - 1;
    let period = 2 * last;
    let power = |exponent: usize| pole.powf(exponent as f64);
    let mut sum = [0.0; LINES];
    for (k, line) in lines.iter().enumerate().take(decay_length(pole, INITIAL_TOLERANCE)) {
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
                row[crate::filter::mirror::mirror(k as isize + d, size)] += spline[d.unsigned_abs()];
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

    /// `sqrt(3) - 2`.
    fn cubic_poles() -> [f64; 1] {
        [3_f64.sqrt() - 2.0]
    }

    /// `sqrt(135/2 -+ sqrt(17745/4)) +- sqrt(105/4) - 13/2`.
    fn quintic_poles() -> [f64; 2] {
        let (root, offset) = ((17745.0_f64 / 4.0).sqrt(), (105.0_f64 / 4.0).sqrt());
        [(67.5 - root).sqrt() + offset - 6.5, (67.5 + root).sqrt() - offset - 6.5]
    }

    fn check(poles: &[f64], spline: &[f64], samples: &[f64]) {
        let mut lines: Vec<[f32; LINES]> =
            samples.iter().map(|&sample| std::array::from_fn(|line| (sample + line as f64) as f32)).collect();
        apply::<pulp::Scalar>(poles, &mut lines);
        for (k, coefficient) in dense_solve(spline, samples).into_iter().enumerate() {
            for line in [0, LINES - 1] {
                let found = f64::from(lines[k][line]);
                let expected = coefficient + line as f64;
                assert!((found - expected).abs() < 1e-3, "coefficient {k} of {}: {found} {expected}", samples.len());
            }
        }
    }

    proptest! {
        #[test]
        fn coefficients_solve_the_interpolation_system(samples in prop::collection::vec(0.0..255.0_f64, 2..60)) {
            check(&cubic_poles(), &[4.0 / 6.0, 1.0 / 6.0], &samples);
            check(&quintic_poles(), &[66.0 / 120.0, 26.0 / 120.0, 1.0 / 120.0], &samples);
        }
    }

    #[test]
    fn samples_beyond_the_warm_up_have_no_influence() {
        for (poles, expected) in [(&cubic_poles()[..], 18), (&quintic_poles(), 28), (&[], 0)] {
            assert_eq!(warm_up(poles), expected);
            let mut impulse = vec![[0.0; LINES]; 2 * expected + 2];
            impulse[0] = [1.0; LINES];
            apply::<pulp::Scalar>(poles, &mut impulse);
            assert!(impulse[expected + 1][0].abs() < 1e-8, "{}", impulse[expected + 1][0]);
        }
    }
}
