//! Errors of the factorization.

use thiserror::Error;

/// The system has no unique solution or does not fit in memory.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SparseError {
    /// Some pivots vanish: the matrix does not determine these degrees of freedom.
    #[error(
        "the system matrix is singular: {} of its degrees of freedom are undetermined, the first of them {}",
        dofs.len(),
        dofs.first().copied().unwrap_or_default()
    )]
    Singular {
        /// Undetermined degrees of freedom, in increasing order.
        dofs: Vec<usize>,
    },
    /// An entry of the matrix is NaN or infinite.
    #[error("the system matrix has an entry that is NaN or infinite")]
    NonFinite,
    /// The factor, or the work for its inverse, exceeds the available memory or the range of the indices.
    #[error("the factorization or inversion of a system with {dofs} degrees of freedom does not fit in memory")]
    TooLarge {
        /// Number of degrees of freedom.
        dofs: usize,
    },
}
