//! Named sets of nodes and cells.

use std::collections::BTreeMap;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::arrays::{self, describe};
use crate::errors::{argument_error, mesh_error};

/// A set of nodes and cells of a mesh.
///
/// Parameters
/// ----------
/// nodes : (k,) array_like of int
///     Indices of the nodes. A set of cells without nodes gets the nodes of its cells when it becomes part of a mesh.
/// cells : (k,) array_like of int
///     Indices of the cells, over all types in order.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct MeshSet {
    inner: fedic::MeshSet,
}

#[pymethods]
impl MeshSet {
    #[new]
    #[pyo3(signature = (nodes=None, cells=None))]
    fn new(nodes: Option<&Bound<'_, PyAny>>, cells: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self { inner: fedic::MeshSet { nodes: indices(nodes, "nodes")?, cells: indices(cells, "cells")? } })
    }

    /// Indices of the nodes, ascending, (k,) int64: a copy.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        to_array(py, &self.inner.nodes)
    }

    /// Indices of the cells, ascending, (k,) int64, over all types in order: a copy.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        to_array(py, &self.inner.cells)
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>) {
        (self.nodes(py), self.cells(py))
    }

    fn __repr__(&self) -> String {
        format!("MeshSet({} nodes, {} cells)", self.inner.nodes.len(), self.inner.cells.len())
    }
}

/// Reads a mapping of names to sets.
pub(crate) fn read(sets: &Bound<'_, PyAny>) -> PyResult<Vec<(String, fedic::MeshSet)>> {
    let mapping = sets
        .cast::<PyMapping>()
        .map_err(|_| mesh_error(format!("sets must be a mapping of names to MeshSet, got {}", describe(sets))))?;
    let read_item = |item: Bound<'_, PyAny>| {
        let (name, set): (String, PyRef<'_, MeshSet>) = item
            .extract()
            .map_err(|_| mesh_error("sets must map names to MeshSet(nodes=..., cells=...)".to_owned()))?;
        Ok((name, set.inner.clone()))
    };
    mapping.items()?.into_iter().map(read_item).collect()
}

/// Named sets as a dict.
pub(crate) fn to_dict<'py>(py: Python<'py>, sets: &BTreeMap<String, fedic::MeshSet>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, set) in sets {
        dict.set_item(name, MeshSet { inner: set.clone() }.into_pyobject(py)?)?;
    }
    Ok(dict)
}

fn indices(object: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Vec<u32>> {
    let Some(object) = object else { return Ok(Vec::new()) };
    let refuse = || {
        argument_error(format!("{name} of a set must be a 1-dimensional array of indices, got {}", describe(object)))
    };
    let numbers = arrays::numbers(object).ok_or_else(refuse)?;
    let is_index = |x: f64| x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&x);
    let mut indices = Vec::new();
    for x in numbers {
        if !is_index(x) {
            return Err(argument_error(format!("{name} of a set must be indices from 0 on, got {x}")));
        }
        indices.push(x as u32);
    }
    indices.sort_unstable();
    indices.dedup();
    Ok(indices)
}

fn to_array<'py>(py: Python<'py>, indices: &[u32]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_iter(py, indices.iter().map(|&index| i64::from(index)))
}
