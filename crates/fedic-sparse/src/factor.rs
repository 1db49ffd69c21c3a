//! The factor of one matrix, and the solution of systems with it.

use std::sync::{Arc, Mutex};

use fedic_memory::AlignedBuffer;

use crate::cholesky::Plan;
use crate::panel::{Panel, Stored, num_stored};
use crate::runs::{Run, find_runs};
use crate::tree::{Task, Threads, lock};

/// The numeric part: the factor of one matrix.
#[derive(Debug, Clone)]
pub struct Factor {
    plan: Arc<Plan>,
    values: Values,
}

/// The supernodes, one after the other.
#[derive(Debug, Clone)]
pub(crate) enum Values {
    Double(AlignedBuffer<f64>),
    Single(AlignedBuffer<f32>),
}

impl Factor {
    pub(crate) fn new(plan: Arc<Plan>, values: Values) -> Self {
        Self { plan, values }
    }

    /// How many numbers it holds: its size in memory, and what orders of the unknowns are judged by.
    pub fn num_entries(&self) -> usize {
        match &self.values {
            Values::Double(values) => values.len(),
            Values::Single(values) => values.len(),
        }
    }

    /// Whether its numbers are kept in single precision, as [`factorize_compact`](crate::Cholesky::factorize_compact) does where the
    /// matrix allows it.
    pub fn is_compact(&self) -> bool {
        matches!(self.values, Values::Single(_))
    }

    /// Solves `A x = b` for one right-hand side or several, one after the other; `rhs` holds them and becomes the solutions.
    ///
    /// # Panics
    ///
    /// If `rhs` does not have one entry per unknown and right-hand side.
    pub fn solve(&self, rhs: &mut [f64]) {
        self.solve_by(Threads::All, rhs);
    }

    /// The same to the last bit on the calling thread alone, which waits for no other: for systems that are solved side by side,
    /// where a thread that waits would begin the next one.
    ///
    /// # Panics
    ///
    /// If `rhs` does not have one entry per unknown and right-hand side.
    pub fn solve_sequentially(&self, rhs: &mut [f64]) {
        self.solve_by(Threads::One, rhs);
    }

    fn solve_by(&self, threads: Threads, rhs: &mut [f64]) {
        match &self.values {
            Values::Double(values) => self.solve_with(values, threads, rhs),
            Values::Single(values) => self.solve_with(values, threads, rhs),
        }
    }

    fn solve_with<T: Stored>(&self, values: &[T], threads: Threads, rhs: &mut [f64]) {
        let (symbolic, tasks) = (&self.plan.symbolic, &self.plan.tasks);
        let d = symbolic.block;
        let dofs = symbolic.order.len() * d;
        let sides = rhs.len() / dofs;
        assert_eq!(rhs.len(), dofs * sides, "right-hand sides of another size");
        if sides == 0 {
            return;
        }
        let mut parts = vec![0];
        parts.extend(tasks.iter().scan(0, |end, task| {
            *end += symbolic.num_stored(&task.supernodes);
            Some(*end)
        }));
        // For each task the unknowns of its columns, then those of the rows of its root, and this for each right-hand side.
        let unknowns: Vec<Mutex<Vec<f64>>> = tasks.iter().map(|_| Mutex::default()).collect();
        let shared: &[f64] = rhs;
        tasks.upwards(threads, |index, task, below: Vec<Vec<f64>>| {
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
            self.forward(task, &values[parts[index]..parts[index + 1]], &mut all, sides);
            let rest = all.chunks_exact(height).flat_map(|own| &own[columns..]).copied().collect();
            *lock(&unknowns[index]) = all;
            rest
        });
        tasks.downwards(threads, |index, task, given: Option<Vec<f64>>| {
            let columns = task.columns.len() * d;
            let height = columns + symbolic.rows(task.root()).len() * d;
            let mut all = lock(&unknowns[index]);
            if let Some(given) = given {
                for (own, given) in all.chunks_exact_mut(height).zip(given.chunks_exact(height - columns)) {
                    own[columns..].copy_from_slice(given);
                }
            }
            self.backward(task, &values[parts[index]..parts[index + 1]], &mut all, sides);
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
    fn supernodes<'a, T>(&'a self, task: &Task, values: &'a [T]) -> Vec<Panel<'a, T>> {
        let (mut rest, mut first) = (values, 0);
        let take = |supernode| {
            let [rows, columns] = self.plan.symbolic.shape(supernode);
            let (values, others) = rest.split_at(num_stored([rows, columns]));
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
    fn forward<T: Stored>(&self, task: &Task, values: &[T], all: &mut [f64], sides: usize) {
        let d = self.plan.symbolic.block;
        let mut work = Vec::new();
        for panel in self.supernodes(task, values) {
            panel.gather(all, sides, d, &mut work, false);
            panel.eliminate(&mut work, sides);
            panel.put_back(all, sides, &work);
            panel.scatter(all, sides, d, &work);
        }
    }

    /// `L^T x = y` in the columns of a task; its rows below hold `x`.
    fn backward<T: Stored>(&self, task: &Task, values: &[T], all: &mut [f64], sides: usize) {
        let d = self.plan.symbolic.block;
        let mut work = Vec::new();
        for panel in self.supernodes(task, values).into_iter().rev() {
            panel.gather(all, sides, d, &mut work, true);
            panel.substitute(&mut work, sides);
            panel.put_back(all, sides, &work);
        }
    }
}
