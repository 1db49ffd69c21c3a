//! The mesh.

use fedic::{CellType, Error, Locator, MeshError, cell_areas, interpolate_field, rotation_from_vector};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{self, matrix, rows, to_array};
use crate::connectivity::{blocks, read_blocks, table};
use crate::errors::{IntoPyErr, argument_error, mesh_error};
use crate::mesh_set;
use crate::strains::{self, StrainQuery};
use crate::worker::run;

/// Points that are interpolated between two looks at signals.
const CHUNK: usize = 1 << 16;

/// A surface mesh, plane or in space.
///
/// Cells of a plane mesh listed clockwise are reversed. In space, neighbouring cells get the same orientation, the one in
/// which most of their surface is counter-clockwise seen from ``+z``. Nodes that no cell uses are kept, so that indices do
/// not change. A quadrilateral with a repeated node, such as 2, 5, 6, 6, is measured as a triangle.
///
/// Parameters
/// ----------
/// points : (n, 2) or (n, 3) array_like of float
///     Coordinates of the nodes, in any unit; the displacement has the same unit.
/// cells : mapping of str to (m, k) array_like of int
///     Node indices of the cells of each type, under the names of `CELL_TYPES` (meshio's) and in meshio's node order.
/// sets : mapping of str to MeshSet, optional
///     Named sets of nodes and cells.
/// node_labels, cell_labels : (n,) and (num_cells,) array_like of int, optional
///     Numbers of the nodes and cells in another program: from 1 on, each once; cells over all types in order.
///
/// Raises
/// ------
/// MeshError
///     If an array has the wrong shape or type, a coordinate is not finite, a cell or set refers to a node or cell that does
///     not exist, labels are not as many, not positive or equal, or a cell has zero area, is folded or lists a node twice and is no triangle written as a quadrilateral; ``error.cells`` and ``error.nodes`` list the ones at fault.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct Mesh {
    pub(crate) inner: fedic::Mesh,
    pub(crate) dimension: usize,
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
    #[pyo3(signature = (points, cells, sets=None, node_labels=None, cell_labels=None))]
    fn new(
        points: &Bound<'_, PyAny>,
        cells: &Bound<'_, PyAny>,
        sets: Option<&Bound<'_, PyAny>>,
        node_labels: Option<&Bound<'_, PyAny>>,
        cell_labels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (points, dimension) = arrays::points(points, "points", mesh_error)?;
        let labels = |given: Option<&Bound<'_, PyAny>>, name: &str| {
            given.map(|labels| arrays::integers(labels, name, mesh_error)).transpose()
        };
        let (node_labels, cell_labels) = (labels(node_labels, "node_labels")?, labels(cell_labels, "cell_labels")?);
        let sets = sets.map(mesh_set::read).transpose()?.unwrap_or_default();
        let mesh = fedic::Mesh::new(points, &read_blocks(cells)?);
        let mesh = mesh.and_then(|mesh| mesh.with_sets(sets)?.with_labels(node_labels, cell_labels));
        Ok(Self { inner: mesh.map_err(IntoPyErr::into_py_err)?, dimension })
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

    /// Node indices of the cells of each type, (m, k) int64, after reorientation: copies.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let cells = PyDict::new(py);
        for (cell_type, connectivity) in blocks(&self.inner, None) {
            cells.set_item(cell_type.name(), table(py, connectivity, cell_type.num_nodes())?)?;
        }
        Ok(cells)
    }

    /// Named sets of nodes and cells, a dict of `MeshSet`: a copy.
    ///
    /// Filled by `read_mesh` from the sets and groups of the file, kept by the transformations, by `write` and by pickle.
    #[getter]
    fn sets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        mesh_set::to_dict(py, self.inner.sets())
    }

    /// Label of each node, (n,) int64: its number in the program that made the mesh; None if there are none. A copy.
    ///
    /// Filled by `read_mesh`, kept by the transformations, by pickle and in ``.inp`` files.
    #[getter]
    fn node_labels<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<i64>>> {
        self.inner.node_labels().map(|labels| PyArray1::from_slice(py, labels))
    }

    /// Label of each cell, (num_cells,) int64, over all types in order; see `node_labels`.
    #[getter]
    fn cell_labels<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<i64>>> {
        self.inner.cell_labels().map(|labels| PyArray1::from_slice(py, labels))
    }

    /// The mesh with other named sets.
    ///
    /// Parameters
    /// ----------
    /// sets : mapping of str to MeshSet
    ///     Sets of the returned mesh, instead of those of this mesh.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If a set refers to a node or cell that does not exist.
    fn with_sets(&self, sets: &Bound<'_, PyAny>) -> PyResult<Self> {
        let inner = self.inner.clone().with_sets(mesh_set::read(sets)?).map_err(IntoPyErr::into_py_err)?;
        Ok(Self { inner, dimension: self.dimension })
    }

    /// The mesh with all coordinates multiplied by a factor, as for a change of unit.
    ///
    /// Parameters
    /// ----------
    /// factor : float
    ///     Positive.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the factor is not a positive number.
    fn scaled(&self, factor: f64) -> PyResult<Self> {
        self.moved(self.inner.scaled(factor))
    }

    /// The mesh moved by a vector.
    ///
    /// Parameters
    /// ----------
    /// vector : (2,) or (3,) array_like
    ///     Translation, in the mesh's unit.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///     With points of 3 coordinates if the vector leaves the plane ``z = 0``.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the vector does not have 2 or 3 finite components.
    fn translated(&self, vector: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.moved(self.inner.translated(arrays::vector(vector, "vector", argument_error)?))
    }

    /// The mesh rotated about a point.
    ///
    /// Parameters
    /// ----------
    /// rotation : (3,) or (3, 3) array_like
    ///     Rotation vector, whose direction is the axis and whose length is the angle in radians, or rotation matrix. In the
    ///     plane: ``(0, 0, angle)``, counter-clockwise.
    /// centre : (2,) or (3,) array_like, optional
    ///     Fixed point, in the mesh's unit; the origin by default.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///     With points of 3 coordinates if the rotation leaves the plane ``z = 0``. Cells are oriented anew: those of a plane
    ///     mesh that is turned over are reversed.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the rotation has another shape, or the matrix is not orthonormal with determinant 1.
    #[pyo3(signature = (rotation, centre=None))]
    fn rotated(&self, rotation: &Bound<'_, PyAny>, centre: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let matrix = match arrays::numbers(rotation).as_deref() {
            Some(&[x, y, z]) => rotation_from_vector([x, y, z]),
            _ => rows::<3>(rotation, "rotation", argument_error)?.try_into().map_err(|rows: Vec<_>| {
                let shape = format!("({}, 3)", rows.len());
                argument_error(format!(
                    "rotation must be a rotation vector (3,) or a rotation matrix (3, 3), got {shape}"
                ))
            })?,
        };
        let centre = centre.map_or(Ok([0.0; 3]), |centre| arrays::vector(centre, "centre", argument_error))?;
        self.moved(self.inner.rotated(matrix, centre))
    }

    /// The mesh with nodes joined that are close to each other.
    ///
    /// Joined nodes become the one of the lowest index, at its place and with its label; the nodes that remain keep their order. Cells keep their
    /// numbers, and sets are renumbered. A quadrilateral that loses one edge is measured as a triangle.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float
    ///     Largest distance of joined nodes, in the mesh's unit; nodes may also be joined by way of others between them. With 0
    ///     nodes at the very same place are joined.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the tolerance is negative or not finite.
    /// MeshError
    ///     If a cell would lose its area; ``error.cells`` lists them.
    ///
    /// See Also
    /// --------
    /// coincident_nodes : Nodes to be joined.
    fn merge_nodes(&self, tolerance: f64) -> PyResult<Self> {
        self.moved(self.inner.merge_nodes(tolerance))
    }

    /// The mesh cut along edges of its cells, so that the displacement may jump there.
    ///
    /// Parameters
    /// ----------
    /// line : (k, 2) or (k, 3) array_like
    ///     Points of a line, at nodes of the mesh. Between one point and the next, the edges of cells lie on the straight line, or
    ///     one edge joins the two, which may be curved; ``mesh.points[nodes]`` is a line through any nodes. Points and nodes may be
    ///     1 % of the shortest edge there away from each other and from the line.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///     The same cells in the same order. Nodes keep their indices. Where the line separates cells, those to the right of it
    ///     (towards ``-y`` of a line along ``+x``) get a new node; new nodes come last, in the order of the line, and their labels follow the largest one. An end of the line inside the mesh stays single. Sets get the
    ///     new nodes of their nodes; those that hold the nodes of their cells and no others still do.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the line does not follow edges, or separates no cells; the message names the place.
    ///
    /// See Also
    /// --------
    /// coincident_nodes : The pairs of nodes along the cut, to its left and right.
    /// merge_nodes : Joins them again.
    fn split(&self, line: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.moved(self.inner.split(&arrays::points(line, "line", argument_error)?.0))
    }

    /// Nodes of cells at the place of another one.
    ///
    /// Two nodes are at one place if they are closer than 1e-4 times the longest edge at either of them. They make a seam, along
    /// which the displacement may jump: the two sides of a crack, or parts that were meshed side by side and not joined. The
    /// measurement warns of them.
    ///
    /// Returns
    /// -------
    /// (m, 2) int64
    ///     The lowest-numbered node at a place, and each other node there. Along a cut made by `split`: the node to the left of the
    ///     line and the one to the right, in the order of the line.
    fn coincident_nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let pairs = self.inner.coincident_nodes(fedic::Mesh::COINCIDENT).into_iter().flatten().map(i64::from).collect();
        table(py, pairs, 2)
    }

    /// Indices of nodes that lie on the edge of a cell without being its nodes, (m,) int64, ascending: parts whose nodes do not
    /// match along a seam. Edges are straight between their nodes.
    fn hanging_nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.inner.hanging_nodes(fedic::Mesh::COINCIDENT).into_iter().map(i64::from))
    }

    /// Indices of strongly distorted cells, (m,) int64, ascending: the area element at one of their nodes is less than 1/30 of
    /// that at another. Cells are numbered over all types in order.
    fn distorted_cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.inner.distorted_cells(fedic::Mesh::DISTORTED).into_iter().map(|cell| cell as i64))
    }

    /// Write the mesh with its named sets.
    ///
    /// The file is read back before it takes the place of an existing one, so that a file that does not hold the whole mesh
    /// is never left behind.
    ///
    /// Parameters
    /// ----------
    /// path : str or path
    ///     The suffix names the format: ``.vtu``, ``.inp`` (Abaqus), or any other that meshio writes. Formats without named
    ///     sets hold them as fields ``set:NAME`` of ones and zeros, if they hold fields. ``.inp`` alone holds the labels.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If the format is unknown or cannot hold the cell types, the nodes or the sets of the mesh.
    /// FedicError
    ///     If the file cannot be written.
    fn write(slf: &Bound<'_, Self>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        slf.py().import("fedic.io._mesh_writer")?.call_method1("write_mesh", (path, slf))?;
        Ok(())
    }

    /// Number of cells of all types.
    #[getter]
    fn num_cells(&self) -> usize {
        self.inner.num_cells()
    }

    /// Number of nodes, including those that no cell uses.
    #[getter]
    fn num_nodes(&self) -> usize {
        self.inner.num_nodes()
    }

    /// For each node, whether a cell uses it, (n,) bool.
    #[getter]
    fn used_nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.inner.used_nodes())
    }

    /// For each node, whether it lies on the boundary: on a piece of an edge that one cell only has, (n,) bool.
    #[getter]
    fn boundary_nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.inner.boundary_nodes())
    }

    /// Indices of the cells that have been reversed relative to the order given, ascending; cells are numbered over all types
    /// in order.
    #[getter]
    fn flipped_cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.inner.flipped().iter().map(|&cell| cell as i64))
    }

    /// Area of each cell in space, (num_cells,) float64, in the mesh's unit squared; exact for plane cells with straight edges.
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, cell_areas(&self.inner))
    }

    /// Nodes around the cells: for each type in order, an (m, k) array of node indices, including the nodes of the edges.
    fn outlines<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<i64>>>> {
        let blocks = blocks(&self.inner, Some(CellType::outline));
        blocks.into_iter().map(|(cell_type, nodes)| table(py, nodes, cell_type.outline().len())).collect()
    }

    /// Strains of a displacement field.
    ///
    /// Parameters
    /// ----------
    /// displacement : (n, 2) or (n, 3) array_like
    ///     Displacement of each node, in the mesh's unit; two components lie in the ``(x, y)`` plane. NaN where it is not
    ///     known.
    /// measure : {"green-lagrange", "hencky", "small"}
    ///     Strain measure; see `fedic.Strains`.
    /// at : {"cells", "nodes"} or (m, 2) or (m, 3) array_like, default "cells"
    ///     Centres of the cells, nodes (by L2 projection with the consistent mass matrix), or points in the mesh's frame; a
    ///     surface in space is searched in its projection onto the ``(x, y)`` plane, and a third coordinate is ignored.
    /// axes : float or "cylindrical", optional
    ///     Axes of the components. By default ``x`` and ``y`` in a mesh parallel to the ``(x, y)`` plane; on any other surface
    ///     axis 1 is the projection of ``x`` onto the tangent plane (of ``y``, if the surface is perpendicular to ``x``), and
    ///     axis 2 the normal times axis 1. A number is an angle in radians by which these axes are turned counter-clockwise.
    ///     ``"cylindrical"``: radial and circumferential direction about `centre`.
    /// centre : (2,) array_like, optional
    ///     Point of the cylinder axis, which is parallel to ``z``; the origin of the mesh's frame by default.
    /// valid_cells : (num_cells,) array_like of bool, optional
    ///     Cells whose strain counts; the others are NaN and take no part in the strain of their nodes. By default all.
    ///
    /// Returns
    /// -------
    /// Strains
    ///     NaN outside the mesh, in cells with a node whose displacement is NaN, in cells that are not valid, and at nodes of
    ///     no other cell. A finite strain is also NaN in a cell that a displacement of two components turns inside out.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If the displacement does not have one row per node, or another argument is unknown or has the wrong shape.
    #[pyo3(signature = (displacement, measure="green-lagrange", at=None, axes=None, *, centre=None, valid_cells=None))]
    #[allow(clippy::too_many_arguments)]
    fn strains<'py>(
        &self,
        py: Python<'py>,
        displacement: &Bound<'py, PyAny>,
        measure: &str,
        at: Option<&Bound<'py, PyAny>>,
        axes: Option<&Bound<'py, PyAny>>,
        centre: Option<&Bound<'py, PyAny>>,
        valid_cells: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let query = StrainQuery {
            measure: strains::measure(measure)?,
            places: strains::places(at)?,
            axes: strains::axes(axes, centre)?,
            valid_cells: valid_cells.map(|valid| strains::cell_flags(valid, &self.inner)).transpose()?,
        };
        let columns = matrix(displacement, "displacement", argument_error)?.as_array().ncols();
        let found = if columns == 3 {
            let displacement = self.nodal_vectors::<3>(displacement)?;
            run(py, None, |_| Ok(query.strains(&self.inner, &displacement)))?
        } else {
            let displacement = self.nodal_vectors::<2>(displacement)?;
            run(py, None, |_| Ok(query.strains(&self.inner, &displacement)))?
        };
        strains::to_python(py, query.measure, &found, self.dimension)
    }

    /// Values of a nodal field at points of the mesh.
    ///
    /// Parameters
    /// ----------
    /// nodal : (n, k) array_like
    ///     Field of ``k`` components per node.
    /// points : (m, 2) or (m, 3) array_like
    ///     Points in the ``(x, y)`` plane; a third coordinate is ignored.
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
        let values = run(py, None, |monitor| {
            let plane: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
            let locator = Locator::new(&self.inner);
            let mut values = Vec::with_capacity(plane.len() * width);
            for points in plane.chunks(CHUNK) {
                if monitor.cancelled() {
                    return Err(Error::Cancelled);
                }
                values.extend(interpolate_field(&locator, &field, width, points));
            }
            Ok(values)
        })?;
        PyArray::from_vec(py, values).reshape([points.len(), width])
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let labels = (self.node_labels(py), self.cell_labels(py));
        (self.points(py)?, self.cells(py)?, self.sets(py)?, labels.0, labels.1).into_pyobject(py)
    }

    fn __repr__(&self) -> String {
        let counts = blocks(&self.inner, None).into_iter().map(|(t, c)| format!("{} {t}", c.len() / t.num_nodes()));
        let counts: Vec<String> = counts.collect();
        format!("Mesh({} nodes, {})", self.inner.num_nodes(), counts.join(", "))
    }
}

impl Mesh {
    /// A mesh on moved points: plane as long as all points stay in `z = 0`.
    fn moved(&self, inner: Result<fedic::Mesh, MeshError>) -> PyResult<Self> {
        let inner = inner.map_err(IntoPyErr::into_py_err)?;
        let plane = self.dimension == 2 && inner.points().iter().all(|p| p[2] == 0.0);
        Ok(Self { inner, dimension: if plane { 2 } else { 3 } })
    }

    fn nodal_vectors<const D: usize>(&self, displacement: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; D]>> {
        let vectors = rows::<D>(displacement, "displacement", argument_error)?;
        self.check_nodal("displacement", vectors.len())?;
        Ok(vectors)
    }

    fn check_nodal(&self, name: &str, found: usize) -> PyResult<()> {
        let expected = self.inner.num_nodes();
        let message = || format!("{name} must have one row per node of the mesh: {expected}, got {found}");
        if found == expected { Ok(()) } else { Err(argument_error(message())) }
    }
}
