//! Higher derivatives of the interpolant.

use crate::interpolation::coefficients::Coefficients;
use crate::interpolation::kernel::Kernel;
use crate::interpolation::locate::{Grid, Locations};
use crate::simd::lanes::BLOCK;

/// Most orders of differentiation along one axis, from zero on, that are evaluated together.
const ORDERS: usize = 5;

/// Evaluates derivatives at points given by pixel coordinates; output `i` is the derivative of order `orders[i]`, along the columns
/// and along the rows.
pub(crate) fn evaluate_derivatives<const HALF: usize, const OUTPUTS: usize>(
    coefficients: &Coefficients,
    size: [usize; 2],
    kernel: &Kernel<HALF>,
    points: [&[f64]; 2],
    orders: [[usize; 2]; OUTPUTS],
    out: [&mut [f32]; OUTPUTS],
) {
    pulp::Arch::new().dispatch(Derivatives { coefficients, size, kernel, points, orders, out });
}

struct Derivatives<'a, const HALF: usize, const OUTPUTS: usize> {
    coefficients: &'a Coefficients,
    size: [usize; 2],
    kernel: &'a Kernel<HALF>,
    points: [&'a [f64]; 2],
    orders: [[usize; 2]; OUTPUTS],
    out: [&'a mut [f32]; OUTPUTS],
}

impl<const HALF: usize, const OUTPUTS: usize> pulp::WithSimd for Derivatives<'_, HALF, OUTPUTS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { coefficients, size: [width, height], kernel, points: [u, v], orders, mut out } = self;
        let grid = Grid { width, height, stride: coefficients.stride(), half: HALF };
        let data = coefficients.as_slice();
        let mut locations = Locations::new();
        for start in (0..u.len()).step_by(BLOCK) {
            let end = u.len().min(start + BLOCK);
            locations.locate(grid, &u[start..end], &v[start..end]);
            for k in 0..end - start {
                let [s, t] = [locations.offset[0][k], locations.offset[1][k]];
                let across = weights(kernel, s);
                let down = weights(kernel, t);
                let mut sums = [0.0_f32; OUTPUTS];
                for (j, down) in down.iter().flatten().enumerate() {
                    let first = locations.first[k] as usize + j * grid.stride;
                    let mut row = [0.0_f32; ORDERS];
                    for (across, &value) in across.iter().flatten().zip(&data[first..first + 2 * HALF]) {
                        for (sum, weight) in row.iter_mut().zip(across) {
                            *sum += weight * value;
                        }
                    }
                    for (sum, [p, q]) in sums.iter_mut().zip(orders) {
                        *sum += down[q] * row[p];
                    }
                }
                for (out, sum) in out.iter_mut().zip(sums) {
                    out[start + k] = sum;
                }
            }
        }
    }
}

/// Derivatives of order 0 to 4 of the weight of each tap at the distance `s` from the middle: the taps of both halves, in order.
#[inline(always)]
fn weights<const HALF: usize>(kernel: &Kernel<HALF>, s: f32) -> [[[f32; ORDERS]; HALF]; 2] {
    let mut weights = [[[0.0; ORDERS]; HALF]; 2];
    for i in 0..HALF {
        for order in 0..ORDERS {
            let even = derivative(s, order, |p| kernel.even[i][p], 0, HALF);
            let odd = derivative(s, order, |p| kernel.odd[i][p], 1, HALF);
            weights[0][i][order] = even + odd;
            weights[1][HALF - 1 - i][order] = even - odd;
        }
    }
    weights
}

/// Derivative at `s` of `sum over p of coefficient(p) s^(2 p + shift)`.
#[inline(always)]
fn derivative(s: f32, order: usize, coefficient: impl Fn(usize) -> f32, shift: usize, count: usize) -> f32 {
    let mut sum = 0.0;
    for p in (0..count).rev() {
        let power = 2 * p + shift;
        if power < order {
            break;
        }
        let falling = (power - order + 1..=power).product::<usize>() as f32;
        let rest = (power - order) as i32;
        sum += falling * coefficient(p) * s.powi(rest);
    }
    sum
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use crate::{Image, Interpolation, Interpolator};

    /// Derivative of order `order` of `x^power`.
    fn monomial(x: f64, power: usize, order: usize) -> f64 {
        if power < order {
            return 0.0;
        }
        (power - order + 1..=power).product::<usize>() as f64 * x.powi((power - order) as i32)
    }

    #[test]
    fn derivatives_of_polynomials_are_exact() {
        // Centred and scaled, so that single precision resolves the fourth derivatives.
        let scaled = |x: f64| (x - 20.0) / 20.0;
        for (power_u, power_v) in [(2, 2), (4, 1), (3, 2), (0, 4), (5, 0)] {
            let at = |k: usize| [scaled((k % 41) as f64), scaled((k / 41) as f64)];
            let grey = |[x, y]: [f64; 2]| 1000.0 * monomial(x, power_u, 0) * monomial(y, power_v, 0);
            let image = Image::new(41, 41, (0..41 * 41).map(|k| grey(at(k)) as f32).collect()).unwrap();
            let interpolator = Interpolator::new(image.view(), Interpolation::Bspline5);
            let (u, v) = ([20.3, 22.0, 17.9, 19.5], [21.4, 19.0, 20.1, 24.6]);
            let mut second = [[0.0_f32; 4]; 3];
            let mut fourth = [[0.0_f32; 4]; 5];
            interpolator.second_derivatives(&u, &v, second.each_mut().map(|row| row.as_mut_slice()));
            interpolator.fourth_derivatives(&u, &v, fourth.each_mut().map(|row| row.as_mut_slice()));
            let expected = |k: usize, [p, q]: [usize; 2]| {
                1000.0 * monomial(scaled(u[k]), power_u, p) * monomial(scaled(v[k]), power_v, q)
                    / 20.0_f64.powi((p + q) as i32)
            };
            for k in 0..4 {
                for (row, orders) in second.iter().zip([[2, 0], [1, 1], [0, 2]]) {
                    let difference = f64::from(row[k]) - expected(k, orders);
                    assert!(difference.abs() < 1e-2, "{power_u} {power_v} {orders:?}: {difference}");
                }
                for (row, orders) in fourth.iter().zip([[4, 0], [3, 1], [2, 2], [1, 3], [0, 4]]) {
                    let difference = f64::from(row[k]) - expected(k, orders);
                    assert!(difference.abs() < 1e-2, "{power_u} {power_v} {orders:?}: {difference}");
                }
            }
        }
    }

    #[test]
    fn derivatives_are_nan_outside_the_image() {
        let image = Image::new(9, 9, (0..81).map(|k| k as f32).collect()).unwrap();
        let interpolator = Interpolator::new(image.view(), Interpolation::Bspline3);
        let mut second = [[0.0_f32; 2]; 3];
        interpolator.second_derivatives(&[4.0, 9.0], &[4.0, 4.0], second.each_mut().map(|row| row.as_mut_slice()));
        assert!(second.iter().all(|row| row[0].is_finite() && row[1].is_nan()));
    }
}
