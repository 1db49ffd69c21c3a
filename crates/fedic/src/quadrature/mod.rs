//! Quadrature points of the cells, in reference coordinates, and the shape functions and monomials tabulated there.
//!
//! May import: options, error.

pub(crate) mod cell_quadrature;
pub(crate) mod monomials;
pub(crate) mod shape_table;
