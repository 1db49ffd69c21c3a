//! Tensor-product cubic B-splines on a rectangle.

mod basis;
mod field;
mod fit;

pub use field::SplineField;
