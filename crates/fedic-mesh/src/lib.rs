//! Surface meshes for finite-element digital image correlation.
//!
//! Cell types and their shape functions ([`CellType`]), meshes ([`Mesh`]), the isoparametric map and its inverse, fields on a
//! mesh ([`StrainField`], [`cell_areas`], [`interpolate_field`]) and the two families of quadrature points: sub-cells of a
//! cell ([`Subdivision`]) and pixels inside it ([`pixels_in_polygon`]). Nothing here depends on cameras or images.
//!
//! Reference domains: the triangle `(0,0) (1,0) (0,1)` and the square `[-1, 1]^2`; node order is meshio's.

mod cells;
mod error;
mod field;
mod isoparametric;
mod locate;
mod mesh;
mod pixels;
mod rectangle;
mod rule;
mod subdivision;

pub use cells::{
    CellData, CellType, CellVisitor, GmshElement, MAX_NODES, ReferenceDomain, shape_gradients, shape_values,
    shape_values_batch,
};
pub use error::{MeshError, list_indices};
pub use field::{
    StrainAxes, StrainField, StrainMeasure, SurfaceGradients, SurfaceStrain, UnknownStrainMeasure, cell_areas,
    gauss_quadrature, interpolate_field, surface_gradients,
};
pub use isoparametric::{inverse_map, jacobian, map};
pub use locate::Locator;
pub use mesh::{BoundaryEdge, Cell, CellEdge, LineError, Mesh, MeshSet};
pub use pixels::pixels_in_polygon;
pub use rectangle::rectangle_mesh;
pub use rule::{Rule, UnknownRule};
pub use subdivision::Subdivision;
