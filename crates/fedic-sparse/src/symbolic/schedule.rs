//! Task schedule over the elimination tree: subtrees, and single supernodes above them.
//!
//! The partition depends on the structure alone, and the results of the children of a task are combined in a fixed
//! order, so results do not depend on the number of threads.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::Scope;

use super::elimination_tree::NONE;
use super::relative_indices::find_relative_ranges;
use super::structure::Structure;

/// A subtree with more than this fraction of the total work is divided further ...
const MAX_TASK_SHARE: f64 = 1.0 / 64.0;
/// ... provided it has more multiply-add operations than this.
const MIN_TASK_WORK: f64 = 2e6;

/// Threads that run the tasks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Threading {
    /// The calling thread alone.
    Sequential,
    /// All threads of the current pool.
    Parallel,
}

/// Tasks in postorder.
#[derive(Debug)]
pub(crate) struct Schedule {
    tasks: Vec<Task>,
    row_starts: Vec<usize>,
    local_rows: Vec<u32>,
}

/// Consecutive supernodes, the last of which is the ancestor of all others.
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) supernodes: Range<usize>,
    /// Columns of the supernodes, in nodes.
    pub(crate) columns: Range<u32>,
    /// Child tasks, in the order of their supernodes.
    pub(crate) children: Vec<usize>,
    parent: Option<usize>,
}

impl Task {
    /// The last supernode. Rows of the task outside its columns are rows of the root.
    pub(crate) fn root(&self) -> usize {
        self.supernodes.end - 1
    }
}

impl Schedule {
    /// Partitions the elimination tree.
    pub(crate) fn new(structure: &Structure) -> Self {
        let tasks = partition(structure);
        let mut row_starts = vec![0];
        let mut local_rows = Vec::new();
        let mut ranges = Vec::new();
        for task in &tasks {
            for supernode in task.supernodes.clone() {
                find_relative_ranges(
                    structure.rows(supernode),
                    &task.columns,
                    structure.rows(task.root()),
                    &mut ranges,
                );
                local_rows.extend(ranges.iter().flat_map(|range| (range.target as u32..).take(range.len)));
                row_starts.push(local_rows.len());
            }
        }
        Self { tasks, row_starts, local_rows }
    }

    /// Positions of the rows of a supernode among the columns of its task followed by the rows of the task's root.
    pub(crate) fn local_rows(&self, supernode: usize) -> &[u32] {
        &self.local_rows[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    /// The task of this index.
    pub(crate) fn task(&self, index: usize) -> &Task {
        &self.tasks[index]
    }

    /// All tasks, children before their parents.
    pub(crate) fn tasks(&self) -> &[Task] {
        &self.tasks
    }

    /// Runs every task after its children and passes it their results, in order.
    pub(crate) fn bottom_up<T: Send>(&self, threading: Threading, run: impl Fn(usize, &Task, Vec<T>) -> T + Sync) {
        let pending: Vec<AtomicUsize> = self.tasks.iter().map(|task| AtomicUsize::new(task.children.len())).collect();
        let results: Vec<Mutex<Option<T>>> = self.tasks.iter().map(|_| Mutex::new(None)).collect();
        let climb = |mut index: usize| {
            loop {
                let task = &self.tasks[index];
                let children = task.children.iter().filter_map(|&child| lock(&results[child]).take()).collect();
                let result = run(index, task, children);
                let Some(parent) = task.parent else { return };
                *lock(&results[index]) = Some(result);
                if pending[parent].fetch_sub(1, Ordering::AcqRel) > 1 {
                    return;
                }
                index = parent;
            }
        };
        let leaves: Vec<usize> = (0..self.tasks.len()).filter(|&task| self.tasks[task].children.is_empty()).collect();
        if threading == Threading::Sequential || leaves.len() == 1 {
            return leaves.into_iter().for_each(climb);
        }
        let climb = &climb;
        // A thread runs its most recently spawned job first: in this order few results are pending at a time.
        rayon::scope(|scope| leaves.into_iter().rev().for_each(|leaf| scope.spawn(move |_| climb(leaf))));
    }

    /// Runs every task after its parent and passes it the parent's value for it; `run` returns one value per child.
    pub(crate) fn top_down<T: Send>(
        &self,
        threading: Threading,
        run: impl Fn(usize, &Task, Option<T>) -> Vec<T> + Sync,
    ) {
        let roots = (0..self.tasks.len()).filter(|&task| self.tasks[task].parent.is_none());
        if threading == Threading::Sequential {
            let mut pending: Vec<(usize, Option<T>)> = roots.map(|root| (root, None)).collect();
            while let Some((index, value)) = pending.pop() {
                let task = &self.tasks[index];
                let values = run(index, task, value).into_iter().map(Some);
                pending.extend(task.children.iter().copied().zip(values));
            }
            return;
        }
        rayon::scope(|scope| roots.for_each(|root| self.descend(scope, root, None, &run)));
    }

    /// Runs a task and its descendants: one child on this thread, the others as new jobs.
    fn descend<'scope, T: Send + 'scope>(
        &'scope self,
        scope: &Scope<'scope>,
        index: usize,
        value: Option<T>,
        run: &'scope (impl Fn(usize, &Task, Option<T>) -> Vec<T> + Sync),
    ) {
        let mut next = Some((index, value));
        while let Some((index, value)) = next.take() {
            let task = &self.tasks[index];
            for (&child, value) in task.children.iter().zip(run(index, task, value)) {
                if let Some((other, value)) = next.replace((child, Some(value))) {
                    scope.spawn(move |scope| self.descend(scope, other, value, run));
                }
            }
        }
    }
}

/// Divides the elimination tree into tasks of bounded work.
fn partition(structure: &Structure) -> Vec<Task> {
    let count = structure.num_supernodes();
    // Work of the subtree of each supernode, and its first supernode.
    let mut work: Vec<f64> = (0..count).map(|supernode| structure.shape(supernode).work()).collect();
    let mut first: Vec<usize> = (0..count).collect();
    for supernode in 0..count {
        let parent = structure.parent[supernode];
        if parent != NONE {
            work[parent as usize] += work[supernode];
            first[parent as usize] = first[parent as usize].min(first[supernode]);
        }
    }
    let total: f64 = (0..count).filter(|&s| structure.parent[s] == NONE).map(|s| work[s]).sum();
    let most = (MAX_TASK_SHARE * total).max(MIN_TASK_WORK);
    let is_small = |supernode: usize| work[supernode] <= most;
    let mut tasks: Vec<Task> = Vec::new();
    let mut task_of = vec![0; count];
    for root in 0..count {
        let parent = structure.parent[root];
        if is_small(root) && parent != NONE && is_small(parent as usize) {
            continue;
        }
        let supernodes = if is_small(root) { first[root]..root + 1 } else { root..root + 1 };
        task_of[root] = tasks.len();
        let columns = structure.columns(supernodes.start).start..structure.columns(root).end;
        tasks.push(Task { supernodes, columns, children: Vec::new(), parent: None });
    }
    for task in 0..tasks.len() {
        let parent = structure.parent[tasks[task].root()];
        if parent != NONE {
            let parent = task_of[parent as usize];
            tasks[task].parent = Some(parent);
            tasks[parent].children.push(task);
        }
    }
    tasks
}

/// Locks a mutex; a poisoned one is used as it is because the panic that poisoned it propagates anyway.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
