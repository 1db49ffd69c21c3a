//! Rows become columns.

use crate::lanes::Fusing;

/// A way of transposing, for an instruction set.
pub(crate) trait Transposition: Fusing {
    /// Writes the numbers of `rows` rows and `columns` columns, whose rows begin every `stride` numbers, as `columns` rows, which
    /// begin every `to_stride` numbers.
    fn transpose(self, size: [usize; 2], from: &[f32], stride: usize, to: &mut [f32], to_stride: usize);
}

/// Plain loops, for any processor.
impl Transposition for pulp::Scalar {
    #[inline(always)]
    fn transpose(self, [rows, columns]: [usize; 2], from: &[f32], stride: usize, to: &mut [f32], to_stride: usize) {
        for row in 0..rows {
            for column in 0..columns {
                to[column * to_stride + row] = from[row * stride + column];
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::__m256;

    use pulp::x86::V3;

    use super::Transposition;

    /// Rows and columns transposed within registers.
    const TILE: usize = 8;

    impl Transposition for V3 {
        #[inline(always)]
        fn transpose(self, [rows, columns]: [usize; 2], from: &[f32], stride: usize, to: &mut [f32], to_stride: usize) {
            for row in (0..rows).step_by(TILE) {
                for column in (0..columns).step_by(TILE) {
                    let size = [TILE.min(rows - row), TILE.min(columns - column)];
                    let (from, to) = (&from[row * stride + column..], &mut to[column * to_stride + row..]);
                    if size != [TILE; 2] {
                        pulp::Scalar.transpose(size, from, stride, to, to_stride);
                        continue;
                    }
                    let mut tile = [self.avx._mm256_setzero_ps(); TILE];
                    for i in 0..TILE {
                        tile[i] = load(&from[i * stride..]);
                    }
                    let tile = transpose_tile(self, tile);
                    for i in 0..TILE {
                        let numbers: [f32; TILE] = pulp::cast(tile[i]);
                        to[i * to_stride..][..TILE].copy_from_slice(&numbers);
                    }
                }
            }
        }
    }

    /// Neighbours, then pairs, then fours change places.
    #[inline(always)]
    fn transpose_tile(v3: V3, rows: [__m256; TILE]) -> [__m256; TILE] {
        let avx = v3.avx;
        let (mut pairs, mut fours, mut columns) = (rows, rows, rows);
        for i in 0..TILE / 2 {
            pairs[2 * i] = avx._mm256_unpacklo_ps(rows[2 * i], rows[2 * i + 1]);
            pairs[2 * i + 1] = avx._mm256_unpackhi_ps(rows[2 * i], rows[2 * i + 1]);
        }
        for i in [0, 4] {
            for k in 0..2 {
                fours[i + 2 * k] = avx._mm256_shuffle_ps::<0x44>(pairs[i + k], pairs[i + k + 2]);
                fours[i + 2 * k + 1] = avx._mm256_shuffle_ps::<0xee>(pairs[i + k], pairs[i + k + 2]);
            }
        }
        for i in 0..4 {
            columns[i] = avx._mm256_permute2f128_ps::<0x20>(fours[i], fours[i + 4]);
            columns[i + 4] = avx._mm256_permute2f128_ps::<0x31>(fours[i], fours[i + 4]);
        }
        columns
    }

    #[inline(always)]
    fn load(row: &[f32]) -> __m256 {
        let mut eight = [0.0; TILE];
        eight.copy_from_slice(&row[..TILE]);
        pulp::cast(eight)
    }

    #[cfg(test)]
    mod tests {
        use proptest::prelude::*;

        use super::*;

        proptest! {
            #[test]
            fn tiles_transpose_as_plain_loops_do(rows in 1..40_usize, columns in 1..40_usize, beyond in 0..3_usize) {
                let Some(v3) = V3::try_new() else { return Ok(()) };
                let (stride, to_stride) = (columns + beyond, rows + 2 * beyond);
                let from: Vec<f32> = (0..rows * stride).map(|index| index as f32).collect();
                let mut found = vec![-1.0; columns * to_stride];
                let mut expected = found.clone();
                v3.transpose([rows, columns], &from, stride, &mut found, to_stride);
                pulp::Scalar.transpose([rows, columns], &from, stride, &mut expected, to_stride);
                prop_assert_eq!(found, expected);
            }
        }
    }
}
