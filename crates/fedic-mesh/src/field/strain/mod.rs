//! Strains of a displacement field: the measures, and their values at cells, points and nodes.

mod axes;
mod measure;
mod nodes;
mod projection;
mod strain_field;
mod surface_strain;

pub use axes::StrainAxes;
pub use measure::{StrainMeasure, UnknownStrainMeasure};
pub use strain_field::StrainField;
pub use surface_strain::SurfaceStrain;
