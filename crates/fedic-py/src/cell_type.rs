//! The cell types.

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMappingProxy, PyTuple};

use crate::arrays::to_array;

/// A cell type: its nodes, and its names and numbers in file formats.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct CellType {
    inner: fedic::CellType,
}

#[pymethods]
impl CellType {
    /// Name, meshio's.
    #[getter]
    fn name(&self) -> &'static str {
        self.inner.name()
    }

    /// Number of nodes.
    #[getter]
    fn num_nodes(&self) -> usize {
        self.inner.num_nodes()
    }

    /// Number of corners, 3 or 4.
    #[getter]
    fn num_corners(&self) -> usize {
        self.inner.num_corners()
    }

    /// Whether the cell is a triangle or a quadrilateral.
    #[getter]
    fn is_triangle(&self) -> bool {
        self.inner.is_triangle()
    }

    /// Number of intervals into which the nodes of an edge divide it.
    #[getter]
    fn edge_intervals(&self) -> usize {
        self.inner.edge_intervals()
    }

    /// Local indices of the nodes around the cell, counter-clockwise from the first corner.
    #[getter]
    fn outline<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.inner.outline())
    }

    /// Nodes in the reference domain, (num_nodes, 2) float64. Domains: triangle ``(0, 0) (1, 0) (0, 1)``, square ``[-1, 1]^2``.
    #[getter]
    fn reference_nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, self.inner.reference_nodes())
    }

    /// Shape functions at the centre of the cell, one per node.
    #[getter]
    fn centre_weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let values = fedic::shape_values(self.inner, self.inner.reference_centre());
        PyTuple::new(py, &values[..self.inner.num_nodes()])
    }

    /// Number of the type in VTK's formats.
    #[getter]
    fn vtk_type(&self) -> u8 {
        self.inner.data().vtk_type
    }

    /// Polynomial order for Gmsh's mesher; None if Gmsh does not make such cells.
    #[getter]
    fn gmsh_order(&self) -> Option<u8> {
        self.inner.data().gmsh.map(|gmsh| gmsh.order)
    }

    /// Whether Gmsh makes such cells as incomplete (serendipity) elements.
    #[getter]
    fn gmsh_incomplete(&self) -> bool {
        self.inner.data().gmsh.is_some_and(|gmsh| gmsh.incomplete)
    }

    /// Node counts in the names of Abaqus's surface elements of this type: ``"4"`` for ``CPS4R``, ``"65"`` for ``STRI65``.
    #[getter]
    fn abaqus_suffixes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.inner.data().abaqus_suffixes)
    }

    fn __repr__(&self) -> String {
        format!("CellType({})", self.inner)
    }
}

/// Adds `CELL_TYPES`, a read-only mapping of names to cell types, to the module.
pub(crate) fn add_cell_types(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let types = PyDict::new(module.py());
    for inner in fedic::CellType::ALL {
        types.set_item(inner.name(), CellType { inner }.into_pyobject(module.py())?)?;
    }
    module.add("CELL_TYPES", PyMappingProxy::new(module.py(), types.as_mapping()))
}
