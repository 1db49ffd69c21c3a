//! Weighted sums over the stencils of a block of points: the innermost loop of the library.
//!
//! Rows of a stencil are contiguous in memory, so they are combined first, as vectors; the resulting columns of several
//! points are then transposed into one lane per column. The implementation for [`pulp::Scalar`] is the reference of that
//! for AVX2.

use crate::simd::lanes::{BLOCK, Fusing, Lane, fused};

/// Weights of a block of points along one direction: one lane per tap.
pub(crate) type Weights<const TAPS: usize> = [Lane; TAPS];

/// Coefficients, and the stencils of a block of points.
#[derive(Clone, Copy)]
pub(crate) struct Stencils<'a> {
    pub(crate) data: &'a [f32],
    pub(crate) stride: u32,
    /// Index of the first coefficient of each stencil.
    pub(crate) first: &'a [u32; BLOCK],
}

impl<'a> Stencils<'a> {
    /// The coefficients from the first one of the stencil of point `k` to element `width` of its last row, of `TAPS` rows.
    /// One bounds check for the stencil replaces those of its rows.
    #[inline(always)]
    fn window<const TAPS: usize>(self, k: usize, width: usize) -> &'a [f32] {
        let first = self.first[k] as usize;
        let mut end = first + width;
        // Repeated addition lets the compiler prove that every row lies inside.
        for _ in 1..TAPS {
            end += self.stride as usize;
        }
        &self.data[first..end]
    }
}

/// Weighted sums with an instruction set.
pub(crate) trait Summation: pulp::Simd + Fusing {
    /// Sums the stencils over their rows with each set `rows[s]` of weights, then, for each output `(s, columns)`, over
    /// their columns.
    fn sum<const TAPS: usize, const SETS: usize, const OUTPUTS: usize>(
        self,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        outputs: [(usize, &Weights<TAPS>); OUTPUTS],
        out: &mut [Lane],
    );
}

/// Portable loops.
impl Summation for pulp::Scalar {
    #[inline(always)]
    fn sum<const TAPS: usize, const SETS: usize, const OUTPUTS: usize>(
        self,
        stencils: Stencils<'_>,
        rows: [&Weights<TAPS>; SETS],
        outputs: [(usize, &Weights<TAPS>); OUTPUTS],
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
            for (out, (set, columns)) in out.iter_mut().zip(outputs) {
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
    //! Eight points at a time: rows are combined in registers of four or eight coefficients, then transposed.

    use std::arch::x86_64::{__m128, __m256};

    use pulp::x86::V3;

    use super::{Lane, Stencils, Summation, Weights};
    use crate::interpolation::coefficients::ROW_READ;
    use crate::simd::lanes::BLOCK;

    /// Points transposed together.
    const POINTS: usize = 8;
    /// Largest number of columns of a stencil.
    const COLUMNS: usize = 6;

    impl Summation for V3 {
        #[inline(always)]
        fn sum<const TAPS: usize, const SETS: usize, const OUTPUTS: usize>(
            self,
            stencils: Stencils<'_>,
            rows: [&Weights<TAPS>; SETS],
            outputs: [(usize, &Weights<TAPS>); OUTPUTS],
            out: &mut [Lane],
        ) {
            const { assert!(TAPS <= COLUMNS, "a stencil is at most six coefficients wide") }
            for k in (0..BLOCK).step_by(POINTS) {
                let columns = if TAPS <= 4 {
                    narrow_columns(self, stencils, rows, k)
                } else {
                    wide_columns(self, stencils, rows, k)
                };
                for output in 0..OUTPUTS {
                    let (set, weights) = outputs[output];
                    // Two partial sums halve the latency.
                    let mut sums = [self.avx._mm256_setzero_ps(); 2];
                    for column in 0..TAPS {
                        let sum = &mut sums[column % 2];
                        *sum = self.fma._mm256_fmadd_ps(columns[set][column], eight(&weights[column], k), *sum);
                    }
                    let sum = self.avx._mm256_add_ps(sums[0], sums[1]);
                    let sum: [f32; POINTS] = pulp::cast(sum);
                    out[output][k..k + POINTS].copy_from_slice(&sum);
                }
            }
        }
    }

    /// Columns, summed over the rows, of eight stencils at most four coefficients wide.
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
            // Point `k + i` in the low half of the registers, `k + i + 4` in the high half.
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

    /// Columns, summed over the rows, of eight stencils five or six coefficients wide, whose rows are read eight
    /// coefficients at a time.
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
        let window = stencils.window::<TAPS>(k, ROW_READ);
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

    /// Transposes 4 x 4 matrices in both halves of the registers.
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
    fn four(elements: &[f32]) -> __m128 {
        let mut four = [0.0; 4];
        four.copy_from_slice(&elements[..4]);
        pulp::cast(four)
    }

    #[inline(always)]
    fn eight(elements: &[f32], k: usize) -> __m256 {
        let mut eight = [0.0; 8];
        eight.copy_from_slice(&elements[k..k + 8]);
        pulp::cast(eight)
    }
}
