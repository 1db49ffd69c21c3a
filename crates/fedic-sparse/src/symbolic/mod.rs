//! Symbolic factorization: supernodes of the factor, their rows, and the task schedule. Imports the ordering.

mod column_counts;
mod elimination_tree;
mod entries;
mod relative_indices;
mod schedule;
mod shape;
mod structure;
mod supernodes;

use std::ops::Range;

use crate::Pattern;
use crate::ordering::Graph;

pub(crate) use elimination_tree::NONE;
pub(crate) use relative_indices::{RelativeRange, find_relative_ranges};
pub(crate) use schedule::{Schedule, Task, Threading, lock};
pub(crate) use shape::Shape;
pub(crate) use structure::Structure;

/// The result of the symbolic factorization of a pattern.
#[derive(Debug)]
pub(crate) struct SymbolicFactor {
    pub(crate) structure: Structure,
    pub(crate) schedule: Schedule,
}

impl SymbolicFactor {
    /// Analyses a pattern whose nodes are eliminated in this order or an equivalent one.
    pub(crate) fn new(pattern: &Pattern, graph: &Graph, order: &[u32]) -> Self {
        let structure = Structure::new(pattern, graph, order);
        let schedule = Schedule::new(&structure);
        Self { structure, schedule }
    }

    /// The packed columns of each task among those of all supernodes.
    pub(crate) fn packed_ranges(&self) -> Vec<Range<usize>> {
        let ranges = self.schedule.tasks().iter().scan(0, |end, task| {
            let start = *end;
            *end += self.structure.packed_len(&task.supernodes);
            Some(start..*end)
        });
        ranges.collect()
    }
}
