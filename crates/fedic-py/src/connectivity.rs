//! Node indices of the cells as arrays.

use fedic::CellType;
use numpy::{PyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

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
