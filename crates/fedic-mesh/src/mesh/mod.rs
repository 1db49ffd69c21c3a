//! The mesh: nodes, cells of any mixture of types, named sets and labels, validated on construction.

mod boundary;
mod coincident;
mod collapsed;
mod distortion;
mod edges;
mod hanging;
mod labels;
mod orientation;
mod sets;
mod slits;
mod split;
mod transform;

use std::collections::{BTreeMap, BTreeSet};

pub use boundary::BoundaryEdge;
pub use edges::CellEdge;
pub use sets::MeshSet;
pub use split::LineError;

use crate::{CellType, MAX_NODES, MeshError};

/// A surface mesh, plane or in space.
///
/// The cells of a plane mesh are counter-clockwise in the `(x, y)` plane. In a surface in space neighbouring cells have the
/// same orientation: the one in which most of the area of their connected part is counter-clockwise seen from `+z`, or, if
/// that part is vertical or closed, the orientation of its first cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    cell_types: Vec<CellType>,
    offsets: Vec<usize>,
    nodes: Vec<u32>,
    flipped: Vec<usize>,
    sets: BTreeMap<String, MeshSet>,
    node_labels: Option<Vec<i64>>,
    cell_labels: Option<Vec<i64>>,
}

/// One cell of a [`Mesh`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell<'a> {
    /// Type of the cell.
    pub cell_type: CellType,
    /// Indices of the nodes, in meshio's order.
    pub nodes: &'a [u32],
}

impl Mesh {
    /// Checks and stores a mesh. Each block holds the connectivity of cells of one type, cell by cell.
    ///
    /// Cells of the wrong orientation are reversed (see [`Mesh::flipped`]); nodes that no cell uses are kept.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if there is no cell, a coordinate is not finite, a cell refers to a node that does not exist, or cells
    /// have zero area, a Jacobian that changes sign or repeated nodes other than those of
    /// [`collapsed_as_triangles`](Self::collapsed_as_triangles).
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, Mesh};
    /// let points = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(points, &[(CellType::Quad, vec![0, 3, 2, 1])])?;
    /// assert_eq!(mesh.cell(0).nodes, [0, 1, 2, 3]);
    /// assert_eq!(mesh.flipped(), [0]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn new(points: Vec<[f64; 3]>, blocks: &[(CellType, Vec<i64>)]) -> Result<Self, MeshError> {
        let mut mesh = Self {
            points,
            cell_types: Vec::new(),
            offsets: vec![0],
            nodes: Vec::new(),
            flipped: Vec::new(),
            sets: BTreeMap::new(),
            node_labels: None,
            cell_labels: None,
        };
        mesh.check_points()?;
        for (cell_type, connectivity) in blocks {
            mesh.push_block(*cell_type, connectivity)?;
        }
        if mesh.cell_types.is_empty() {
            return Err(MeshError::Empty);
        }
        mesh.orient()?;
        mesh.check_repeated_nodes()?;
        Ok(mesh)
    }

    fn push_block(&mut self, cell_type: CellType, connectivity: &[i64]) -> Result<(), MeshError> {
        let per_cell = cell_type.num_nodes();
        if !connectivity.len().is_multiple_of(per_cell) {
            return Err(MeshError::WrongNodeCount { cell_type, found: connectivity.len() });
        }
        let num_points = self.points.len();
        for cell_nodes in connectivity.chunks_exact(per_cell) {
            for &node in cell_nodes {
                let valid = u32::try_from(node).ok().filter(|&n| (n as usize) < num_points);
                let cell = self.cell_types.len();
                self.nodes.push(valid.ok_or(MeshError::NodeOutOfRange { cell, cell_type, node, num_points })?);
            }
            self.cell_types.push(cell_type);
            self.offsets.push(self.nodes.len());
        }
        Ok(())
    }

    fn check_points(&self) -> Result<(), MeshError> {
        match self.points.iter().position(|p| p.iter().any(|c| !c.is_finite())) {
            Some(node) => Err(MeshError::NonFinitePoint { node }),
            None => Ok(()),
        }
    }

    /// Reverses cells of the wrong orientation.
    fn orient(&mut self) -> Result<(), MeshError> {
        let reversed = orientation::cells_to_reverse(self)?;
        for &index in &reversed {
            let nodes = &mut self.nodes[self.offsets[index]..self.offsets[index + 1]];
            let old = nodes.to_vec();
            for (node, &from) in nodes.iter_mut().zip(self.cell_types[index].reversed()) {
                *node = old[from];
            }
        }
        // A cell reversed twice is as it was given.
        let (before, now) = (BTreeSet::from_iter(self.flipped.drain(..)), BTreeSet::from_iter(reversed));
        self.flipped = before.symmetric_difference(&now).copied().collect();
        Ok(())
    }

    /// Coordinates of the nodes, in the mesh's unit; the third is zero for a plane mesh.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Number of nodes, including those that no cell uses.
    pub fn num_nodes(&self) -> usize {
        self.points.len()
    }

    /// Number of cells of all types.
    pub fn num_cells(&self) -> usize {
        self.cell_types.len()
    }

    /// The cell of an index; cells are numbered over the blocks in the order given.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn cell(&self, index: usize) -> Cell<'_> {
        Cell { cell_type: self.cell_types[index], nodes: &self.nodes[self.offsets[index]..self.offsets[index + 1]] }
    }

    /// All cells in order.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = Cell<'_>> {
        (0..self.num_cells()).map(|index| self.cell(index))
    }

    /// Coordinates of the nodes of a cell.
    pub fn cell_points(&self, index: usize) -> Vec<[f64; 3]> {
        self.cell(index).nodes.iter().map(|&n| self.points[n as usize]).collect()
    }

    /// Coordinates of the nodes of a cell and their number, without allocation.
    pub(crate) fn cell_points_array(&self, index: usize) -> ([[f64; 3]; MAX_NODES], usize) {
        let nodes = self.cell(index).nodes;
        let mut points = [[0.0; 3]; MAX_NODES];
        for (point, &node) in points.iter_mut().zip(nodes) {
            *point = self.points[node as usize];
        }
        (points, nodes.len())
    }

    /// Plane coordinates of the nodes of a cell and their number, without allocation.
    pub(crate) fn cell_points_xy(&self, index: usize) -> ([[f64; 2]; MAX_NODES], usize) {
        let nodes = self.cell(index).nodes;
        let mut points = [[0.0; 2]; MAX_NODES];
        for (point, &node) in points.iter_mut().zip(nodes) {
            let [x, y, _] = self.points[node as usize];
            *point = [x, y];
        }
        (points, nodes.len())
    }

    /// Cells that have been reversed relative to the order given, ascending.
    pub fn flipped(&self) -> &[usize] {
        &self.flipped
    }

    /// For each node, whether a cell uses it.
    pub fn used_nodes(&self) -> Vec<bool> {
        let mut used = vec![false; self.num_nodes()];
        for &node in &self.nodes {
            used[node as usize] = true;
        }
        used
    }

    /// The mesh without the nodes that no cell uses, and for each node of it the index in this mesh.
    pub fn compact(&self) -> (Self, Vec<u32>) {
        let used = self.used_nodes();
        let kept: Vec<u32> = (0..self.num_nodes() as u32).filter(|&n| used[n as usize]).collect();
        let mut renumbered = vec![0_u32; self.num_nodes()];
        for (new, &old) in kept.iter().enumerate() {
            renumbered[old as usize] = new as u32;
        }
        let sets = self.sets.iter().map(|(name, set)| {
            let nodes = set.nodes.iter().filter(|&&n| used[n as usize]).map(|&n| renumbered[n as usize]).collect();
            (name.clone(), MeshSet { nodes, cells: set.cells.clone() })
        });
        let mesh = Self {
            sets: sets.collect(),
            node_labels: self.labels_of(&kept),
            points: kept.iter().map(|&n| self.points[n as usize]).collect(),
            nodes: self.nodes.iter().map(|&n| renumbered[n as usize]).collect(),
            ..self.clone()
        };
        (mesh, kept)
    }
}
