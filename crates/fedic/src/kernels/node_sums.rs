//! Right-hand side of one cell: sums of the sensitivity times a factor at each node.

use fedic_mesh::MAX_NODES;
use pulp::{Simd, WithSimd};

use crate::kernels::dispatch::{FLUSH, run};
use crate::kernels::polynomial::Polynomial;
use crate::quadrature::shape_table::ShapeTableChunk;

/// Shape functions of a cell type as combinations of monomials.
#[derive(Clone, Copy)]
pub(crate) struct ShapeMonomials<'a> {
    /// Monomials that occur, the constant counted as the first.
    pub(crate) active: &'a [usize],
    /// Coefficients of each shape function.
    pub(crate) coefficients: &'a [Polynomial],
}

/// Adds `sum of factor N_a q` over the points of a chunk to `node_sums[a]`, for each node `a`.
///
/// The sums run over the monomials of the shape functions, of which there are as many, and whose rows are in the cache already.
pub(crate) fn add_node_sums<const D: usize>(
    shape: ShapeMonomials<'_>,
    chunk: ShapeTableChunk<'_>,
    q: [&[f32]; D],
    factors: &[f32],
    node_sums: &mut [[f64; D]; MAX_NODES],
) {
    let mut monomial_sums = [[0.0; D]; MAX_NODES];
    let sums = &mut monomial_sums[..shape.active.len()];
    for (monomials, sums) in shape.active.chunks(SUMMED).zip(sums.chunks_mut(SUMMED)) {
        match monomials.len() {
            4 => run(MonomialSums::<4, D> { chunk, monomials, q, factors, sums }),
            3 => run(MonomialSums::<3, D> { chunk, monomials, q, factors, sums }),
            2 => run(MonomialSums::<2, D> { chunk, monomials, q, factors, sums }),
            _ => run(MonomialSums::<1, D> { chunk, monomials, q, factors, sums }),
        }
    }
    for (coefficients, node) in shape.coefficients.iter().zip(&mut node_sums[..chunk.num_nodes()]) {
        for (&m, sums) in shape.active.iter().zip(&monomial_sums) {
            (0..D).for_each(|c| node[c] += coefficients[m] * sums[c]);
        }
    }
}

/// Number of monomials whose sums are kept in registers.
const SUMMED: usize = 4;

struct MonomialSums<'a, const N: usize, const D: usize> {
    chunk: ShapeTableChunk<'a>,
    monomials: &'a [usize],
    q: [&'a [f32]; D],
    factors: &'a [f32],
    sums: &'a mut [[f64; D]],
}

impl<const N: usize, const D: usize> WithSimd for MonomialSums<'_, N, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { chunk, monomials, q, factors, sums } = self;
        let factors = S::as_simd_f32s(factors).0;
        let q = q.map(|along| &S::as_simd_f32s(along).0[..factors.len()]);
        let mut powers: [&[S::f32s]; N] = [&[]; N];
        for m in 0..N {
            powers[m] = &S::as_simd_f32s(chunk.monomial(monomials[m])).0[..factors.len()];
        }
        for start in (0..factors.len()).step_by(FLUSH) {
            let mut vectors = [[simd.splat_f32s(0.0); D]; N];
            for k in start..factors.len().min(start + FLUSH) {
                let weighted = q.map(|along| simd.mul_f32s(factors[k], along[k]));
                for m in 0..N {
                    let power = powers[m][k];
                    for c in 0..D {
                        vectors[m][c] = simd.mul_add_e_f32s(power, weighted[c], vectors[m][c]);
                    }
                }
            }
            for m in 0..N {
                for c in 0..D {
                    sums[m][c] += f64::from(simd.reduce_sum_f32s(vectors[m][c]));
                }
            }
        }
    }
}
