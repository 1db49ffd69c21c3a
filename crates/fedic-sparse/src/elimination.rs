//! The elimination of the supernodes of a task, one after the other.

use faer::linalg::cholesky::llt::factor::LltError;

use crate::elimination_tree::NONE;
use crate::front::Front;
use crate::panel::{Stored, num_stored, store};
use crate::runs::{Run, find_runs};
use crate::symbolic::Symbolic;
use crate::tree::Task;

/// What the elimination of a supernode leaves for its rows: a square, by columns.
#[derive(Default)]
pub(crate) struct Update {
    supernode: usize,
    values: Vec<f64>,
}

/// What the work on a task needs.
pub(crate) struct Elimination<'a> {
    symbolic: &'a Symbolic,
    /// To which small pivots are raised.
    floor: Option<f64>,
    /// What waits for the parents of the supernodes done, those of one parent together.
    waiting: Vec<Update>,
    /// Memory to be used again.
    spare: Vec<Vec<f64>>,
    runs: Vec<Run>,
}

impl<'a> Elimination<'a> {
    pub(crate) fn new(symbolic: &'a Symbolic, floor: Option<f64>, below: Vec<Update>) -> Self {
        Self { symbolic, floor, waiting: below, spare: Vec::new(), runs: Vec::new() }
    }

    /// Eliminates the supernodes of a task, writes their columns one after the other and returns the pivots.
    pub(crate) fn run<T: Stored>(
        &mut self,
        task: &Task,
        matrix: &[f64],
        mut factor: &mut [T],
    ) -> Result<Vec<f64>, LltError> {
        let mut pivots = Vec::with_capacity(task.columns.len() * self.symbolic.block);
        let mut panel = Vec::new();
        for supernode in task.supernodes.clone() {
            let [rows, columns] = self.symbolic.shape(supernode);
            panel.clear();
            panel.resize(rows * columns, 0.0);
            let mut update = self.spare.pop().unwrap_or_default();
            update.clear();
            update.resize((rows - columns).pow(2), 0.0);
            let mut front = Front { panel: &mut panel, update: &mut update, rows, columns };
            front.scatter(self.symbolic, supernode, matrix);
            let is_child = |update: &Update| self.symbolic.parent[update.supernode] as usize == supernode;
            let first = self.waiting.iter().rposition(|update| !is_child(update)).map_or(0, |last| last + 1);
            for child in self.waiting.drain(first..) {
                let own = self.symbolic.rows(child.supernode);
                find_runs(own, &self.symbolic.columns(supernode), self.symbolic.rows(supernode), &mut self.runs);
                self.runs.iter_mut().for_each(|run| *run = run.expanded(self.symbolic.block));
                front.add(&child.values, &self.runs);
                self.spare.push(child.values);
            }
            front.eliminate(self.floor)?;
            pivots.extend((0..columns).map(|j| panel[j * rows + j].powi(2)));
            let own;
            (own, factor) = factor.split_at_mut(num_stored([rows, columns]));
            store(&panel, rows, own);
            if self.symbolic.parent[supernode] != NONE {
                self.waiting.push(Update { supernode, values: update });
            }
        }
        Ok(pivots)
    }

    /// What the last supernode left.
    pub(crate) fn left(mut self) -> Update {
        self.waiting.pop().unwrap_or_default()
    }
}
