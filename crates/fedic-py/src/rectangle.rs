//! Regular meshes.

use std::str::FromStr;

use fedic::CellType;
use pyo3::prelude::*;

use crate::errors::option_error;
use crate::mesh::Mesh;
use crate::worker::run;

/// Regular mesh of a rectangle.
///
/// Parameters
/// ----------
/// bounds : (x0, y0, x1, y1)
///     Corners, in the mesh's unit.
/// size : float
///     Length of the cells' edges, in the mesh's unit; it is adjusted so that the cells fill the rectangle exactly.
/// cell : str
///     Type of the cells, a name of `CELL_TYPES`; triangles halve the squares along alternating diagonals.
///
/// Returns
/// -------
/// Mesh
///
/// Raises
/// ------
/// OptionError
///     If the bounds are empty or not finite, the size is not positive, or the cell type is unknown.
#[pyfunction]
#[pyo3(signature = (bounds, size, cell="quad"))]
pub(crate) fn rectangle_mesh(py: Python<'_>, bounds: [f64; 4], size: f64, cell: &str) -> PyResult<Mesh> {
    let cell_type = CellType::from_str(cell).map_err(|error| option_error(error.to_string(), "cell"))?;
    let made = run(py, None, |_| Ok(fedic::rectangle_mesh(bounds, size, cell_type)))?;
    let inner = made.map_err(|error| option_error(error.to_string(), "bounds"))?;
    Ok(Mesh { inner, dimension: 2 })
}
