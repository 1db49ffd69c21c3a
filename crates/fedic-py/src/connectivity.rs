//! Node indices of the cells as arrays.

use std::str::FromStr;

use fedic::{CellType, MeshError};
use numpy::{PyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use crate::arrays::{describe, indices};
use crate::errors::{IntoPyErr, mesh_error};

/// Reads a mapping of cell types to node indices.
pub(crate) fn read_blocks(cells: &Bound<'_, PyAny>) -> PyResult<Vec<(CellType, Vec<i64>)>> {
    let mapping = cells.cast::<PyMapping>().map_err(|_| {
        mesh_error(format!("cells must be a mapping such as {{\"quad\": (m, 4) array}}, got {}", describe(cells)))
    })?;
    let mut blocks = Vec::new();
    for item in mapping.items()? {
        let (name, connectivity): (String, Bound<'_, PyAny>) = item
            .extract()
            .map_err(|_| mesh_error("the keys of cells must be names of cell types such as \"quad\"".to_owned()))?;
        let cell_type = CellType::from_str(&name).map_err(IntoPyErr::into_py_err)?;
        let (connectivity, found) = indices(&connectivity, &format!("cells[\"{name}\"]"), mesh_error)?;
        if found != cell_type.num_nodes() && !connectivity.is_empty() {
            return Err(MeshError::WrongNodeCount { cell_type, found }.into_py_err());
        }
        blocks.push((cell_type, connectivity));
    }
    Ok(blocks)
}

/// Node indices by type, in the order of the cells; `local` selects and orders the nodes of a cell.
pub(crate) fn blocks(mesh: &fedic::Mesh, local: Option<fn(CellType) -> &'static [usize]>) -> Vec<(CellType, Vec<i64>)> {
    let mut blocks: Vec<(CellType, Vec<i64>)> = Vec::new();
    for cell in mesh.cells() {
        if blocks.last().is_none_or(|(cell_type, _)| *cell_type != cell.cell_type) {
            blocks.push((cell.cell_type, Vec::new()));
        }
        if let Some((_, nodes)) = blocks.last_mut() {
            match local {
                Some(local) => nodes.extend(local(cell.cell_type).iter().map(|&a| i64::from(cell.nodes[a]))),
                None => nodes.extend(cell.nodes.iter().map(|&node| i64::from(node))),
            }
        }
    }
    blocks
}

/// Indices as an array of rows of `width`.
pub(crate) fn table(py: Python<'_>, indices: Vec<i64>, width: usize) -> PyResult<Bound<'_, PyArray2<i64>>> {
    let height = indices.len() / width;
    PyArray::from_vec(py, indices).reshape([height, width])
}
