//! The factor of one matrix, and the solution of systems with it.

use std::sync::{Arc, Mutex};

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use crate::cholesky::Plan;
use crate::runs::{Run, find_runs};
use crate::tree::{Task, lock};

/// The numeric part: the factor of one matrix.
#[derive(Debug, Clone)]
pub struct Factor {
    pub(crate) plan: Arc<Plan>,
    /// Columns of the supernodes of each task, one supernode after the other, each with its rows; what lies above the diagonal
    /// means nothing.
    pub(crate) panels: Vec<Vec<f64>>,
}

/// A supernode of the factor.
struct Panel<'a> {
    values: &'a [f64],
    rows: usize,
    columns: usize,
    /// First of its columns among those of the task.
    first: usize,
    local_rows: &'a [u32],
}

impl Factor {
    /// Numbers stored.
    pub fn num_entries(&self) -> usize {
        self.panels.iter().map(Vec::len).sum()
    }

    /// Unknown and pivot of every column of the factor.
    pub(crate) fn pivots(&self) -> impl Iterator<Item = (usize, f64)> {
        let symbolic = &self.plan.symbolic;
        let d = symbolic.block;
        self.plan.tasks.iter().zip(&self.panels).flat_map(move |(task, values)| {
            self.supernodes(task, values).into_iter().flat_map(move |panel| {
                (0..panel.columns).map(move |j| {
                    let node = symbolic.order[task.columns.start as usize + (panel.first + j) / d] as usize;
                    (node * d + j % d, panel.values[j * panel.rows + j].powi(2))
                })
            })
        })
    }

    /// Solves `A x = b` for one right-hand side or several, one after the other; `rhs` holds them and becomes the solutions.
    ///
    /// # Panics
    ///
    /// If `rhs` does not have one entry per unknown and right-hand side.
    pub fn solve(&self, rhs: &mut [f64]) {
        let (symbolic, tasks) = (&self.plan.symbolic, &self.plan.tasks);
        let d = symbolic.block;
        let dofs = symbolic.order.len() * d;
        let sides = rhs.len() / dofs;
        assert_eq!(rhs.len(), dofs * sides, "right-hand sides of another size");
        // For each task the unknowns of its columns, then those of the rows of its root, and this for each right-hand side.
        let unknowns: Vec<Mutex<Vec<f64>>> = tasks.iter().map(|_| Mutex::default()).collect();
        let shared: &[f64] = rhs;
        tasks.upwards(|index, task, below: Vec<Vec<f64>>| {
            let columns = task.columns.len() * d;
            let height = columns + symbolic.rows(task.root()).len() * d;
            let mut all = vec![0.0; height * sides];
            for (side, own) in all.chunks_exact_mut(height).enumerate() {
                for (own, node) in own.chunks_exact_mut(d).zip(task.columns.clone()) {
                    let dof = side * dofs + symbolic.order[node as usize] as usize * d;
                    own.copy_from_slice(&shared[dof..dof + d]);
                }
            }
            for (&child, given) in task.children.iter().zip(&below) {
                let given = given.chunks_exact(given.len() / sides);
                for (own, given) in all.chunks_exact_mut(height).zip(given) {
                    for run in self.shared_rows(task, child) {
                        let pairs = own[run.to..run.to + run.len].iter_mut().zip(&given[run.from..]);
                        pairs.for_each(|(own, given)| *own += given);
                    }
                }
            }
            self.forward(task, &self.panels[index], &mut all, sides);
            let rest = all.chunks_exact(height).flat_map(|own| &own[columns..]).copied().collect();
            *lock(&unknowns[index]) = all;
            rest
        });
        tasks.downwards(|index, task, given: Option<Vec<f64>>| {
            let columns = task.columns.len() * d;
            let height = columns + symbolic.rows(task.root()).len() * d;
            let mut all = lock(&unknowns[index]);
            if let Some(given) = given {
                for (own, given) in all.chunks_exact_mut(height).zip(given.chunks_exact(height - columns)) {
                    own[columns..].copy_from_slice(given);
                }
            }
            self.backward(task, &self.panels[index], &mut all, sides);
            let hand_on = |&child: &usize| {
                let runs = self.shared_rows(task, child);
                let mut given = Vec::new();
                for own in all.chunks_exact(height) {
                    runs.iter().for_each(|run| given.extend_from_slice(&own[run.to..run.to + run.len]));
                }
                given
            };
            task.children.iter().map(hand_on).collect()
        });
        for (task, all) in tasks.iter().zip(&unknowns) {
            let all = lock(all);
            for (side, own) in all.chunks_exact(all.len() / sides).enumerate() {
                for (own, node) in own.chunks_exact(d).zip(task.columns.clone()) {
                    let dof = side * dofs + symbolic.order[node as usize] as usize * d;
                    rhs[dof..dof + d].copy_from_slice(own);
                }
            }
        }
    }
}

impl Factor {
    /// The supernodes of a task, in their order.
    fn supernodes<'a>(&'a self, task: &Task, values: &'a [f64]) -> Vec<Panel<'a>> {
        let (mut rest, mut first) = (values, 0);
        let take = |supernode| {
            let [rows, columns] = self.plan.symbolic.shape(supernode);
            let (values, others) = rest.split_at(rows * columns);
            let panel = Panel { values, rows, columns, first, local_rows: self.plan.tasks.local_rows(supernode) };
            (rest, first) = (others, first + columns);
            panel
        };
        task.supernodes.clone().map(take).collect()
    }

    /// The unknowns of the rows of a child's root, among those of a task.
    fn shared_rows(&self, task: &Task, child: usize) -> Vec<Run> {
        let symbolic = &self.plan.symbolic;
        let rows = |task: &Task| symbolic.rows(task.root());
        let mut runs = Vec::new();
        find_runs(rows(self.plan.tasks.get(child)), &task.columns, rows(task), &mut runs);
        runs.into_iter().map(|run| run.expanded(symbolic.block)).collect()
    }

    /// `L y = b` in the columns of a task; its rows below receive what is to be added there.
    fn forward(&self, task: &Task, values: &[f64], all: &mut [f64], sides: usize) {
        let d = self.plan.symbolic.block;
        let mut work = Vec::new();
        for panel in self.supernodes(task, values) {
            panel.gather(all, sides, d, &mut work, false);
            panel.eliminate(&mut work, sides);
            panel.scatter(all, sides, d, &work);
        }
    }

    /// `L^T x = y` in the columns of a task; its rows below hold `x`.
    fn backward(&self, task: &Task, values: &[f64], all: &mut [f64], sides: usize) {
        let d = self.plan.symbolic.block;
        let mut work = Vec::new();
        for panel in self.supernodes(task, values).into_iter().rev() {
            panel.gather(all, sides, d, &mut work, true);
            panel.substitute(&mut work, sides);
            let height = all.len() / sides;
            for (all, work) in all.chunks_exact_mut(height).zip(work.chunks_exact(panel.rows)) {
                all[panel.first..panel.first + panel.columns].copy_from_slice(&work[..panel.columns]);
            }
        }
    }
}

impl Panel<'_> {
    /// Takes the unknowns of the columns and, if asked, those of the rows below, that are zero otherwise.
    fn gather(&self, all: &[f64], sides: usize, block: usize, work: &mut Vec<f64>, with_rows: bool) {
        work.clear();
        for all in all.chunks_exact(all.len() / sides) {
            work.extend_from_slice(&all[self.first..self.first + self.columns]);
            if with_rows {
                self.local_rows.iter().for_each(|&row| work.extend_from_slice(&all[row as usize * block..][..block]));
            } else {
                work.resize(work.len() + self.rows - self.columns, 0.0);
            }
        }
    }

    /// Puts the unknowns of the columns back and adds those of the rows below.
    fn scatter(&self, all: &mut [f64], sides: usize, block: usize, work: &[f64]) {
        let height = all.len() / sides;
        for (all, work) in all.chunks_exact_mut(height).zip(work.chunks_exact(self.rows)) {
            let (columns, below) = work.split_at(self.columns);
            all[self.first..self.first + self.columns].copy_from_slice(columns);
            for (&row, given) in self.local_rows.iter().zip(below.chunks_exact(block)) {
                all[row as usize * block..][..block].iter_mut().zip(given).for_each(|(own, given)| *own += given);
            }
        }
    }

    /// Solves for the columns and subtracts what they add to the rows below.
    fn eliminate(&self, work: &mut [f64], sides: usize) {
        if sides == 1 {
            for (j, column) in self.values.chunks_exact(self.rows).enumerate() {
                let (x, below) = work[j..].split_at_mut(1);
                x[0] /= column[j];
                let x = x[0];
                below.iter_mut().zip(&column[j + 1..]).for_each(|(w, l)| *w -= l * x);
            }
            return;
        }
        let (square, lower) = self.parts();
        let (mut columns, below) =
            MatMut::from_column_major_slice_mut(work, self.rows, sides).split_at_row_mut(self.columns);
        solve_lower_triangular_in_place(square, columns.rb_mut(), Par::Seq);
        matmul(below, Accum::Add, lower, columns.rb(), -1.0, Par::Seq);
    }

    /// Solves for the columns, the rows below known.
    fn substitute(&self, work: &mut [f64], sides: usize) {
        if sides == 1 {
            for (j, column) in self.values.chunks_exact(self.rows).enumerate().rev() {
                let (x, below) = work[j..].split_at_mut(1);
                x[0] = (x[0] - dot(&column[j + 1..], below)) / column[j];
            }
            return;
        }
        let (square, lower) = self.parts();
        let (mut columns, below) =
            MatMut::from_column_major_slice_mut(work, self.rows, sides).split_at_row_mut(self.columns);
        matmul(columns.rb_mut(), Accum::Add, lower.transpose(), below.rb(), -1.0, Par::Seq);
        solve_upper_triangular_in_place(square.transpose(), columns, Par::Seq);
    }

    fn parts(&self) -> (MatRef<'_, f64>, MatRef<'_, f64>) {
        MatRef::from_column_major_slice(self.values, self.rows, self.columns).split_at_row(self.columns)
    }
}

/// Scalar product, in as many parts as a processor adds side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            lanes[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f64>() + rest
}
