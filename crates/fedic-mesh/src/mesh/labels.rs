//! Labels of nodes and cells: their numbers in the program that made the mesh.

use super::Mesh;
use crate::MeshError;

impl Mesh {
    /// Largest label.
    pub const MAX_LABEL: i64 = 1 << 53;

    /// Label of each node, if the nodes have any.
    pub fn node_labels(&self) -> Option<&[i64]> {
        self.node_labels.as_deref()
    }

    /// Label of each cell, if the cells have any.
    pub fn cell_labels(&self) -> Option<&[i64]> {
        self.cell_labels.as_deref()
    }

    /// The mesh with these labels instead of its own.
    ///
    /// # Errors
    ///
    /// [`MeshError::LabelCount`] if there is not one label for each node, or cell; [`MeshError::InvalidLabel`] if one is not from 1 to
    /// [`MAX_LABEL`](Self::MAX_LABEL); [`MeshError::RepeatedLabel`] if two are equal.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, rectangle_mesh};
    /// let mesh = rectangle_mesh([0.0, 0.0, 1.0, 1.0], 1.0, CellType::Quad)?;
    /// let mesh = mesh.with_labels(Some(vec![11, 12, 21, 22]), None)?;
    /// assert_eq!(mesh.scaled(2.0)?.node_labels(), Some([11, 12, 21, 22].as_slice()));
    /// assert_eq!(mesh.cell_labels(), None);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn with_labels(
        mut self,
        node_labels: Option<Vec<i64>>,
        cell_labels: Option<Vec<i64>>,
    ) -> Result<Self, MeshError> {
        check("node", node_labels.as_deref(), self.num_nodes())?;
        check("cell", cell_labels.as_deref(), self.num_cells())?;
        self.node_labels = node_labels;
        self.cell_labels = cell_labels;
        Ok(self)
    }

    /// Labels of some nodes of this mesh.
    pub(super) fn labels_of(&self, nodes: &[u32]) -> Option<Vec<i64>> {
        self.node_labels.as_ref().map(|labels| nodes.iter().map(|&node| labels[node as usize]).collect())
    }

    /// Labels of the nodes and of some new ones, which follow the largest; none if that would be too large.
    pub(super) fn labels_with_more(&self, count: usize) -> Option<Vec<i64>> {
        let mut labels = self.node_labels.clone()?;
        let largest = labels.iter().copied().max().unwrap_or_default();
        labels.extend((largest + 1..).take(count));
        labels.last().is_none_or(|&last| last <= Self::MAX_LABEL).then_some(labels)
    }
}

fn check(kind: &'static str, labels: Option<&[i64]>, expected: usize) -> Result<(), MeshError> {
    let Some(labels) = labels else { return Ok(()) };
    if labels.len() != expected {
        return Err(MeshError::LabelCount { kind, expected, found: labels.len() });
    }
    if let Some(index) = labels.iter().position(|label| !(1..=Mesh::MAX_LABEL).contains(label)) {
        return Err(MeshError::InvalidLabel { kind, index, label: labels[index] });
    }
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_unstable_by_key(|&index| (labels[index], index));
    match order.windows(2).find(|pair| labels[pair[0]] == labels[pair[1]]) {
        Some(pair) => Err(MeshError::RepeatedLabel { kind, indices: [pair[0], pair[1]], label: labels[pair[0]] }),
        None => Ok(()),
    }
}
