//! Gauss quadrature of the reference domains.

use crate::ReferenceDomain;

/// Abscissae and weights of Gauss-Legendre quadrature with four points on `[-1, 1]`.
const LEGENDRE: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Points of a reference domain and their weights, whose sum is its area.
///
/// Exact for polynomials of degree 7 in each coordinate of the square and of degree 6 in the triangle, so for the mass
/// matrices of quadratic cells with curved edges.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{ReferenceDomain, gauss_quadrature};
/// let integral: f64 = gauss_quadrature(ReferenceDomain::Triangle).map(|([xi, eta], weight)| weight * xi * eta).sum();
/// assert!((integral - 1.0 / 24.0).abs() < 1e-15);
/// ```
pub fn gauss_quadrature(domain: ReferenceDomain) -> impl Iterator<Item = ([f64; 2], f64)> {
    LEGENDRE.into_iter().flat_map(move |(x, wx)| {
        LEGENDRE.into_iter().map(move |(y, wy)| match domain {
            ReferenceDomain::Square => ([x, y], wx * wy),
            // The square collapsed onto the triangle, which multiplies areas by `(1 - xi) / 4`.
            ReferenceDomain::Triangle => {
                let (xi, eta) = (0.5 * (1.0 + x), 0.5 * (1.0 + y));
                ([xi, eta * (1.0 - xi)], 0.25 * (1.0 - xi) * wx * wy)
            }
        })
    })
}
