//! Inversion of all supernodes by the tasks of the schedule.

use std::sync::Mutex;

use fedic_memory::is_available;

use crate::numeric::{PackedColumns, StoredFloat};
use crate::symbolic::{Shape, Structure, SymbolicFactor, Task, Threading, find_relative_ranges, lock};
use crate::{SparseError, SymmetricMatrix};

use super::front::InverseFront;

/// The entries of the inverse on the pattern of the matrix, given its factor.
///
/// # Errors
///
/// [`SparseError::TooLarge`] if the work does not fit in memory.
pub(crate) fn selected_inverse<T: StoredFloat>(
    symbolic: &SymbolicFactor,
    factor: &[T],
) -> Result<SymmetricMatrix, SparseError> {
    let SymbolicFactor { structure, schedule } = symbolic;
    let children = structure.children();
    // Each thread inverts one subtree at a time, and the entries are found by tasks before they are put in the order of the matrix.
    let fronts = rayon::current_num_threads().saturating_mul(most_values(structure, &children));
    let total = structure.num_entries();
    if !is_available(fronts.saturating_add(2 * total).saturating_mul(size_of::<f64>())) {
        return Err(SparseError::TooLarge { dofs: structure.num_dofs() });
    }
    let ranges = symbolic.packed_ranges();
    let found: Vec<Mutex<Vec<f64>>> = ranges.iter().map(|_| Mutex::default()).collect();
    schedule.top_down(Threading::Parallel, |index, task, below: Option<Vec<f64>>| {
        let mut inversion =
            Inversion { structure, children: &children, pending: Vec::from_iter(below), found: Vec::new() };
        inversion.run(task, &factor[ranges[index].clone()]);
        *lock(&found[index]) = inversion.found;
        inversion.pending
    });
    let mut values = vec![0.0; total];
    for (task, found) in schedule.tasks().iter().zip(&found) {
        let found = std::mem::take(&mut *lock(found));
        let mut found = found.into_iter();
        for supernode in task.supernodes.clone().rev() {
            structure.for_each_entry(supernode, |_, source| {
                if let Some(value) = found.next() {
                    values[source] = value;
                }
            });
        }
    }
    Ok(SymmetricMatrix::from_values(values))
}

/// Largest number of values held at a time by one thread that inverts all supernodes.
fn most_values(structure: &Structure, children: &[Vec<usize>]) -> usize {
    let square = |supernode: &usize| structure.shape(*supernode).rows_below().pow(2);
    let (mut held, mut most) = (0, 0);
    for supernode in (0..structure.num_supernodes()).rev() {
        let Shape { rows, columns } = structure.shape(supernode);
        held += children[supernode].iter().map(square).sum::<usize>();
        // The columns of the factor and those of the inverse.
        most = most.max(held + 2 * rows * columns);
        held -= square(&supernode);
    }
    most
}

/// State of the inversion within one task.
struct Inversion<'a> {
    structure: &'a Structure,
    /// Children of each supernode.
    children: &'a [Vec<usize>],
    /// The inverse at the rows below supernodes not yet treated, the next of which is last.
    pending: Vec<Vec<f64>>,
    /// Entries found, by supernodes in the order of their treatment.
    found: Vec<f64>,
}

impl Inversion<'_> {
    /// Finds the entries of a task, given those of its root's rows below. Those of the rows below its child tasks remain pending.
    fn run<T: StoredFloat>(&mut self, task: &Task, mut packed: &[T]) {
        let structure = self.structure;
        let (mut columns, mut ranges, mut spare) = (Vec::new(), Vec::new(), Vec::<Vec<f64>>::new());
        for supernode in task.supernodes.clone().rev() {
            let shape = structure.shape(supernode);
            let values;
            (packed, values) = packed.split_at(packed.len() - shape.packed_len());
            let mut factor = PackedColumns { values, shape }.to_dense();
            // A root has no rows below.
            let mut below = if shape.rows_below() > 0 { self.pending.pop().unwrap_or_default() } else { Vec::new() };
            columns.resize(shape.rows * shape.columns, 0.0);
            let mut front = InverseFront { columns: &mut columns, below: &mut below, shape };
            front.fill_columns(factor.as_mut());
            structure.for_each_entry(supernode, |position, _| self.found.push(front.columns[position]));
            for &child in &self.children[supernode] {
                let rows = structure.rows(child);
                find_relative_ranges(rows, &structure.columns(supernode), structure.rows(supernode), &mut ranges);
                ranges.iter_mut().for_each(|range| *range = range.expanded(structure.block));
                let mut square = spare.pop().unwrap_or_default();
                square.resize(structure.shape(child).rows_below().pow(2), 0.0);
                front.extract(&ranges, &mut square);
                self.pending.push(square);
            }
            spare.push(below);
        }
    }
}
