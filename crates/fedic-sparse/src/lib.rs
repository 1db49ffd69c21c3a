//! Sparse symmetric positive definite systems of finite element problems: pattern, assembly, Cholesky factorization.
//!
//! Unknowns come in blocks of one size, one block per node: degree of freedom `node * block + component`. Sums are
//! evaluated in an order fixed by the mesh, so results are bit-identical for any number of threads.
//!
//! The modules follow the computation, and each imports only those before it: [`Pattern`] and [`SymmetricMatrix`],
//! `ordering` (fill-reducing permutation), `symbolic` (pattern of the factor), `numeric` (factorization), `inverse`
//! (entries of the inverse), `solve` (triangular solves), [`Cholesky`]. The [`SpdSolver`] and [`SpdFactor`] traits are what the rest of the project uses.
//!
//! # Examples
//!
//! ```
//! use fedic_sparse::{Cholesky, Pattern, SpdFactor, SpdSolver, SymmetricMatrix};
//!
//! // Two springs in a row, the first node tied to the ground.
//! let pattern = Pattern::new(3, 1, [[0_u32].as_slice(), &[0, 1], &[1, 2]]);
//! let mut matrix = SymmetricMatrix::zeros(&pattern);
//! matrix.add_cell(&pattern, 0, &[1.0]);
//! for spring in [1, 2] {
//!     matrix.add_cell(&pattern, spring, &[1.0, -1.0, -1.0, 1.0]);
//! }
//! let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
//! let factor = Cholesky::new(&pattern, &points)?.factorize(&matrix)?;
//! let mut x = [0.0, 0.0, 1.0];
//! factor.solve(&mut x);
//! assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(x, exact)| (x - exact).abs() < 1e-12));
//! # Ok::<(), fedic_sparse::SparseError>(())
//! ```

mod cholesky;
mod error;
mod inverse;
mod matrix;
mod numeric;
mod ordering;
mod pattern;
mod solve;
mod solver;
mod symbolic;

pub use cholesky::Cholesky;
pub use error::SparseError;
pub use matrix::SymmetricMatrix;
pub use pattern::Pattern;
pub use solve::Factor;
pub use solver::{SpdFactor, SpdSolver};
