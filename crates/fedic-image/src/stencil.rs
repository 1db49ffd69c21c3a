//! The weighted sums over the stencils of a block of points: the innermost loop of the library.
//!
//! Rows of a stencil are contiguous in memory, so they are combined first, each as a whole, and the columns left of several
//! points are then turned into one lane per column. [`pulp::Scalar`] says it plainly; the version for AVX2 must agree with it.

use crate::lanes::{BLOCK, Fusing, Lane, fused};

/// The weights of a block along one direction: one lane per tap.
pub(crate) type Weights<const TAPS: usize> = [Lane; TAPS];

/// Coefficients, and where the stencils of a block begin.
#[derive(Clone, Copy)]
pub(crate) struct Stencils<'a> {
    pub(crate) data: &'a [f32],
    pub(crate) stride: u32,
    pub(crate) first: &'a [u32; BLOCK],
}

impl<'a> Stencils<'a> {
    /// The coefficients from the first of the stencil of point `k` to `width` of its last row, of which there are `TAPS`. A look
    /// at the bounds of all of them spares those of each row, and costs little where nothing can overflow.
    #[inline(always)]
    fn window<const TAPS: usize>(self, k: usize, width: usize) -> &'a [f32] {
        let first = self.first[k] as usize;
        let mut end = first + width;
        // By additions, in which the compiler sees that no row lies beyond.
        for _ in 1..TAPS {
            end += self.stride as usize;
        }
        &self.data[first..end]
    }
}

/// A way of summing, for an instruction set.
pub(crate) trait Summation: pulp::Simd + Fusing {
    /// For each set `s` of row weights, sums the stencils over their rows with `rows[s]`; then, for each pair `(s, columns)`
    /// of `readings`, over their columns.
    fn sum<const TAPS: usize, const SETS: usize, const READINGS: usize>(
        self,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        readings: [(usize, &Weights<TAPS>); READINGS],
        out: &mut [Lane],
    );
}

/// Plain loops, for any processor.
impl Summation for pulp::Scalar {
    #[inline(always)]
    fn sum<const TAPS: usize, const SETS: usize, const READINGS: usize>(
        self,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        readings: [(usize, &Weights<TAPS>); READINGS],
        out: &mut [Lane],
    ) {
        for k in 0..BLOCK {
            let mut lines = [[0.0; TAPS]; SETS];
            let window = stencils.window::<TAPS>(k, TAPS);
            for row in 0..TAPS {
                let coefficients = &window[row * stencils.stride as usize..][..TAPS];
                for set in 0..SETS {
                    for column in 0..TAPS {
                        lines[set][column] = fused::<Self>(rows[set][row][k], coefficients[column], lines[set][column]);
                    }
                }
            }
            for (out, (set, columns)) in out.iter_mut().zip(readings) {
                out[k] = 0.0;
                for column in 0..TAPS {
                    out[k] = fused::<Self>(lines[set][column], columns[column][k], out[k]);
                }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2 {
    //! Eight points at a time: rows combined in registers of four or eight coefficients, columns by transposition.

    use std::arch::x86_64::{__m128, __m256};

    use pulp::x86::V3;

    use super::{Lane, Stencils, Summation, Weights};
    use crate::lanes::BLOCK;

    /// Points whose stencils are transposed together.
    const POINTS: usize = 8;
    /// Most columns of a stencil.
    const COLUMNS: usize = 6;

    impl Summation for V3 {
        #[inline(always)]
        fn sum<const TAPS: usize, const SETS: usize, const READINGS: usize>(
            self,
            stencils: Stencils<'_>,
            rows: [&Weights<TAPS>; SETS],
            readings: [(usize, &Weights<TAPS>); READINGS],
            out: &mut [Lane],
        ) {
            for k in (0..BLOCK).step_by(POINTS) {
                let columns = if TAPS <= 4 {
                    narrow_columns(self, stencils, rows, k)
                } else {
                    wide_columns(self, stencils, rows, k)
                };
                for reading in 0..READINGS {
                    let (set, weights) = readings[reading];
                    // Two sums side by side: half as long to wait for.
                    let mut sums = [self.avx._mm256_setzero_ps(); 2];
                    for column in 0..TAPS {
                        let sum = &mut sums[column % 2];
                        *sum = self.fma._mm256_fmadd_ps(columns[set][column], eight(&weights[column], k), *sum);
                    }
                    let sum = self.avx._mm256_add_ps(sums[0], sums[1]);
                    let sum: [f32; POINTS] = pulp::cast(sum);
                    out[reading][k..k + POINTS].copy_from_slice(&sum);
                }
            }
        }
    }

    /// The columns, summed over the rows, of eight stencils at most four coefficients wide.
    #[inline(always)]
    fn narrow_columns<const TAPS: usize, const SETS: usize>(
        v3: V3,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        k: usize,
    ) -> [[__m256; COLUMNS]; SETS] {
        let zero = v3.avx._mm256_setzero_ps();
        let mut lines = [[zero; 4]; SETS];
        for i in 0..4 {
            // Points `k + i` and `k + i + 4` in two halves.
            let [low, high] = [k + i, k + i + 4].map(|k| stencils.window::<TAPS>(k, 4));
            let mut start = 0;
            for row in 0..TAPS {
                let low = v3.avx._mm256_castps128_ps256(four(&low[start..]));
                let coefficients = v3.avx._mm256_insertf128_ps::<1>(low, four(&high[start..]));
                start += stencils.stride as usize;
                for set in 0..SETS {
                    let weights = eight(&rows[set][row], k);
                    let weight = match i {
                        0 => v3.avx._mm256_permute_ps::<0x00>(weights),
                        1 => v3.avx._mm256_permute_ps::<0x55>(weights),
                        2 => v3.avx._mm256_permute_ps::<0xaa>(weights),
                        _ => v3.avx._mm256_permute_ps::<0xff>(weights),
                    };
                    lines[set][i] = v3.fma._mm256_fmadd_ps(weight, coefficients, lines[set][i]);
                }
            }
        }
        let mut columns = [[zero; COLUMNS]; SETS];
        for set in 0..SETS {
            let transposed = transpose(v3, lines[set]);
            columns[set][..4].copy_from_slice(&transposed);
        }
        columns
    }

    /// The same of stencils wider than four, whose rows are read eight coefficients at a time.
    #[inline(always)]
    fn wide_columns<const TAPS: usize, const SETS: usize>(
        v3: V3,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        k: usize,
    ) -> [[__m256; COLUMNS]; SETS] {
        let zero = v3.avx._mm256_setzero_ps();
        let (mut first_four, mut last_four) = ([[zero; 4]; SETS], [[zero; 4]; SETS]);
        for i in 0..4 {
            let low = wide_line(v3, stencils, rows, k + i);
            let high = wide_line(v3, stencils, rows, k + i + 4);
            for set in 0..SETS {
                first_four[set][i] = v3.avx._mm256_permute2f128_ps::<0x20>(low[set], high[set]);
                last_four[set][i] = v3.avx._mm256_permute2f128_ps::<0x31>(low[set], high[set]);
            }
        }
        let mut columns = [[zero; COLUMNS]; SETS];
        for set in 0..SETS {
            let transposed = transpose(v3, first_four[set]);
            columns[set][..4].copy_from_slice(&transposed);
            let transposed = transpose(v3, last_four[set]);
            columns[set][4..].copy_from_slice(&transposed[..COLUMNS - 4]);
        }
        columns
    }

    /// The stencil of point `k`, summed over its rows.
    #[inline(always)]
    fn wide_line<const TAPS: usize, const SETS: usize>(
        v3: V3,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        k: usize,
    ) -> [__m256; SETS] {
        let window = stencils.window::<TAPS>(k, 8);
        let mut line = [v3.avx._mm256_setzero_ps(); SETS];
        let mut start = 0;
        for row in 0..TAPS {
            let coefficients = eight(window, start);
            start += stencils.stride as usize;
            for set in 0..SETS {
                line[set] = v3.fma._mm256_fmadd_ps(v3.avx._mm256_set1_ps(rows[set][row][k]), coefficients, line[set]);
            }
        }
        line
    }

    /// Four by four, in both halves.
    #[inline(always)]
    fn transpose(v3: V3, lines: [__m256; 4]) -> [__m256; 4] {
        let low = [v3.avx._mm256_unpacklo_ps(lines[0], lines[1]), v3.avx._mm256_unpacklo_ps(lines[2], lines[3])];
        let high = [v3.avx._mm256_unpackhi_ps(lines[0], lines[1]), v3.avx._mm256_unpackhi_ps(lines[2], lines[3])];
        [
            v3.avx._mm256_shuffle_ps::<0x44>(low[0], low[1]),
            v3.avx._mm256_shuffle_ps::<0xee>(low[0], low[1]),
            v3.avx._mm256_shuffle_ps::<0x44>(high[0], high[1]),
            v3.avx._mm256_shuffle_ps::<0xee>(high[0], high[1]),
        ]
    }

    #[inline(always)]
    fn four(numbers: &[f32]) -> __m128 {
        let mut four = [0.0; 4];
        four.copy_from_slice(&numbers[..4]);
        pulp::cast(four)
    }

    #[inline(always)]
    fn eight(numbers: &[f32], k: usize) -> __m256 {
        let mut eight = [0.0; 8];
        eight.copy_from_slice(&numbers[k..k + 8]);
        pulp::cast(eight)
    }
}
