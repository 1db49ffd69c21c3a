pub(crate) mod cell_polynomial;
pub(crate) mod cell_projection;
pub(crate) mod pointwise;
pub(crate) mod polynomial_basis;
pub(crate) mod projected_points;
