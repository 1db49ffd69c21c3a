pub(crate) mod cell_quadrature;
pub(crate) mod shape_table;
