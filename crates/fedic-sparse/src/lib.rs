//! The sparse symmetric system of a finite element problem: its pattern, its assembly and its Cholesky factorisation.
//!
//! Unknowns come in blocks of one size, a block per node; degree of freedom `node * block + component`. The order of
//! every sum is fixed by the order of the cells, so results do not depend on the number of threads.

mod cholesky;
mod error;
mod matrix;
mod pattern;

pub use cholesky::{Cholesky, Factor};
pub use error::SparseError;
pub use matrix::SymmetricMatrix;
pub use pattern::Pattern;
