//! The mesh.

use std::str::FromStr;

use fedic::{CellType, MeshError, cell_areas, cell_strains, interpolate_field};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::arrays::{self, indices, matrix, rows, to_array};
use crate::errors::{IntoPyErr, argument_error, mesh_error};
use crate::worker::run;

/// A surface mesh.
///
/// Cells that are listed clockwise are turned round; nodes that no cell uses are kept, so that indices stay the user's.
///
/// Parameters
/// ----------
/// points : (n, 2) or (n, 3) array_like of float
///     Coordinates of the nodes, in any unit; it becomes the unit of the displacement.
/// cells : mapping of str to (m, k) array_like of int
///     Node indices of the cells of each type, in meshio's names and node order: ``triangle``, ``triangle6``, ``quad``,
///     ``quad8``, ``quad9``.
///
/// Raises
/// ------
/// MeshError
///     If an array has the wrong shape or type, a coordinate is not finite, a cell refers to a node that does not exist,
///     or a cell has zero area or is folded; ``error.cells`` and ``error.nodes`` say which.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct Mesh {
    pub(crate) inner: fedic::Mesh,
    dimension: usize,
}

/// The mesh of an argument.
pub(crate) fn any_mesh<'a>(object: &'a Bound<'_, PyAny>) -> PyResult<&'a fedic::Mesh> {
    let mesh = object.cast::<Mesh>();
    let refuse = || argument_error(format!("mesh must be a fedic.Mesh, got {}", arrays::describe(object)));
    mesh.map(|mesh| &mesh.get().inner).map_err(|_| refuse())
}

#[pymethods]
impl Mesh {
    #[new]
    fn new(points: &Bound<'_, PyAny>, cells: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (points, dimension) = arrays::points(points, "points", mesh_error)?;
        let mapping = cells.cast::<PyMapping>().map_err(|_| {
            mesh_error(format!(
                "cells must be a mapping such as {{\"quad\": (m, 4) array}}, got {}",
                arrays::describe(cells)
            ))
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
        let inner = fedic::Mesh::new(points, &blocks).map_err(IntoPyErr::into_py_err)?;
        Ok(Self { inner, dimension })
    }

    /// Coordinates of the nodes, (n, 2) or (n, 3) float64: a copy.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if self.dimension == 3 {
            return to_array(py, self.inner.points());
        }
        let plane: Vec<[f64; 2]> = self.inner.points().iter().map(|p| [p[0], p[1]]).collect();
        to_array(py, &plane)
    }

    /// Node indices of the cells of each type, (m, k) int64, all cells counter-clockwise: copies.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let cells = PyDict::new(py);
        for (cell_type, connectivity) in self.blocks(None) {
            cells.set_item(cell_type.name(), table(py, connectivity, cell_type.num_nodes())?)?;
        }
        Ok(cells)
    }

    /// Number of cells over all types.
    #[getter]
    fn num_cells(&self) -> usize {
        self.inner.num_cells()
    }

    /// Number of nodes, those that no cell uses included.
    #[getter]
    fn num_nodes(&self) -> usize {
        self.inner.num_nodes()
    }

    /// For each node, whether a cell uses it, (n,) bool.
    #[getter]
    fn used_nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.inner.used_nodes())
    }

    /// Indices of the cells that were given clockwise and have been turned round, over all types in their order.
    #[getter]
    fn flipped_cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.inner.flipped().iter().map(|&cell| cell as i64))
    }

    /// Area of each cell, (num_cells,) float64, in the mesh's unit squared; exact for straight edges.
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, cell_areas(&self.inner))
    }

    /// Nodes around the cells: for each type in order, an (m, k) array of node indices, edge middles included.
    fn outlines<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<i64>>>> {
        let blocks = self.blocks(Some(CellType::outline));
        blocks.into_iter().map(|(cell_type, nodes)| table(py, nodes, cell_type.outline().len())).collect()
    }

    /// Small strains at the centre of each cell.
    ///
    /// Parameters
    /// ----------
    /// displacement : (n, 2) array_like
    ///     Displacement of each node, in the mesh's unit.
    ///
    /// Returns
    /// -------
    /// (num_cells, 3) float64
    ///     ``eps_xx, eps_yy, eps_xy``: tension positive, shear as the tensor component.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the displacement does not have one row per node.
    fn strains<'py>(&self, py: Python<'py>, displacement: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let displacement = rows::<2>(displacement, "displacement", argument_error)?;
        self.check_nodal("displacement", displacement.len())?;
        to_array(py, &cell_strains(&self.inner, &displacement))
    }

    /// A nodal field anywhere in the mesh.
    ///
    /// Parameters
    /// ----------
    /// nodal : (n, k) array_like
    ///     ``k`` numbers per node.
    /// points : (m, 2) or (m, 3) array_like
    ///     Where; the third coordinate is ignored.
    ///
    /// Returns
    /// -------
    /// (m, k) float64
    ///     NaN outside the mesh.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the field does not have one row per node.
    fn interpolate<'py>(
        &self,
        py: Python<'py>,
        nodal: &Bound<'py, PyAny>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let field = matrix(nodal, "nodal", argument_error)?;
        let (points, _) = arrays::points(points, "points", argument_error)?;
        let (height, width) = (field.as_array().nrows(), field.as_array().ncols());
        self.check_nodal("nodal", height)?;
        let field: Vec<f64> = field.as_array().iter().copied().collect();
        let values = run(py, None, |_| {
            let plane: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
            Ok(interpolate_field(&self.inner, &field, width, &plane))
        })?;
        PyArray::from_vec(py, values).reshape([points.len(), width])
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>)> {
        Ok((self.points(py)?, self.cells(py)?))
    }

    fn __repr__(&self) -> String {
        let blocks = self.blocks(None);
        let counts: Vec<String> = blocks.iter().map(|(t, c)| format!("{} {t}", c.len() / t.num_nodes())).collect();
        format!("Mesh({} nodes, {})", self.inner.num_nodes(), counts.join(", "))
    }
}

impl Mesh {
    /// Node indices by type, in the order of the cells; `local` picks and orders the nodes of a cell.
    fn blocks(&self, local: Option<fn(CellType) -> &'static [usize]>) -> Vec<(CellType, Vec<i64>)> {
        let mut blocks: Vec<(CellType, Vec<i64>)> = Vec::new();
        for cell in self.inner.cells() {
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

    fn check_nodal(&self, name: &str, found: usize) -> PyResult<()> {
        let expected = self.inner.num_nodes();
        let message = || format!("{name} must have one row per node of the mesh: {expected}, got {found}");
        if found == expected { Ok(()) } else { Err(argument_error(message())) }
    }
}

fn table(py: Python<'_>, numbers: Vec<i64>, width: usize) -> PyResult<Bound<'_, PyArray2<i64>>> {
    let height = numbers.len() / width;
    PyArray::from_vec(py, numbers).reshape([height, width])
}

/// Regular mesh of a rectangle.
///
/// Parameters
/// ----------
/// bounds : (x0, y0, x1, y1)
///     Corners, in the mesh's unit.
/// size : float
///     Wanted length of the cells' edges; the cells fill the rectangle exactly.
/// cell : {"quad", "triangle", "triangle6", "quad8", "quad9"}
///     Type of the cells; triangles halve the quads along alternating diagonals.
///
/// Returns
/// -------
/// Mesh
///
/// Raises
/// ------
/// MeshError
///     If the bounds are empty or not finite, the size is not positive, or the cell type unknown.
#[pyfunction]
#[pyo3(signature = (bounds, size=20.0, cell="quad"))]
pub(crate) fn rectangle_mesh(bounds: [f64; 4], size: f64, cell: &str) -> PyResult<Mesh> {
    let cell_type = CellType::from_str(cell).map_err(IntoPyErr::into_py_err)?;
    let inner = fedic::rectangle_mesh(bounds, size, cell_type).map_err(IntoPyErr::into_py_err)?;
    Ok(Mesh { inner, dimension: 2 })
}
