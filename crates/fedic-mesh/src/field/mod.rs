//! Fields on a mesh: values between the nodes, gradients and strains in the tangent plane, areas.

mod area;
mod gauss;
mod gradient;
mod interpolate;
mod strain;

pub use area::cell_areas;
pub use gauss::gauss_quadrature;
pub use gradient::{SurfaceGradients, surface_gradients};
pub use interpolate::interpolate_field;
pub use strain::{StrainAxes, StrainField, StrainMeasure, SurfaceStrain, UnknownStrainMeasure};
