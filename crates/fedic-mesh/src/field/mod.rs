//! Fields on a mesh: values between the nodes, gradients and strains in the tangent plane, areas.

mod area;
mod gradient;
mod interpolate;
mod strain;

pub use area::cell_areas;
pub use gradient::{SurfaceGradients, surface_gradients};
pub use interpolate::interpolate_field;
pub use strain::cell_strains;
