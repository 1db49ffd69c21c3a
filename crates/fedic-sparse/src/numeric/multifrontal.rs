//! Multifrontal elimination of the supernodes of a task (Duff and Reid 1983).

use faer::linalg::cholesky::llt::factor::LltError;

use crate::symbolic::{NONE, RelativeRange, Structure, Task, find_relative_ranges};

use super::front::Front;
use super::packed::{StoredFloat, pack};

/// Update matrix (Schur complement) of a supernode for its rows below: square, by columns.
#[derive(Default)]
pub(super) struct Update {
    supernode: usize,
    values: Vec<f64>,
}

/// State of the elimination within one task.
pub(super) struct Multifrontal<'a> {
    structure: &'a Structure,
    /// Replaces smaller pivots.
    replacement: Option<f64>,
    /// Update matrices for supernodes not yet eliminated; those for the same parent are adjacent.
    pending: Vec<Update>,
    /// Buffers for reuse.
    spare: Vec<Vec<f64>>,
    ranges: Vec<RelativeRange>,
}

impl<'a> Multifrontal<'a> {
    pub(super) fn new(structure: &'a Structure, replacement: Option<f64>, children: Vec<Update>) -> Self {
        Self { structure, replacement, pending: children, spare: Vec::new(), ranges: Vec::new() }
    }

    /// Eliminates the supernodes of a task, packs their columns one after the other and returns the pivots.
    pub(super) fn run<T: StoredFloat>(
        &mut self,
        task: &Task,
        matrix: &[f64],
        mut packed: &mut [T],
    ) -> Result<Vec<f64>, LltError> {
        let structure = self.structure;
        let mut pivots = Vec::with_capacity(task.columns.len() * structure.block);
        let mut columns = Vec::new();
        for supernode in task.supernodes.clone() {
            let shape = structure.shape(supernode);
            columns.clear();
            columns.resize(shape.rows * shape.columns, 0.0);
            let mut update = self.spare.pop().unwrap_or_default();
            update.clear();
            update.resize(shape.rows_below().pow(2), 0.0);
            let mut front = Front { columns: &mut columns, update: &mut update, shape };
            front.assemble(structure, supernode, matrix);
            self.assemble_children(supernode, &mut front);
            front.eliminate(self.replacement)?;
            pivots.extend((0..shape.columns).map(|j| columns[j * shape.rows + j].powi(2)));
            let own;
            (own, packed) = packed.split_at_mut(shape.packed_len());
            pack(&columns, shape.rows, own);
            if structure.parent[supernode] != NONE {
                self.pending.push(Update { supernode, values: update });
            }
        }
        Ok(pivots)
    }

    /// Adds the update matrices of the children of a supernode to its front.
    fn assemble_children(&mut self, supernode: usize, front: &mut Front<'_>) {
        let structure = self.structure;
        let is_child = |update: &Update| structure.parent[update.supernode] as usize == supernode;
        let first = self.pending.iter().rposition(|update| !is_child(update)).map_or(0, |last| last + 1);
        for child in self.pending.drain(first..) {
            let own = structure.rows(child.supernode);
            find_relative_ranges(own, &structure.columns(supernode), structure.rows(supernode), &mut self.ranges);
            self.ranges.iter_mut().for_each(|range| *range = range.expanded(structure.block));
            front.extend_add(&child.values, &self.ranges);
            self.spare.push(child.values);
        }
    }

    /// The update matrix of the last supernode.
    pub(super) fn into_update(mut self) -> Update {
        self.pending.pop().unwrap_or_default()
    }
}
