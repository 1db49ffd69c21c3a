//! Transposition of matrices.

use crate::simd::lanes::Fusing;

/// Transposition with an instruction set.
pub(crate) trait Transpose: Fusing {
    /// Writes a matrix of `rows` rows and `columns` columns, stored with `stride` elements from row to row, as a matrix of
    /// `columns` rows with `to_stride` elements from row to row.
    fn transpose(self, size: [usize; 2], from: &[f32], stride: usize, to: &mut [f32], to_stride: usize);
}

/// Portable loops.
impl Transpose for pulp::Scalar {
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

    use super::Transpose;

    /// Rows and columns transposed within registers.
    const TILE: usize = 8;

    impl Transpose for V3 {
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
                        let elements: [f32; TILE] = pulp::cast(tile[i]);
                        to[i * to_stride..][..TILE].copy_from_slice(&elements);
                    }
                }
            }
        }
    }

    /// Exchanges single elements, then pairs, then groups of four.
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
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Compares a transposition, element by element, with its definition.
    fn check(simd: impl Transpose, [rows, columns]: [usize; 2], gap: usize) {
        let (stride, to_stride) = (columns + gap, rows + 2 * gap);
        let from: Vec<f32> = (0..rows * stride).map(|index| index as f32).collect();
        let mut found = vec![-1.0; columns * to_stride];
        simd.transpose([rows, columns], &from, stride, &mut found, to_stride);
        for (index, &element) in found.iter().enumerate() {
            let (column, row) = (index / to_stride, index % to_stride);
            let expected = if row < rows { (row * stride + column) as f32 } else { -1.0 };
            assert_eq!(element, expected, "row {row}, column {column}");
        }
    }

    proptest! {
        #[test]
        fn transposition_moves_every_element(rows in 1..40_usize, columns in 1..40_usize, gap in 0..3_usize) {
            check(pulp::Scalar, [rows, columns], gap);
            #[cfg(target_arch = "x86_64")]
            if let Some(v3) = pulp::x86::V3::try_new() {
                check(v3, [rows, columns], gap);
            }
        }
    }

    /// Reports on which processors [`transposition_moves_every_element`] leaves a version out.
    #[test]
    #[cfg_attr(not(target_arch = "x86_64"), ignore = "AVX2 exists on x86-64 only")]
    fn transposition_with_avx2_is_tested_here() {
        #[cfg(target_arch = "x86_64")]
        match pulp::x86::V3::try_new() {
            Some(v3) => check(v3, [17, 25], 1),
            None => eprintln!("skipped: this processor has no AVX2"),
        }
    }
}
