//! Meshes cut along the edges of their cells.

mod cut;
mod error;
mod fans;
mod path;

pub use error::LineError;
use fans::{Separation, separations};
use path::EdgeNetwork;

use super::{Mesh, MeshSet};
use crate::MeshError;

impl Mesh {
    /// The mesh cut along a line that follows edges of its cells, so that the displacement may jump across it.
    ///
    /// The points of the line are at nodes, and the edges between one point and the next lie on the straight line, or there is one edge
    /// between the two, which may be curved. Points and nodes may be 1 % of the shortest edge there away from each other and from
    /// the line. A line through any nodes is made of their [`points`](Self::points).
    ///
    /// Where the line separates the cells around a node, those to the left of it, seen from the side from which cells are
    /// counter-clockwise, keep the node and the others get a new one at its place. An end of the line inside the mesh stays single. Cells
    /// keep their order and all nodes their indices; new nodes come last, in the order of the line, and their labels follow the largest
    /// one. Sets get the new nodes of their nodes; those that hold the nodes of their cells and no others still do.
    ///
    /// [`coincident_nodes`](Self::coincident_nodes) gives the pairs of nodes, [`slits`](Self::slits) the pairs of edges, and
    /// [`merge_nodes`](Self::merge_nodes) joins them again.
    ///
    /// # Errors
    ///
    /// [`MeshError::Line`] if the line does not follow edges or separates nothing.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, Mesh, rectangle_mesh};
    /// let mesh = rectangle_mesh([0.0, 0.0, 3.0, 2.0], 1.0, CellType::Quad)?;
    /// // A crack from the left border to the node at (2, 1), which is its tip.
    /// let cracked = mesh.split(&[[0.0, 1.0, 0.0], [2.0, 1.0, 0.0]])?;
    /// assert_eq!(cracked.num_nodes(), mesh.num_nodes() + 2);
    /// assert_eq!(cracked.coincident_nodes(Mesh::COINCIDENT), [[4, 12], [5, 13]]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn split(&self, line: &[[f64; 3]]) -> Result<Self, MeshError> {
        let places = self.places(Self::COINCIDENT);
        let path = EdgeNetwork::new(self, &places).path(line)?;
        let separations = separations(self, &places, &path)?;
        if separations.is_empty() {
            return Err(LineError::CutsNothing.into());
        }
        let mut mesh = self.clone();
        mesh.node_labels = self.labels_with_more(separations.len());
        for (new, Separation { node, cells }) in (self.num_nodes() as u32..).zip(&separations) {
            mesh.points.push(self.points[*node as usize]);
            for &cell in cells {
                let nodes = &mut mesh.nodes[self.offsets[cell]..self.offsets[cell + 1]];
                nodes.iter_mut().filter(|own| **own == *node).for_each(|own| *own = new);
            }
        }
        let sets = self.sets.iter().map(|(name, set)| (name.clone(), self.split_set(set, &mesh, &separations)));
        mesh.sets = sets.collect();
        mesh.orient()?;
        Ok(mesh)
    }

    /// A set in the mesh that is cut.
    fn split_set(&self, set: &MeshSet, cut: &Self, separations: &[Separation]) -> MeshSet {
        let nodes = if !set.cells.is_empty() && set.nodes == self.nodes_of_cells(&set.cells) {
            cut.nodes_of_cells(&set.cells)
        } else {
            let new = (self.num_nodes() as u32..).zip(separations);
            let doubled = new.filter(|(_, separation)| set.nodes.binary_search(&separation.node).is_ok());
            set.nodes.iter().copied().chain(doubled.map(|(node, _)| node)).collect()
        };
        MeshSet { nodes, cells: set.cells.clone() }
    }
}
