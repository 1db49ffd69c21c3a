//! The mesh: nodes, cells of any mixture of types, validated once so that everything after can trust it.

use crate::isoparametric::determinant;
use crate::{CellType, MAX_NODES, MeshError, jacobian};

/// Jacobians smaller than this fraction of the squared size of their cell count as zero.
const FLAT: f64 = 1e-9;

/// A surface mesh. All cells turn counter-clockwise in the `(x, y)` plane of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    cell_types: Vec<CellType>,
    offsets: Vec<usize>,
    nodes: Vec<u32>,
    flipped: Vec<usize>,
}

/// One cell of a [`Mesh`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell<'a> {
    /// Type of the cell.
    pub cell_type: CellType,
    /// Its nodes, in meshio's order.
    pub nodes: &'a [u32],
}

impl Mesh {
    /// Checks and keeps a mesh. `blocks` hold the connectivity of all cells of one type, cell after cell.
    ///
    /// Cells listed clockwise are turned round (see [`Mesh::flipped`]); nodes that no cell uses are kept.
    ///
    /// # Errors
    ///
    /// [`MeshError`] where there is no cell, a coordinate is not finite, a cell refers to a node that does not exist,
    /// or cells have zero area or a Jacobian of changing sign.
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
        if let Some(node) = points.iter().position(|p| p.iter().any(|c| !c.is_finite())) {
            return Err(MeshError::NonFinitePoint { node });
        }
        let mut mesh =
            Self { points, cell_types: Vec::new(), offsets: vec![0], nodes: Vec::new(), flipped: Vec::new() };
        for (cell_type, connectivity) in blocks {
            mesh.push_block(*cell_type, connectivity)?;
        }
        if mesh.cell_types.is_empty() {
            return Err(MeshError::Empty);
        }
        mesh.orient()?;
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

    fn orient(&mut self) -> Result<(), MeshError> {
        let mut degenerate = Vec::new();
        for index in 0..self.num_cells() {
            let cell_type = self.cell_types[index];
            let (points, num_nodes) = self.cell_points_xy(index);
            match turn(cell_type, &points[..num_nodes]) {
                Some(Turn::CounterClockwise) => {}
                Some(Turn::Clockwise) => {
                    let nodes = &mut self.nodes[self.offsets[index]..self.offsets[index + 1]];
                    let old = nodes.to_vec();
                    for (node, &from) in nodes.iter_mut().zip(cell_type.reversed()) {
                        *node = old[from];
                    }
                    self.flipped.push(index);
                }
                None => degenerate.push(index),
            }
        }
        if degenerate.is_empty() { Ok(()) } else { Err(MeshError::DegenerateCells { cells: degenerate }) }
    }

    /// Coordinates of the nodes; the third is zero for a plane mesh.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Number of nodes, those that no cell uses included.
    pub fn num_nodes(&self) -> usize {
        self.points.len()
    }

    /// Number of cells over all types.
    pub fn num_cells(&self) -> usize {
        self.cell_types.len()
    }

    /// The cell of an index, counted over the blocks in the order they were given.
    ///
    /// # Panics
    ///
    /// If there is no such cell.
    pub fn cell(&self, index: usize) -> Cell<'_> {
        Cell { cell_type: self.cell_types[index], nodes: &self.nodes[self.offsets[index]..self.offsets[index + 1]] }
    }

    /// All cells in their order.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = Cell<'_>> {
        (0..self.num_cells()).map(|index| self.cell(index))
    }

    /// Coordinates of the nodes of a cell.
    pub fn cell_points(&self, index: usize) -> Vec<[f64; 3]> {
        self.cell(index).nodes.iter().map(|&n| self.points[n as usize]).collect()
    }

    /// Plane coordinates of the nodes of a cell, and how many they are; without allocation, for loops over points.
    pub(crate) fn cell_points_xy(&self, index: usize) -> ([[f64; 2]; MAX_NODES], usize) {
        let nodes = self.cell(index).nodes;
        let mut points = [[0.0; 2]; MAX_NODES];
        for (point, &node) in points.iter_mut().zip(nodes) {
            let [x, y, _] = self.points[node as usize];
            *point = [x, y];
        }
        (points, nodes.len())
    }

    /// Cells that were given clockwise and have been turned round.
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

    /// The same mesh without the nodes that no cell uses, and for each node kept its index here.
    pub fn compact(&self) -> (Self, Vec<u32>) {
        let used = self.used_nodes();
        let kept: Vec<u32> = (0..self.num_nodes() as u32).filter(|&n| used[n as usize]).collect();
        let mut renumbered = vec![0_u32; self.num_nodes()];
        for (new, &old) in kept.iter().enumerate() {
            renumbered[old as usize] = new as u32;
        }
        let mesh = Self {
            points: kept.iter().map(|&n| self.points[n as usize]).collect(),
            nodes: self.nodes.iter().map(|&n| renumbered[n as usize]).collect(),
            ..self.clone()
        };
        (mesh, kept)
    }
}

enum Turn {
    CounterClockwise,
    Clockwise,
}

/// Which way a cell turns; `None` where its area is zero or its Jacobian changes sign.
fn turn(cell_type: CellType, nodes: &[[f64; 2]]) -> Option<Turn> {
    let determinant_at = |at| determinant(&jacobian(cell_type, nodes, at));
    let extent = |d: usize| {
        let (low, high) = nodes.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[d]), h.max(p[d])));
        high - low
    };
    let flat = FLAT * (extent(0).powi(2) + extent(1).powi(2));
    let centre = determinant_at(cell_type.reference_centre());
    let same_sign = |sign: f64| {
        sign * centre > flat && cell_type.reference_nodes().iter().all(|&at| sign * determinant_at(at) >= -flat)
    };
    if same_sign(1.0) {
        Some(Turn::CounterClockwise)
    } else if same_sign(-1.0) {
        Some(Turn::Clockwise)
    } else {
        None
    }
}
