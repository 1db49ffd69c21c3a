//! Monomials of the reference coordinates up to degree 4.

/// Number of monomials besides the constant.
pub(crate) const MONOMIALS: usize = 14;
/// Number of monomials up to each degree, the constant left out.
pub(crate) const UP_TO_DEGREE: [usize; 4] = [2, 5, 9, 14];

/// Exponents `[i, j]` of the monomials `xi^i eta^j` besides the constant, by degree.
const EXPONENTS: [[i32; 2]; MONOMIALS] =
    [[1, 0], [0, 1], [2, 0], [1, 1], [0, 2], [3, 0], [2, 1], [1, 2], [0, 3], [4, 0], [3, 1], [2, 2], [1, 3], [0, 4]];

/// Exponents of monomial `m`, the constant counted as the first.
pub(crate) fn exponents(m: usize) -> [i32; 2] {
    if m == 0 { [0, 0] } else { EXPONENTS[m - 1] }
}

/// All monomials but the constant at a point of the reference cell.
pub(crate) fn monomials([xi, eta]: [f64; 2]) -> [f64; MONOMIALS] {
    let mut values = [0.0; MONOMIALS];
    for (value, [i, j]) in values.iter_mut().zip(EXPONENTS) {
        *value = xi.powi(i) * eta.powi(j);
    }
    values
}
