//! Nodes at one place: finding them, and joining them.

use super::{Mesh, MeshSet};
use crate::MeshError;

/// Vector, not longer than one, along which nodes are sorted.
const SORTING_DIRECTION: [f64; 3] = [0.732_050_8, 0.563_471_6, 0.382_683_4];

impl Mesh {
    /// Distance, relative to the longest edge there, up to which the measurement takes nodes to be at one place, and a node to lie
    /// on an edge. Files of single precision round by 1e-5 of an edge.
    pub const COINCIDENT: f64 = 1e-4;

    /// Nodes of cells at the place of another one: pairs of the lowest node at a place and each other node there, ascending.
    ///
    /// Two nodes are at one place if they are closer than `relative` times the longest edge at either of them. Such nodes make
    /// a seam, along which the displacement may jump; the two sides of a crack are a seam as well.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, Mesh};
    /// let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    /// let mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec(), &[(CellType::Triangle, vec![0, 1, 2, 3, 4, 5])])?;
    /// assert_eq!(mesh.coincident_nodes(1e-4), [[1, 3], [2, 5]]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn coincident_nodes(&self, relative: f64) -> Vec<[u32; 2]> {
        let places = self.places(relative);
        (0..).zip(places).filter(|(node, first)| node != first).map(|(node, first)| [first, node]).collect()
    }

    /// The lowest node of cells at the place of each node, as [`coincident_nodes`](Self::coincident_nodes) finds them.
    pub(super) fn places(&self, relative: f64) -> Vec<u32> {
        let reach: Vec<f64> = self.longest_edges().into_iter().map(|length| relative * length).collect();
        let used = self.used_nodes();
        let nodes: Vec<u32> = (0..self.num_nodes() as u32).filter(|&node| used[node as usize]).collect();
        self.joined(nodes, |a, b| reach[a as usize].min(reach[b as usize]))
    }

    /// The mesh with nodes joined that are at most `tolerance` apart, in the mesh's unit, directly or by way of others.
    ///
    /// Joined nodes become the one of the lowest index, at its place and with its label; the nodes that remain keep their order. Cells keep theirs, and
    /// sets are renumbered. A quadrilateral that loses one edge is kept and measured as a triangle.
    ///
    /// # Errors
    ///
    /// [`MeshError::InvalidTolerance`] if the tolerance is negative or not finite; [`MeshError::CollapsedCells`] if a cell would
    /// lose its area.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, Mesh};
    /// let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1e-9], [1.0, 1.0], [0.0, 1.0]];
    /// let mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec(), &[(CellType::Triangle, vec![0, 1, 2, 3, 4, 5])])?;
    /// let joined = mesh.merge_nodes(1e-6)?;
    /// assert_eq!(joined.num_nodes(), 4);
    /// assert_eq!(joined.cell(1).nodes, [1, 3, 2]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn merge_nodes(&self, tolerance: f64) -> Result<Self, MeshError> {
        if !(tolerance.is_finite() && tolerance >= 0.0) {
            return Err(MeshError::InvalidTolerance { tolerance });
        }
        let joined = self.joined((0..self.num_nodes() as u32).collect(), |_, _| tolerance);
        let kept: Vec<u32> = (0..).zip(&joined).filter(|&(node, &first)| node == first).map(|(node, _)| node).collect();
        let mut renumbered = vec![0_u32; self.num_nodes()];
        for (new, &old) in (0..).zip(&kept) {
            renumbered[old as usize] = new;
        }
        let new_node = |&node: &u32| renumbered[joined[node as usize] as usize];
        let sets = self.sets.iter().map(|(name, set)| {
            let mut nodes: Vec<u32> = set.nodes.iter().map(new_node).collect();
            nodes.sort_unstable();
            nodes.dedup();
            (name.clone(), MeshSet { nodes, cells: set.cells.clone() })
        });
        let mut mesh = Self {
            points: kept.iter().map(|&node| self.points[node as usize]).collect(),
            nodes: self.nodes.iter().map(new_node).collect(),
            sets: sets.collect(),
            node_labels: self.labels_of(&kept),
            ..self.clone()
        };
        match mesh.orient().and_then(|()| mesh.check_repeated_nodes()) {
            Ok(()) => Ok(mesh),
            Err(MeshError::DegenerateCells { cells } | MeshError::RepeatedNodes { cells }) => {
                Err(MeshError::CollapsedCells { cells, tolerance })
            }
            Err(other) => Err(other),
        }
    }

    /// For each node the lowest one that it is joined to: nodes among `nodes` not further apart than `reach`, and, in turn, the
    /// nodes joined to either.
    fn joined(&self, mut nodes: Vec<u32>, reach: impl Fn(u32, u32) -> f64) -> Vec<u32> {
        let along = self.sorting_coordinates();
        nodes.sort_unstable_by(|&a, &b| along[a as usize].total_cmp(&along[b as usize]));
        let largest = nodes.iter().map(|&node| reach(node, node)).fold(0.0, f64::max);
        // Rounding of the sums.
        let window = largest + 1e-12 * nodes.iter().map(|&node| along[node as usize].abs()).fold(0.0, f64::max);
        let mut first: Vec<u32> = (0..self.num_nodes() as u32).collect();
        for (k, &a) in nodes.iter().enumerate() {
            let near = nodes[k + 1..].iter().take_while(|&&b| along[b as usize] - along[a as usize] <= window);
            for &b in near.filter(|&&b| self.distance(a, b) <= reach(a, b)) {
                let [a, b] = [a, b].map(|node| root(&mut first, node));
                first[a.max(b) as usize] = a.min(b);
            }
        }
        (0..self.num_nodes() as u32).map(|node| root(&mut first, node)).collect()
    }

    /// Coordinate of each node along a direction in which few nodes of a regular mesh coincide.
    pub(super) fn sorting_coordinates(&self) -> Vec<f64> {
        self.points.iter().map(Self::sorting_coordinate).collect()
    }

    /// Coordinate of a point along that direction.
    pub(super) fn sorting_coordinate(point: &[f64; 3]) -> f64 {
        point.iter().zip(SORTING_DIRECTION).map(|(c, d)| c * d).sum()
    }

    /// Distance of two nodes.
    pub(super) fn distance(&self, a: u32, b: u32) -> f64 {
        let [a, b] = [a, b].map(|node| self.points[node as usize]);
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// Length of the longest edge between the nodes around a cell that ends at each node; zero at nodes of no cell.
    fn longest_edges(&self) -> Vec<f64> {
        let mut longest = vec![0.0_f64; self.num_nodes()];
        for cell in self.cells() {
            let outline = cell.cell_type.outline();
            let mut shorter_of_cell = f64::INFINITY;
            for (k, &from) in outline.iter().enumerate() {
                let [a, b] = [from, outline[(k + 1) % outline.len()]].map(|local| cell.nodes[local]);
                let length = self.distance(a, b);
                shorter_of_cell = shorter_of_cell.min(length);
                for node in [a, b] {
                    longest[node as usize] = longest[node as usize].max(length);
                }
            }
            // Nodes inside a cell have no edge.
            for &node in cell.nodes {
                longest[node as usize] = longest[node as usize].max(shorter_of_cell);
            }
        }
        longest
    }
}

/// Lowest node of the set of joined nodes to which a node belongs.
fn root(first: &mut [u32], node: u32) -> u32 {
    let mut lowest = node;
    while first[lowest as usize] != lowest {
        lowest = first[lowest as usize];
    }
    let mut next = node;
    while first[next as usize] != lowest {
        next = std::mem::replace(&mut first[next as usize], lowest);
    }
    lowest
}
