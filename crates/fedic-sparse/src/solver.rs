//! Interface of a direct solver for symmetric positive definite systems.

use crate::{SparseError, SymmetricMatrix};

/// A solver prepared for one [`Pattern`](crate::Pattern), which factorizes matrices of that pattern.
pub trait SpdSolver {
    /// The factor of one matrix.
    type Factor: SpdFactor;

    /// Factorizes a matrix in double precision.
    ///
    /// # Errors
    ///
    /// * [`SparseError::Singular`] with the undetermined degrees of freedom if the matrix is not positive definite;
    /// * [`SparseError::NonFinite`] if the matrix has an entry that is NaN or infinite;
    /// * [`SparseError::TooLarge`] if the factor does not fit in memory.
    fn factorize(&self, matrix: &SymmetricMatrix) -> Result<Self::Factor, SparseError>;

    /// Factorizes a matrix and stores the factor in less memory if the matrix is well conditioned.
    ///
    /// Solutions with a compact factor have relative errors of about 1e-7, which suits iterative corrections. By
    /// default the factor is that of [`factorize`](Self::factorize).
    ///
    /// # Errors
    ///
    /// Those of [`factorize`](Self::factorize).
    fn factorize_compact(&self, matrix: &SymmetricMatrix) -> Result<Self::Factor, SparseError> {
        self.factorize(matrix)
    }
}

/// The factor of one matrix.
pub trait SpdFactor {
    /// Solves `A x = b` in place for one or several right-hand sides, using the threads of the current pool.
    ///
    /// `rhs` holds the right-hand sides one after the other, each with one entry per degree of freedom.
    ///
    /// # Panics
    ///
    /// If the length of `rhs` is not a multiple of the number of degrees of freedom.
    fn solve(&self, rhs: &mut [f64]);

    /// Like [`solve`](Self::solve), with the same result, on the calling thread alone.
    ///
    /// For systems solved in parallel with each other: no solve waits for work that another thread has queued.
    ///
    /// # Panics
    ///
    /// If the length of `rhs` is not a multiple of the number of degrees of freedom.
    fn solve_sequentially(&self, rhs: &mut [f64]);

    /// The entries of `A^-1` on the pattern of `A`, using the threads of the current pool.
    ///
    /// If `A^-1` is the covariance of the unknowns, these are the variances of all unknowns and their covariances within each cell.
    /// They take about as long as one or two factorizations. With a compact factor the relative errors are about 1e-7, as those of
    /// solutions.
    ///
    /// # Errors
    ///
    /// [`SparseError::TooLarge`] if the work does not fit in memory.
    fn selected_inverse(&self) -> Result<SymmetricMatrix, SparseError>;

    /// Number of stored values, a measure of the fill.
    fn num_entries(&self) -> usize;

    /// Whether the factor is stored in single precision.
    fn is_compact(&self) -> bool {
        false
    }
}
