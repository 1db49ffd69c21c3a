//! Reading an image at many points: block by block, one step at a time over the whole block, with the best instructions that
//! the processor has.

use pulp::Simd;

use crate::coefficients::Coefficients;
use crate::kernel::Kernel;
use crate::lanes::{Aligned, BLOCK, Lane};
use crate::places::{Grid, Places};
use crate::stencil::{Stencils, Summation};

/// Points of an image.
#[derive(Clone, Copy)]
pub(crate) enum Points<'a> {
    /// By their pixel coordinates.
    Absolute(&'a [f64], &'a [f64]),
    /// By their distances from a pixel.
    Near([isize; 2], &'a [f32], &'a [f32]),
}

impl Points<'_> {
    /// Number of points, if both coordinates have as many.
    pub(crate) fn len(self) -> Option<usize> {
        let (u, v) = match self {
            Self::Absolute(u, v) => (u.len(), v.len()),
            Self::Near(_, u, v) => (u.len(), v.len()),
        };
        (u == v).then_some(u)
    }
}

/// Grey levels (`READINGS = 1`), or these and their derivatives along the columns and rows (3).
pub(crate) fn read<const HALF: usize, const TAPS: usize, const READINGS: usize>(
    coefficients: &Coefficients,
    size: [usize; 2],
    kernel: &Kernel<HALF>,
    points: Points<'_>,
    out: [&mut [f32]; READINGS],
) {
    let grid = Grid { width: size[0], height: size[1], stride: coefficients.stride(), half: HALF };
    #[cfg(target_arch = "x86_64")]
    if let Some(v3) = pulp::x86::V3::try_new() {
        let reading = Reading::<_, HALF, TAPS, READINGS> { coefficients, grid, kernel, points, out, summation: v3 };
        return pulp::Simd::vectorize(v3, reading);
    }
    Reading::<_, HALF, TAPS, READINGS> { coefficients, grid, kernel, points, out, summation: pulp::Scalar }.run();
}

struct Reading<'a, S, const HALF: usize, const TAPS: usize, const READINGS: usize> {
    coefficients: &'a Coefficients,
    grid: Grid,
    kernel: &'a Kernel<HALF>,
    points: Points<'a>,
    out: [&'a mut [f32]; READINGS],
    summation: S,
}

#[cfg(target_arch = "x86_64")]
impl<S: Summation, const HALF: usize, const TAPS: usize, const READINGS: usize> pulp::WithSimd
    for Reading<'_, S, HALF, TAPS, READINGS>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<I: pulp::Simd>(self, _: I) {
        self.run();
    }
}

impl<S: Summation, const HALF: usize, const TAPS: usize, const READINGS: usize> Reading<'_, S, HALF, TAPS, READINGS> {
    #[inline(always)]
    fn run(mut self) {
        let inside = self.all_inside();
        let mut places = Aligned(Places::new());
        let (mut weights, mut slopes) = (Aligned([[[0.0; BLOCK]; TAPS]; 2]), Aligned([[[0.0; BLOCK]; TAPS]; 2]));
        let mut readings = Aligned([[0.0; BLOCK]; READINGS]);
        let count = self.out[0].len();
        for start in (0..count).step_by(BLOCK) {
            // The last block is a whole one too, where there are as many points: some are read twice.
            let start = start.min(count.saturating_sub(BLOCK));
            let end = count.min(start + BLOCK);
            match self.points {
                Points::Absolute(u, v) => places.0.locate(self.grid, &u[start..end], &v[start..end]),
                Points::Near(origin, u, v) if inside => match (u[start..].first_chunk(), v[start..].first_chunk()) {
                    (Some(u), Some(v)) => places.0.locate_near(self.grid, origin, u, v),
                    _ => places.0.locate_near(self.grid, origin, &padded(&u[start..end]), &padded(&v[start..end])),
                },
                Points::Near(origin, u, v) => {
                    let (u, v) = (padded(&u[start..end]), padded(&v[start..end]));
                    let (mut absolute_u, mut absolute_v) = ([0.0; BLOCK], [0.0; BLOCK]);
                    for k in 0..BLOCK {
                        absolute_u[k] = origin[0] as f64 + f64::from(u[k]);
                        absolute_v[k] = origin[1] as f64 + f64::from(v[k]);
                    }
                    places.0.locate(self.grid, &absolute_u, &absolute_v);
                }
            }
            self.read_block(&places.0, &mut weights.0, &mut slopes.0, &mut readings.0);
            for (out, reading) in self.out.iter_mut().zip(&readings.0) {
                match out[start..].first_chunk_mut() {
                    Some(out) => *out = *reading,
                    None => copy_some(&mut out[start..end], reading),
                }
            }
        }
    }

    /// Reads the image at the points located at `places`.
    #[inline(always)]
    fn read_block(
        &self,
        places: &Places,
        [columns, rows]: &mut [[Lane; TAPS]; 2],
        [column_slopes, row_slopes]: &mut [[Lane; TAPS]; 2],
        readings: &mut [Lane; READINGS],
    ) {
        let stride = self.grid.stride as u32;
        let stencils = Stencils { data: self.coefficients.as_slice(), stride, first: &places.first };
        let [u, v] = &places.middle;
        self.kernel.weights::<S, TAPS>(u, columns);
        self.kernel.weights::<S, TAPS>(v, rows);
        if READINGS == 1 {
            self.summation.sum(stencils, [&*rows], [(0, &*columns)], readings);
        } else {
            self.kernel.slopes::<S, TAPS>(u, column_slopes);
            self.kernel.slopes::<S, TAPS>(v, row_slopes);
            let pairs = [(0, &*columns), (0, &*column_slopes), (1, &*columns)];
            self.summation.sum(stencils, [&*rows, &*row_slopes], pairs, readings);
        }
    }

    /// Whether all points, given by their distances from a pixel, lie inside the image.
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

/// Vectors compared side by side, so that none waits for the one before.
const CHAINS: usize = 4;

/// Least and greatest of some numbers; NaN where one of them is not finite.
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

/// Copies less than a block. Apart, so that the copy of a whole one needs no call.
#[cold]
#[inline(never)]
fn copy_some(out: &mut [f32], reading: &Lane) {
    out.copy_from_slice(&reading[..out.len()]);
}

/// The numbers of a block, the first of them repeated after the last.
#[inline(always)]
fn padded(numbers: &[f32]) -> Lane {
    let mut lane = [numbers[0]; BLOCK];
    lane[..numbers.len()].copy_from_slice(numbers);
    lane
}

#[cfg(test)]
mod tests {
    use fedic_memory::Row;
    use proptest::prelude::*;

    use super::*;
    use crate::kernel::{BSPLINE3, BSPLINE5};
    use crate::view::ImageView;

    const SIZE: [usize; 2] = [60, 50];

    fn coefficients() -> Coefficients {
        let noise: Vec<f32> = (0..SIZE[0] * SIZE[1]).map(|i| (i * i * 7919 / 13 % 256) as f32).collect();
        Coefficients::samples(ImageView::of_checked(SIZE[0], SIZE[1], &noise), Row::default())
    }

    /// Values and derivatives by the processor's best instructions, and by plain loops.
    fn both<const HALF: usize, const TAPS: usize>(kernel: &Kernel<HALF>, points: Points<'_>) -> [[Vec<f32>; 3]; 2] {
        let coefficients = coefficients();
        let count = points.len().unwrap_or_default();
        let empty = || [(); 3].map(|()| vec![0.0; count]);
        let (mut best, mut plain) = (empty(), empty());
        read::<HALF, TAPS, 3>(&coefficients, SIZE, kernel, points, best.each_mut().map(Vec::as_mut_slice));
        let grid = Grid { width: SIZE[0], height: SIZE[1], stride: coefficients.stride(), half: HALF };
        let (coefficients, out) = (&coefficients, plain.each_mut().map(Vec::as_mut_slice));
        Reading::<_, HALF, TAPS, 3> { coefficients, grid, kernel, points, out, summation: pulp::Scalar }.run();
        [best, plain]
    }

    #[test]
    fn no_point_is_read_without_a_murmur() {
        for points in [Points::Near([30, 25], &[], &[]), Points::Absolute(&[], &[])] {
            let [best, _] = both::<2, 4>(&BSPLINE3, points);
            assert!(best.iter().all(Vec::is_empty));
        }
    }

    proptest! {
        #[test]
        fn the_fast_way_equals_the_plain_one(
            places in prop::collection::vec((-31.0..31.0_f32, -26.0..26.0_f32), 1..80),
            inside in any::<bool>(),
        ) {
            let scale = if inside { 0.9 } else { 1.0 };
            let (u, v): (Vec<f32>, Vec<f32>) = places.into_iter().map(|(u, v)| (scale * u, scale * v)).unzip();
            let points = Points::Near([30, 25], &u, &v);
            for [best, plain] in [both::<2, 4>(&BSPLINE3, points), both::<3, 6>(&BSPLINE5, points)] {
                for (best, plain) in best.iter().flatten().zip(plain.iter().flatten()) {
                    prop_assert!((best - plain).abs() < 1e-3 || best.is_nan() && plain.is_nan(), "{best} {plain}");
                }
            }
        }
    }
}
