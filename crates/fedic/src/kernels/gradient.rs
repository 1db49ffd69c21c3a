//! Sensitivity of the residual: the image gradient projected to the components of the displacement.

use pulp::{Simd, WithSimd};

use crate::kernels::dispatch::run;
use crate::quadrature::shape_table::ShapeTableChunk;

/// Jacobian of a camera as linear functions over a cell: constant and slopes along `xi` and `eta` of the derivative of `u` and of
/// `v` with respect to each displacement component.
pub(crate) type LinearJacobian<const D: usize> = [[[f32; 3]; D]; 2];

/// Image gradients at the points of a chunk.
pub(crate) trait GradientVectors: Copy {
    /// Vector `k` of the derivatives along `u` and along `v`.
    fn vectors<S: Simd>(self, k: usize) -> [S::f32s; 2];
}

impl GradientVectors for [&[f32]; 2] {
    #[inline(always)]
    fn vectors<S: Simd>(self, k: usize) -> [S::f32s; 2] {
        self.map(|along| S::as_simd_f32s(along).0[k])
    }
}

/// Writes the sensitivity `q = J^T grad f` at the points of a chunk.
pub(crate) fn project_gradient<G: GradientVectors, const D: usize>(
    chunk: ShapeTableChunk<'_>,
    jacobian: &LinearJacobian<D>,
    gradient: G,
    q: [&mut [f32]; D],
) {
    run(ProjectGradient { chunk, jacobian, gradient, q });
}

struct ProjectGradient<'a, G, const D: usize> {
    chunk: ShapeTableChunk<'a>,
    jacobian: &'a LinearJacobian<D>,
    gradient: G,
    q: [&'a mut [f32]; D],
}

impl<G: GradientVectors, const D: usize> WithSimd for ProjectGradient<'_, G, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [xi, eta] = [1, 2].map(|m| S::as_simd_f32s(self.chunk.monomial(m)).0);
        let count = xi.len();
        let eta = &eta[..count];
        let q = self.q.map(|along| &mut S::as_mut_simd_f32s(along).0[..count]);
        let mut jacobian = [[[simd.splat_f32s(0.0); 3]; D]; 2];
        for c in 0..2 {
            for d in 0..D {
                for m in 0..3 {
                    jacobian[c][d][m] = simd.splat_f32s(self.jacobian[c][d][m]);
                }
            }
        }
        for k in 0..count {
            let (xi, eta) = (xi[k], eta[k]);
            let at = |[constant, along_xi, along_eta]: [S::f32s; 3]| {
                simd.mul_add_e_f32s(along_eta, eta, simd.mul_add_e_f32s(along_xi, xi, constant))
            };
            let [of_u, of_v] = jacobian.map(|row| row.map(at));
            let [along_u, along_v] = self.gradient.vectors::<S>(k);
            for d in 0..D {
                q[d][k] = simd.mul_add_e_f32s(of_u[d], along_u, simd.mul_f32s(of_v[d], along_v));
            }
        }
    }
}

/// Largest magnitude in a slice.
pub(crate) fn largest_magnitude(values: &[f32]) -> f32 {
    run(LargestMagnitude(values))
}

struct LargestMagnitude<'a>(&'a [f32]);

impl WithSimd for LargestMagnitude<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let mut largest = [simd.splat_f32s(0.0); 2];
        for (index, &vector) in S::as_simd_f32s(self.0).0.iter().enumerate() {
            largest[index % 2] = simd.max_f32s(largest[index % 2], simd.abs_f32s(vector));
        }
        simd.reduce_max_f32s(simd.max_f32s(largest[0], largest[1]))
    }
}
