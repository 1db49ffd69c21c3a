//! Minimisation of a sum of terms: Gauss-Newton iterations, bases of the displacement, and starts.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation, observation, equations, results.

pub(crate) mod basis;
pub(crate) mod gauss_newton;
pub(crate) mod level;
pub(crate) mod start;
#[cfg(test)]
mod tests;
