//! Evaluation at many points: block by block, each step over a whole block, with the best instruction set of the processor.

use pulp::Simd;

use crate::interpolation::coefficients::{Coefficients, PADDING};
use crate::interpolation::kernel::Kernel;
use crate::interpolation::locate::{Grid, Locations};
use crate::interpolation::stencil::{Stencils, Summation};
use crate::simd::lanes::{Aligned, BLOCK, Lane};

/// Points of an image.
#[derive(Clone, Copy)]
pub(crate) enum Points<'a> {
    /// Pixel coordinates.
    Absolute(&'a [f64], &'a [f64]),
    /// Distances from a pixel.
    Near([isize; 2], &'a [f32], &'a [f32]),
}

impl Points<'_> {
    /// Number of points; `None` if the coordinates differ in length.
    pub(crate) fn len(self) -> Option<usize> {
        let (u, v) = match self {
            Self::Absolute(u, v) => (u.len(), v.len()),
            Self::Near(_, u, v) => (u.len(), v.len()),
        };
        (u == v).then_some(u)
    }
}

/// Grey levels (`OUTPUTS = 1`), or these and their derivatives along the columns and rows (3).
pub(crate) fn evaluate<const HALF: usize, const TAPS: usize, const OUTPUTS: usize>(
    coefficients: &Coefficients,
    size: [usize; 2],
    kernel: &Kernel<HALF>,
    points: Points<'_>,
    out: [&mut [f32]; OUTPUTS],
) {
    const { assert!(TAPS == 2 * HALF && HALF <= PADDING, "the margin must cover the taps on each side of a point") }
    let grid = Grid { width: size[0], height: size[1], stride: coefficients.stride(), half: HALF };
    #[cfg(target_arch = "x86_64")]
    if let Some(v3) = pulp::x86::V3::try_new() {
        let evaluation =
            Evaluation::<_, HALF, TAPS, OUTPUTS> { coefficients, grid, kernel, points, out, summation: v3 };
        return pulp::Simd::vectorize(v3, evaluation);
    }
    Evaluation::<_, HALF, TAPS, OUTPUTS> { coefficients, grid, kernel, points, out, summation: pulp::Scalar }.run();
}

struct Evaluation<'a, S, const HALF: usize, const TAPS: usize, const OUTPUTS: usize> {
    coefficients: &'a Coefficients,
    grid: Grid,
    kernel: &'a Kernel<HALF>,
    points: Points<'a>,
    out: [&'a mut [f32]; OUTPUTS],
    summation: S,
}

#[cfg(target_arch = "x86_64")]
impl<S: Summation, const HALF: usize, const TAPS: usize, const OUTPUTS: usize> pulp::WithSimd
    for Evaluation<'_, S, HALF, TAPS, OUTPUTS>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<I: pulp::Simd>(self, _: I) {
        self.run();
    }
}

impl<S: Summation, const HALF: usize, const TAPS: usize, const OUTPUTS: usize> Evaluation<'_, S, HALF, TAPS, OUTPUTS> {
    #[inline(always)]
    fn run(mut self) {
        let inside = self.all_inside();
        let mut locations = Aligned(Locations::new());
        let (mut weights, mut derivatives) = (Aligned([[[0.0; BLOCK]; TAPS]; 2]), Aligned([[[0.0; BLOCK]; TAPS]; 2]));
        let mut outputs = Aligned([[0.0; BLOCK]; OUTPUTS]);
        let count = self.out[0].len();
        for start in (0..count).step_by(BLOCK) {
            // The last block is a full one too if there are enough points: some are evaluated twice.
            let start = start.min(count.saturating_sub(BLOCK));
            let end = count.min(start + BLOCK);
            match self.points {
                Points::Absolute(u, v) => locations.0.locate(self.grid, &u[start..end], &v[start..end]),
                Points::Near(origin, u, v) if inside => match (u[start..].first_chunk(), v[start..].first_chunk()) {
                    (Some(u), Some(v)) => locations.0.locate_near(self.grid, origin, u, v),
                    _ => locations.0.locate_near(self.grid, origin, &padded(&u[start..end]), &padded(&v[start..end])),
                },
                Points::Near(origin, u, v) => {
                    let (u, v) = (padded(&u[start..end]), padded(&v[start..end]));
                    let (mut absolute_u, mut absolute_v) = ([0.0; BLOCK], [0.0; BLOCK]);
                    for k in 0..BLOCK {
                        absolute_u[k] = origin[0] as f64 + f64::from(u[k]);
                        absolute_v[k] = origin[1] as f64 + f64::from(v[k]);
                    }
                    locations.0.locate(self.grid, &absolute_u, &absolute_v);
                }
            }
            self.evaluate_block(&locations.0, &mut weights.0, &mut derivatives.0, &mut outputs.0);
            for (out, lane) in self.out.iter_mut().zip(&outputs.0) {
                match out[start..].first_chunk_mut() {
                    Some(out) => *out = *lane,
                    None => copy_some(&mut out[start..end], lane),
                }
            }
        }
    }

    /// Evaluates the image at a block of points.
    #[inline(always)]
    fn evaluate_block(
        &self,
        locations: &Locations,
        [columns, rows]: &mut [[Lane; TAPS]; 2],
        [column_derivatives, row_derivatives]: &mut [[Lane; TAPS]; 2],
        outputs: &mut [Lane; OUTPUTS],
    ) {
        let stride = self.grid.stride as u32;
        let stencils = Stencils { data: self.coefficients.as_slice(), stride, first: &locations.first };
        let [u, v] = &locations.offset;
        self.kernel.weights::<S, TAPS>(u, columns);
        self.kernel.weights::<S, TAPS>(v, rows);
        if OUTPUTS == 1 {
            self.summation.sum(stencils, [&*rows], [(0, &*columns)], outputs);
        } else {
            self.kernel.derivatives::<S, TAPS>(u, column_derivatives);
            self.kernel.derivatives::<S, TAPS>(v, row_derivatives);
            let pairs = [(0, &*columns), (0, &*column_derivatives), (1, &*columns)];
            self.summation.sum(stencils, [&*rows, &*row_derivatives], pairs, outputs);
        }
    }

    /// True if all points are given by their distances from a pixel and lie inside the image.
    #[inline(always)]
    fn all_inside(&self) -> bool {
        let Points::Near(origin, u, v) = self.points else { return false };
        let fits = |origin: isize, [low, high]: [f32; 2], size: usize| {
            origin as f64 + f64::from(low) >= -0.5 && origin as f64 + f64::from(high) <= size as f64 - 0.5
        };
        !u.is_empty()
            && fits(origin[0], extent(self.summation, u), self.grid.width)
            && fits(origin[1], extent(self.summation, v), self.grid.height)
    }
}

/// Independent chains of comparisons, to hide their latency.
const CHAINS: usize = 4;

/// Minimum and maximum; NaN if a number is not finite.
#[inline(always)]
fn extent<S: Simd>(simd: S, numbers: &[f32]) -> [f32; 2] {
    let (vectors, rest) = S::as_simd_f32s(numbers);
    let infinity = simd.splat_f32s(f32::INFINITY);
    let (mut lows, mut highs) = ([infinity; CHAINS], [simd.neg_f32s(infinity); CHAINS]);
    // A comparison may lose a NaN, a product with zero does not.
    let mut zeros = [simd.splat_f32s(0.0); CHAINS];
    let zero = zeros[0];
    for vectors in vectors.chunks(CHAINS) {
        for (chain, &vector) in vectors.iter().enumerate() {
            lows[chain] = simd.min_f32s(lows[chain], vector);
            highs[chain] = simd.max_f32s(highs[chain], vector);
            zeros[chain] = simd.mul_add_e_f32s(vector, zero, zeros[chain]);
        }
    }
    let low = lows.into_iter().fold(infinity, |low, chain| simd.min_f32s(low, chain));
    let high = highs.into_iter().fold(simd.neg_f32s(infinity), |high, chain| simd.max_f32s(high, chain));
    let zero = zeros.into_iter().fold(zero, |zero, chain| simd.add_f32s(zero, chain));
    let (mut low, mut high, mut zero) =
        (simd.reduce_min_f32s(low), simd.reduce_max_f32s(high), simd.reduce_sum_f32s(zero));
    for &number in rest {
        (low, high) = (low.min(number), high.max(number));
        zero += 0.0 * number;
    }
    if zero == 0.0 { [low, high] } else { [f32::NAN; 2] }
}

/// Copies less than a block. Kept out of line, so that the copy of a full block needs no call.
#[cold]
#[inline(never)]
fn copy_some(out: &mut [f32], lane: &Lane) {
    out.copy_from_slice(&lane[..out.len()]);
}

/// A block that begins with `numbers`, filled up with the first of them.
#[inline(always)]
fn padded(numbers: &[f32]) -> Lane {
    let mut lane = [numbers[0]; BLOCK];
    lane[..numbers.len()].copy_from_slice(numbers);
    lane
}

#[cfg(test)]
mod tests {
    use fedic_memory::AlignedBuffer;
    use proptest::prelude::*;

    use super::*;
    use crate::filter::line::LineFilter;
    use crate::filter::mirror::mirror;
    use crate::interpolation::kernel::AnyKernel;
    use crate::interpolation::method::Interpolation;
    use crate::view::ImageView;

    const SIZE: [usize; 2] = [60, 50];
    const ORIGIN: [isize; 2] = [30, 25];

    fn grey(u: usize, v: usize) -> f32 {
        let index = v * SIZE[0] + u;
        (index * index * 7919 / 13 % 256) as f32
    }

    /// The image, taken as coefficients.
    fn coefficients() -> Coefficients {
        let levels: Vec<f32> = (0..SIZE[0] * SIZE[1]).map(|i| grey(i % SIZE[0], i / SIZE[0])).collect();
        let identity = LineFilter { weights: &[1.0], poles: &[] };
        Coefficients::new(ImageView::new_unchecked(SIZE[0], SIZE[1], &levels), &identity, AlignedBuffer::default())
    }

    /// Values and derivatives with the best instruction set of the processor, and with portable code.
    fn best_and_portable<const HALF: usize, const TAPS: usize>(
        kernel: &Kernel<HALF>,
        points: Points<'_>,
    ) -> [[Vec<f32>; 3]; 2] {
        let coefficients = coefficients();
        let count = points.len().unwrap_or_default();
        let empty = || [(); 3].map(|()| vec![0.0; count]);
        let (mut best, mut portable) = (empty(), empty());
        evaluate::<HALF, TAPS, 3>(&coefficients, SIZE, kernel, points, best.each_mut().map(Vec::as_mut_slice));
        let grid = Grid { width: SIZE[0], height: SIZE[1], stride: coefficients.stride(), half: HALF };
        let (coefficients, out) = (&coefficients, portable.each_mut().map(Vec::as_mut_slice));
        Evaluation::<_, HALF, TAPS, 3> { coefficients, grid, kernel, points, out, summation: pulp::Scalar }.run();
        [best, portable]
    }

    /// Value and derivatives at a point by the definition, in double precision.
    fn direct_sum<const HALF: usize, const TAPS: usize>(kernel: &Kernel<HALF>, u: f32, v: f32) -> [f64; 3] {
        let weights = |x: f32| {
            let (mut weights, mut derivatives) = ([[0.0; BLOCK]; TAPS], [[0.0; BLOCK]; TAPS]);
            kernel.weights::<pulp::Scalar, TAPS>(&[x - x.floor() - 0.5; BLOCK], &mut weights);
            kernel.derivatives::<pulp::Scalar, TAPS>(&[x - x.floor() - 0.5; BLOCK], &mut derivatives);
            [weights, derivatives].map(|taps| taps.map(|lane| f64::from(lane[0])))
        };
        let ([wu, du], [wv, dv]) = (weights(u), weights(v));
        let position =
            |origin: isize, x: f32, tap: usize| origin + x.floor() as isize + tap as isize + 1 - HALF as isize;
        let mut sums = [0.0; 3];
        for row in 0..TAPS {
            for column in 0..TAPS {
                let pixel =
                    grey(mirror(position(ORIGIN[0], u, column), SIZE[0]), mirror(position(ORIGIN[1], v, row), SIZE[1]));
                for (sum, weight) in
                    sums.iter_mut().zip([wu[column] * wv[row], du[column] * wv[row], wu[column] * dv[row]])
                {
                    *sum += weight * f64::from(pixel);
                }
            }
        }
        sums
    }

    fn check<const HALF: usize, const TAPS: usize>(kernel: &Kernel<HALF>, u: &[f32], v: &[f32]) {
        let inside = |u: f32, v: f32| {
            let (u, v) = (f64::from(u) + 30.0, f64::from(v) + 25.0);
            (-0.5..=59.5).contains(&u) && (-0.5..=49.5).contains(&v)
        };
        for outputs in best_and_portable::<HALF, TAPS>(kernel, Points::Near(ORIGIN, u, v)) {
            for k in 0..u.len() {
                let expected = direct_sum::<HALF, TAPS>(kernel, u[k], v[k]);
                for (output, expected) in outputs.iter().zip(expected) {
                    let found = f64::from(output[k]);
                    let agree = if inside(u[k], v[k]) { (found - expected).abs() < 1e-3 } else { found.is_nan() };
                    assert!(agree, "at ({}, {}): {found} {expected}", u[k], v[k]);
                }
            }
        }
    }

    #[test]
    fn evaluating_zero_points_is_a_no_op() {
        for interpolation in Interpolation::ALL {
            for points in [Points::Near(ORIGIN, &[], &[]), Points::Absolute(&[], &[])] {
                let [best, portable] = match &interpolation.method().kernel {
                    AnyKernel::Two(kernel) => best_and_portable::<1, 2>(kernel, points),
                    AnyKernel::Four(kernel) => best_and_portable::<2, 4>(kernel, points),
                    AnyKernel::Six(kernel) => best_and_portable::<3, 6>(kernel, points),
                };
                assert!(best.iter().chain(&portable).all(Vec::is_empty));
            }
        }
    }

    proptest! {
        #[test]
        fn evaluation_agrees_with_direct_sums_on_every_instruction_set(
            points in prop::collection::vec((-31.0..31.0_f32, -26.0..26.0_f32), 1..80),
            inside in any::<bool>(),
        ) {
            let scale = if inside { 0.9 } else { 1.0 };
            // Away from the pixel centres, where the derivative of a linear interpolant jumps.
            let off_centre = |x: f32| if (x - x.round()).abs() < 1e-3 { x.round() + 0.25 } else { x };
            let (u, v): (Vec<f32>, Vec<f32>) =
                points.into_iter().map(|(u, v)| (off_centre(scale * u), off_centre(scale * v))).unzip();
            for interpolation in Interpolation::ALL {
                match &interpolation.method().kernel {
                    AnyKernel::Two(kernel) => check::<1, 2>(kernel, &u, &v),
                    AnyKernel::Four(kernel) => check::<2, 4>(kernel, &u, &v),
                    AnyKernel::Six(kernel) => check::<3, 6>(kernel, &u, &v),
                }
            }
        }
    }
}
