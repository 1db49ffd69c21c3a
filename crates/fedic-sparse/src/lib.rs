//! The sparse symmetric system of a finite element problem: its pattern, its assembly and its Cholesky factorisation.
//!
//! Unknowns come in blocks of one size, a block per node; degree of freedom `node * block + component`. The order of
//! every sum is fixed by the order of the cells, so results do not depend on the number of threads.

mod cholesky;
mod dissection;
mod elimination;
mod elimination_tree;
mod error;
mod factor;
mod front;
mod graph;
mod matrix;
mod minimum_degree;
mod panel;
mod pattern;
mod runs;
mod sweep;
mod symbolic;
mod tree;

pub use cholesky::Cholesky;
pub use error::SparseError;
pub use factor::Factor;
pub use matrix::SymmetricMatrix;
pub use pattern::Pattern;
