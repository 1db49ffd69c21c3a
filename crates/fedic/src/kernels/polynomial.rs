//! Polynomials over the reference cell: linear combinations in double precision, evaluation in single precision.

use pulp::{Simd, WithSimd};

use crate::kernels::dispatch::run;
use crate::quadrature::monomials::MONOMIALS;
use crate::quadrature::shape_table::ShapeTableChunk;

/// Coefficients of the constant and of each monomial, and a zero that fills the last vector.
pub(crate) type Polynomial = [f64; MONOMIALS + 2];

/// Image coordinates `u` and `v` as polynomials over a cell, in single precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelPolynomial {
    /// Coefficients of the constant and of the monomials, of `u` and of `v`.
    pub(crate) coefficients: [[f32; MONOMIALS + 1]; 2],
    /// Rounding error of the coefficients of the constant, `xi` and `eta`, of `u` and of `v`.
    pub(crate) remainder: [[f32; 3]; 2],
    /// Number of monomials, besides the constant, with coefficients that matter.
    pub(crate) terms: usize,
}

/// Linear combinations of the same polynomials with two sets of factors.
pub(crate) fn combinations(factors: [&[f64]; 2], polynomials: &[Polynomial]) -> [Polynomial; 2] {
    run(Combinations { factors, polynomials })
}

struct Combinations<'a> {
    factors: [&'a [f64]; 2],
    polynomials: &'a [Polynomial],
}

impl WithSimd for Combinations<'_> {
    type Output = [Polynomial; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Polynomial; 2] {
        let mut sums = [Polynomial::default(); 2];
        let [first, second] = self.factors;
        for ((polynomial, &first), &second) in self.polynomials.iter().zip(first).zip(second) {
            let factors = [simd.splat_f64s(first), simd.splat_f64s(second)];
            for (sum, factor) in sums.iter_mut().zip(factors) {
                for (sum, &share) in S::as_mut_simd_f64s(sum).0.iter_mut().zip(S::as_simd_f64s(polynomial).0) {
                    *sum = simd.mul_add_e_f64s(factor, share, *sum);
                }
            }
        }
        sums
    }
}

/// Evaluates `u` and `v` at the points of a chunk.
pub(crate) fn pixel_coordinates(
    chunk: ShapeTableChunk<'_>,
    polynomial: &PixelPolynomial,
    u: &mut [f32],
    v: &mut [f32],
) {
    match polynomial.terms {
        2 => run(PixelCoordinates::<2> { chunk, polynomial, u, v }),
        5 => run(PixelCoordinates::<5> { chunk, polynomial, u, v }),
        9 => run(PixelCoordinates::<9> { chunk, polynomial, u, v }),
        _ => run(PixelCoordinates::<MONOMIALS> { chunk, polynomial, u, v }),
    }
}

struct PixelCoordinates<'a, const TERMS: usize> {
    chunk: ShapeTableChunk<'a>,
    polynomial: &'a PixelPolynomial,
    u: &'a mut [f32],
    v: &'a mut [f32],
}

impl<const TERMS: usize> WithSimd for PixelCoordinates<'_, TERMS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { chunk, polynomial, u, v } = self;
        let (u, _) = S::as_mut_simd_f32s(u);
        let (v, _) = S::as_mut_simd_f32s(v);
        let mut powers: [&[S::f32s]; TERMS] = [&[]; TERMS];
        for m in 0..TERMS {
            powers[m] = &S::as_simd_f32s(chunk.monomial(m + 1)).0[..u.len()];
        }
        let [of_u, of_v] = &polynomial.coefficients;
        let [constant_u, constant_v] = [simd.splat_f32s(of_u[0]), simd.splat_f32s(of_v[0])];
        let (mut factors_u, mut factors_v) = ([constant_u; TERMS], [constant_v; TERMS]);
        for m in 0..TERMS {
            factors_u[m] = simd.splat_f32s(of_u[m + 1]);
            factors_v[m] = simd.splat_f32s(of_v[m + 1]);
        }
        let mut remainders = [[constant_u; 3]; 2];
        for c in 0..2 {
            for m in 0..3 {
                remainders[c][m] = simd.splat_f32s(polynomial.remainder[c][m]);
            }
        }
        for k in 0..u.len().min(v.len()) {
            let (xi, eta) = (powers[0][k], powers[1][k]);
            // The remainders of the largest terms come first: added last, they would be rounded away.
            let [mut at_u, mut at_v] = remainders.map(|[constant, along_xi, along_eta]| {
                simd.mul_add_e_f32s(eta, along_eta, simd.mul_add_e_f32s(xi, along_xi, constant))
            });
            for m in (0..TERMS).rev() {
                let power = powers[m][k];
                at_u = simd.mul_add_e_f32s(power, factors_u[m], at_u);
                at_v = simd.mul_add_e_f32s(power, factors_v[m], at_v);
            }
            u[k] = simd.add_f32s(at_u, constant_u);
            v[k] = simd.add_f32s(at_v, constant_v);
        }
    }
}
