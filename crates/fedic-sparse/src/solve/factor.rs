//! The factor of one matrix and the triangular solves over its tasks.

use std::sync::{Arc, Mutex};

use fedic_memory::AlignedBuffer;

use crate::inverse::selected_inverse;
use crate::numeric::{PackedColumns, StoredFloat};
use crate::symbolic::{RelativeRange, SymbolicFactor, Task, Threading, find_relative_ranges, lock};
use crate::{SparseError, SpdFactor, SymmetricMatrix};

use super::supernode::Supernode;

/// Cholesky factor of one matrix.
#[derive(Debug, Clone)]
pub struct Factor {
    symbolic: Arc<SymbolicFactor>,
    values: Values,
}

/// Packed columns of all supernodes, one after the other.
#[derive(Debug, Clone)]
pub(crate) enum Values {
    Double(AlignedBuffer<f64>),
    Single(AlignedBuffer<f32>),
}

impl Factor {
    pub(crate) fn new(symbolic: Arc<SymbolicFactor>, values: Values) -> Self {
        Self { symbolic, values }
    }

    fn solve_with(&self, threading: Threading, rhs: &mut [f64]) {
        match &self.values {
            Values::Double(values) => Substitution::new(&self.symbolic, values, rhs.len()).solve(threading, rhs),
            Values::Single(values) => Substitution::new(&self.symbolic, values, rhs.len()).solve(threading, rhs),
        }
    }
}

impl SpdFactor for Factor {
    fn solve(&self, rhs: &mut [f64]) {
        self.solve_with(Threading::Parallel, rhs);
    }

    fn solve_sequentially(&self, rhs: &mut [f64]) {
        self.solve_with(Threading::Sequential, rhs);
    }

    fn selected_inverse(&self) -> Result<SymmetricMatrix, SparseError> {
        match &self.values {
            Values::Double(values) => selected_inverse(&self.symbolic, values),
            Values::Single(values) => selected_inverse(&self.symbolic, values),
        }
    }

    fn num_entries(&self) -> usize {
        match &self.values {
            Values::Double(values) => values.len(),
            Values::Single(values) => values.len(),
        }
    }

    fn is_compact(&self) -> bool {
        matches!(self.values, Values::Single(_))
    }
}

/// One forward and backward substitution with a number of right-hand sides.
struct Substitution<'a, T> {
    symbolic: &'a SymbolicFactor,
    values: &'a [T],
    num_sides: usize,
}

impl<'a, T: StoredFloat> Substitution<'a, T> {
    fn new(symbolic: &'a SymbolicFactor, values: &'a [T], rhs_len: usize) -> Self {
        let dofs = symbolic.structure.num_dofs().max(1);
        assert_eq!(rhs_len % dofs, 0, "one entry per degree of freedom and right-hand side");
        Self { symbolic, values, num_sides: rhs_len / dofs }
    }

    /// Replaces the right-hand sides by the solutions.
    fn solve(&self, threading: Threading, rhs: &mut [f64]) {
        let schedule = &self.symbolic.schedule;
        if self.num_sides == 0 {
            return;
        }
        let ranges = self.symbolic.packed_ranges();
        let packed = |index: usize| &self.values[ranges[index].clone()];
        // Unknowns of each task, kept from the forward to the backward substitution: see `load`.
        let unknowns: Vec<Mutex<Vec<f64>>> = schedule.tasks().iter().map(|_| Mutex::default()).collect();
        let shared: &[f64] = rhs;
        schedule.bottom_up(threading, |index, task, children: Vec<Vec<f64>>| {
            let mut local = self.load(task, shared);
            self.add_children(task, &children, &mut local);
            self.forward(task, packed(index), &mut local);
            let (columns, height) = self.heights(task);
            let below = local.chunks_exact(height).flat_map(|side| &side[columns..]).copied().collect();
            *lock(&unknowns[index]) = local;
            below
        });
        schedule.top_down(threading, |index, task, below: Option<Vec<f64>>| {
            let mut local = lock(&unknowns[index]);
            if let Some(below) = below {
                let (columns, height) = self.heights(task);
                for (side, below) in local.chunks_exact_mut(height).zip(below.chunks_exact(height - columns)) {
                    side[columns..].copy_from_slice(below);
                }
            }
            self.backward(task, packed(index), &mut local);
            task.children.iter().map(|&child| self.rows_of_child(task, child, &local)).collect()
        });
        for (task, local) in schedule.tasks().iter().zip(&unknowns) {
            self.store(task, &lock(local), rhs);
        }
    }

    /// Numbers of unknowns of a task: in its columns, and with the rows of its root.
    fn heights(&self, task: &Task) -> (usize, usize) {
        let structure = &self.symbolic.structure;
        let columns = task.columns.len() * structure.block;
        (columns, columns + structure.rows(task.root()).len() * structure.block)
    }

    /// The unknowns of a task: those of its columns, then those of the rows of its root, zero, for each right-hand side.
    fn load(&self, task: &Task, rhs: &[f64]) -> Vec<f64> {
        let structure = &self.symbolic.structure;
        let (_, height) = self.heights(task);
        let mut local = vec![0.0; height * self.num_sides];
        for (own, rhs) in local.chunks_exact_mut(height).zip(rhs.chunks_exact(structure.num_dofs())) {
            for (own, node) in own.chunks_exact_mut(structure.block).zip(task.columns.clone()) {
                own.copy_from_slice(&rhs[structure.dofs(node)]);
            }
        }
        local
    }

    /// Copies the unknowns of the columns of a task back.
    fn store(&self, task: &Task, local: &[f64], rhs: &mut [f64]) {
        let structure = &self.symbolic.structure;
        let (_, height) = self.heights(task);
        for (own, rhs) in local.chunks_exact(height).zip(rhs.chunks_exact_mut(structure.num_dofs())) {
            for (own, node) in own.chunks_exact(structure.block).zip(task.columns.clone()) {
                rhs[structure.dofs(node)].copy_from_slice(own);
            }
        }
    }

    /// Adds the contributions of the child tasks.
    fn add_children(&self, task: &Task, children: &[Vec<f64>], local: &mut [f64]) {
        let (_, height) = self.heights(task);
        for (&child, below) in task.children.iter().zip(children) {
            let ranges = self.relative_ranges(task, child);
            let below = below.chunks_exact(below.len() / self.num_sides);
            for (own, below) in local.chunks_exact_mut(height).zip(below) {
                for range in &ranges {
                    let own = &mut own[range.target..range.target + range.len];
                    own.iter_mut().zip(&below[range.source..]).for_each(|(own, below)| *own += below);
                }
            }
        }
    }

    /// The unknowns of a task at the rows of a child's root.
    fn rows_of_child(&self, task: &Task, child: usize, local: &[f64]) -> Vec<f64> {
        let ranges = self.relative_ranges(task, child);
        let (_, height) = self.heights(task);
        let sides = local.chunks_exact(height);
        let rows = sides.flat_map(|side| ranges.iter().flat_map(|range| &side[range.target..range.target + range.len]));
        rows.copied().collect()
    }

    /// Positions of the rows of a child's root among the unknowns of a task.
    fn relative_ranges(&self, task: &Task, child: usize) -> Vec<RelativeRange> {
        let SymbolicFactor { structure, schedule } = self.symbolic;
        let rows = |task: &Task| structure.rows(task.root());
        let mut ranges = Vec::new();
        find_relative_ranges(rows(schedule.task(child)), &task.columns, rows(task), &mut ranges);
        ranges.into_iter().map(|range| range.expanded(structure.block)).collect()
    }

    /// Solves `L y = b` in the columns of a task and subtracts the products from its rows below.
    fn forward(&self, task: &Task, packed: &[T], local: &mut [f64]) {
        let mut buffer = Vec::new();
        for supernode in self.supernodes(task, packed) {
            supernode.gather_columns(local, self.num_sides, &mut buffer);
            supernode.forward(&mut buffer, self.num_sides);
            supernode.scatter_columns(&buffer, self.num_sides, local);
            supernode.add_rows_below(&buffer, self.num_sides, local);
        }
    }

    /// Solves `L^T x = y` in the columns of a task, given `x` in its rows below.
    fn backward(&self, task: &Task, packed: &[T], local: &mut [f64]) {
        let mut buffer = Vec::new();
        for supernode in self.supernodes(task, packed).into_iter().rev() {
            supernode.gather_columns(local, self.num_sides, &mut buffer);
            supernode.gather_rows_below(local, self.num_sides, &mut buffer);
            supernode.backward(&mut buffer, self.num_sides);
            supernode.scatter_columns(&buffer, self.num_sides, local);
        }
    }

    /// The supernodes of a task, in order.
    fn supernodes<'b>(&'b self, task: &Task, packed: &'b [T]) -> Vec<Supernode<'b, T>> {
        let SymbolicFactor { structure, schedule } = self.symbolic;
        let (mut rest, mut first_column) = (packed, 0);
        let split_next = |index| {
            let shape = structure.shape(index);
            let (values, others) = rest.split_at(shape.packed_len());
            let packed = PackedColumns { values, shape };
            let local_rows = schedule.local_rows(index);
            let supernode = Supernode { packed, block: structure.block, first_column, local_rows };
            (rest, first_column) = (others, first_column + shape.columns);
            supernode
        };
        task.supernodes.clone().map(split_next).collect()
    }
}
