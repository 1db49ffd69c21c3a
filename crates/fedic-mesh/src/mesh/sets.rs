//! Named sets of nodes and cells.

use std::collections::BTreeMap;

use super::Mesh;
use crate::MeshError;

/// A named set of nodes and cells of a mesh; see [`Mesh::with_sets`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeshSet {
    /// Indices of the nodes, ascending.
    pub nodes: Vec<u32>,
    /// Indices of the cells, ascending.
    pub cells: Vec<u32>,
}

impl Mesh {
    /// Named sets of nodes and cells.
    pub fn sets(&self) -> &BTreeMap<String, MeshSet> {
        &self.sets
    }

    /// The mesh with these named sets instead of its own.
    ///
    /// Indices are sorted and repeated ones dropped. A set of cells without nodes gets the nodes of its cells.
    ///
    /// # Errors
    ///
    /// [`MeshError::SetOutOfRange`] if a set refers to a node or cell that does not exist.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, MeshSet, rectangle_mesh};
    /// let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad)?;
    /// let left = MeshSet { nodes: vec![], cells: vec![0] };
    /// let mesh = mesh.with_sets([("left".to_owned(), left)])?;
    /// assert_eq!(mesh.sets()["left"].nodes, [0, 1, 3, 4]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn with_sets(mut self, sets: impl IntoIterator<Item = (String, MeshSet)>) -> Result<Self, MeshError> {
        let mut checked = BTreeMap::new();
        for (name, mut set) in sets {
            let out_of_range = |kind, indices: &[u32], count: usize| {
                let index = indices.iter().copied().find(|&index| index as usize >= count)?;
                Some(MeshError::SetOutOfRange { name: name.clone(), kind, index, count })
            };
            if let Some(error) = out_of_range("node", &set.nodes, self.num_nodes())
                .or_else(|| out_of_range("cell", &set.cells, self.num_cells()))
            {
                return Err(error);
            }
            sort_unique(&mut set.cells);
            if set.nodes.is_empty() {
                set.nodes = self.nodes_of_cells(&set.cells);
            }
            sort_unique(&mut set.nodes);
            checked.insert(name, set);
        }
        self.sets = checked;
        Ok(self)
    }

    /// Nodes of some cells, ascending.
    pub(super) fn nodes_of_cells(&self, cells: &[u32]) -> Vec<u32> {
        let mut nodes = cells.iter().flat_map(|&cell| self.cell(cell as usize).nodes).copied().collect();
        sort_unique(&mut nodes);
        nodes
    }
}

fn sort_unique(indices: &mut Vec<u32>) {
    indices.sort_unstable();
    indices.dedup();
}
