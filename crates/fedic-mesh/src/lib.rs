//! Surface meshes for finite-element digital image correlation.
//!
//! Everything geometric that does not know of cameras or images: cell types and their shape functions, the mesh,
//! the isoparametric map and its inverse, and the two families of quadrature points: sub-elements of a cell
//! ([`Subdivision`]) and the pixels that fall in it ([`pixels_in_polygon`]).
//!
//! Reference domains: the triangle `(0,0) (1,0) (0,1)` and the square `[-1, 1]^2`; node order is meshio's.

mod cell;
mod error;
mod generate;
mod isoparametric;
mod locate;
mod mesh;
mod pixels;
mod shape;
mod subdivision;

pub use cell::{CellType, MAX_NODES};
pub use error::{MeshError, list_indices};
pub use generate::rectangle_mesh;
pub use isoparametric::{inverse_map, jacobian, map};
pub use locate::Locator;
pub use mesh::{Cell, Mesh};
pub use pixels::pixels_in_polygon;
pub use shape::{shape_gradients, shape_values, shape_values_batch};
pub use subdivision::{Rule, Subdivision};
