//! The work on the supernodes, cut into tasks: subtrees of the elimination tree, and single supernodes above them.
//!
//! The cut depends on the matrix alone, and what several tasks hand to the next is taken in a fixed order: results do not depend
//! on the number of threads.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::Scope;

use crate::elimination_tree::NONE;
use crate::runs::find_runs;
use crate::symbolic::Symbolic;

/// A subtree is cut further where it takes more than this part of the whole work ...
const PART: f64 = 1.0 / 64.0;
/// ... and more than so many multiplications.
const SMALLEST: f64 = 2e6;

/// Who runs the tasks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Threads {
    /// The calling thread, which takes on nothing else.
    One,
    /// All of the pool.
    All,
}

/// Tasks in an order in which each follows its children.
#[derive(Debug)]
pub(crate) struct Tasks {
    tasks: Vec<Task>,
    row_starts: Vec<usize>,
    local_rows: Vec<u32>,
}

/// Supernodes one after the other, the last of which all others lie below.
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) supernodes: Range<usize>,
    /// Nodes that are the columns of these.
    pub(crate) columns: Range<u32>,
    /// The tasks right below, in the order of their supernodes.
    pub(crate) children: Vec<usize>,
    parent: Option<usize>,
}

impl Task {
    /// The supernode at the top, whose rows all others' rows outside of the task are among.
    pub(crate) fn root(&self) -> usize {
        self.supernodes.end - 1
    }
}

impl Tasks {
    pub(crate) fn new(symbolic: &Symbolic) -> Self {
        let count = symbolic.num_supernodes();
        let mut work: Vec<f64> = (0..count).map(|supernode| symbolic.work(supernode)).collect();
        let mut first: Vec<usize> = (0..count).collect();
        for supernode in 0..count {
            let parent = symbolic.parent[supernode];
            if parent != NONE {
                work[parent as usize] += work[supernode];
                first[parent as usize] = first[parent as usize].min(first[supernode]);
            }
        }
        let total: f64 = (0..count).filter(|&s| symbolic.parent[s] == NONE).map(|s| work[s]).sum();
        let most = (PART * total).max(SMALLEST);
        let whole = |supernode: usize| work[supernode] <= most;
        let mut tasks: Vec<Task> = Vec::new();
        let mut task_of = vec![0; count];
        for root in 0..count {
            let parent = symbolic.parent[root];
            if whole(root) && parent != NONE && whole(parent as usize) {
                continue;
            }
            let supernodes = if whole(root) { first[root]..root + 1 } else { root..root + 1 };
            task_of[root] = tasks.len();
            let columns = symbolic.columns(supernodes.start).start..symbolic.columns(root).end;
            tasks.push(Task { supernodes, columns, children: Vec::new(), parent: None });
        }
        for task in 0..tasks.len() {
            let parent = symbolic.parent[tasks[task].root()];
            if parent != NONE {
                let parent = task_of[parent as usize];
                tasks[task].parent = Some(parent);
                tasks[parent].children.push(task);
            }
        }
        let mut row_starts = vec![0];
        let mut local_rows = Vec::new();
        let mut runs = Vec::new();
        for task in &tasks {
            for supernode in task.supernodes.clone() {
                find_runs(symbolic.rows(supernode), &task.columns, symbolic.rows(task.root()), &mut runs);
                local_rows.extend(runs.iter().flat_map(|run| (run.to as u32..).take(run.len)));
                row_starts.push(local_rows.len());
            }
        }
        Self { tasks, row_starts, local_rows }
    }

    /// Places of the rows of a supernode among the columns of its task and the rows of the task's root, one after the other.
    pub(crate) fn local_rows(&self, supernode: usize) -> &[u32] {
        &self.local_rows[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    pub(crate) fn get(&self, task: usize) -> &Task {
        &self.tasks[task]
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Task> {
        self.tasks.iter()
    }

    /// Runs every task after its children, with what these return, in their order.
    pub(crate) fn upwards<T: Send>(&self, threads: Threads, run: impl Fn(usize, &Task, Vec<T>) -> T + Sync) {
        let waiting: Vec<AtomicUsize> = self.tasks.iter().map(|task| AtomicUsize::new(task.children.len())).collect();
        let results: Vec<Mutex<Option<T>>> = self.tasks.iter().map(|_| Mutex::new(None)).collect();
        let climb = |mut index: usize| {
            loop {
                let task = &self.tasks[index];
                let below = task.children.iter().filter_map(|&child| lock(&results[child]).take()).collect();
                let result = run(index, task, below);
                let Some(parent) = task.parent else { return };
                *lock(&results[index]) = Some(result);
                if waiting[parent].fetch_sub(1, Ordering::AcqRel) > 1 {
                    return;
                }
                index = parent;
            }
        };
        let leaves: Vec<usize> = (0..self.tasks.len()).filter(|&task| self.tasks[task].children.is_empty()).collect();
        if threads == Threads::One || leaves.len() == 1 {
            return leaves.into_iter().for_each(climb);
        }
        let climb = &climb;
        // A thread takes first what was added last: the leaves in their order, so that few results wait.
        rayon::scope(|scope| leaves.into_iter().rev().for_each(|leaf| scope.spawn(move |_| climb(leaf))));
    }

    /// Runs every task after its parent, with what this returns for it.
    pub(crate) fn downwards<T: Send>(&self, threads: Threads, run: impl Fn(usize, &Task, Option<T>) -> Vec<T> + Sync) {
        let roots = (0..self.tasks.len()).filter(|&task| self.tasks[task].parent.is_none());
        if threads == Threads::One {
            let mut waiting: Vec<(usize, Option<T>)> = roots.map(|root| (root, None)).collect();
            while let Some((index, given)) = waiting.pop() {
                let task = &self.tasks[index];
                let handed_on = run(index, task, given).into_iter().map(Some);
                waiting.extend(task.children.iter().copied().zip(handed_on));
            }
            return;
        }
        rayon::scope(|scope| roots.for_each(|root| self.descend(scope, root, None, &run)));
    }

    /// Runs a task and hands its children on.
    fn descend<'scope, T: Send + 'scope>(
        &'scope self,
        scope: &Scope<'scope>,
        index: usize,
        given: Option<T>,
        run: &'scope (impl Fn(usize, &Task, Option<T>) -> Vec<T> + Sync),
    ) {
        let mut next = Some((index, given));
        while let Some((index, given)) = next.take() {
            let task = &self.tasks[index];
            for (&child, given) in task.children.iter().zip(run(index, task, given)) {
                if let Some((waiting, given)) = next.replace((child, Some(given))) {
                    scope.spawn(move |scope| self.descend(scope, waiting, given, run));
                }
            }
        }
    }
}

/// No task panics with a lock held; if one did, the panic would be passed on anyway.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
