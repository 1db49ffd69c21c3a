//! Sparse Cholesky factorisation: the symbolic part once per pattern, the numeric part per matrix.
//!
//! The numeric part is multifrontal (Duff and Reid 1983): a supernode is eliminated as a dense matrix, and what that leaves for
//! the rows below is handed up the elimination tree, whose branches are worked on in parallel.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use faer::linalg::cholesky::llt::factor::LltError;

use crate::dissection::nested_dissection;
use crate::factor::Factor;
use crate::front::Front;
use crate::graph::Graph;
use crate::minimum_degree::minimum_degree;
use crate::runs::{Run, find_runs};
use crate::symbolic::{NONE, Symbolic};
use crate::tree::{Task, Tasks, lock};
use crate::{Pattern, SparseError, SymmetricMatrix};

/// A pivot smaller than this fraction of its diagonal entry says that the unknown is not determined.
const VANISHING_PIVOT: f64 = 1e-11;
/// So does one smaller than this fraction of the largest diagonal entry: such small ones are made of rounding.
const NEGLIGIBLE_PIVOT: f64 = 1e-10;

/// The symbolic part of the factorisation: order of the unknowns and pattern of the factor, computed once per pattern.
#[derive(Debug, Clone)]
pub struct Cholesky {
    plan: Arc<Plan>,
}

/// Where the factor has entries, and who computes them.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) symbolic: Symbolic,
    pub(crate) tasks: Tasks,
}

impl Cholesky {
    /// Orders the nodes by approximate minimum degree and computes the pattern of the factor.
    ///
    /// # Errors
    ///
    /// [`SparseError::TooLarge`] where the factor cannot be numbered or stored.
    pub fn new(pattern: &Pattern) -> Result<Self, SparseError> {
        let order = minimum_degree(pattern).map_err(|_| SparseError::TooLarge { dofs: pattern.num_dofs() })?;
        Self::ordered(pattern, &Graph::new(pattern), &order)
    }

    /// The same with the nodes ordered by nested dissection; `points` are their coordinates.
    ///
    /// # Errors
    ///
    /// [`SparseError::TooLarge`] where the factor cannot be numbered or stored.
    ///
    /// # Panics
    ///
    /// If there is not one point per node.
    pub fn of_mesh(pattern: &Pattern, points: &[[f64; 3]]) -> Result<Self, SparseError> {
        assert_eq!(points.len(), pattern.num_nodes(), "one point per node");
        let graph = Graph::new(pattern);
        let order = nested_dissection(&graph, points);
        Self::ordered(pattern, &graph, &order)
    }

    fn ordered(pattern: &Pattern, graph: &Graph, order: &[u32]) -> Result<Self, SparseError> {
        if 2 * pattern.num_entries() > u32::MAX as usize {
            return Err(SparseError::TooLarge { dofs: pattern.num_dofs() });
        }
        let symbolic = Symbolic::new(pattern, graph, order);
        let tasks = Tasks::new(&symbolic);
        Ok(Self { plan: Arc::new(Plan { symbolic, tasks }) })
    }

    /// Multiplications, each with an addition, that a factorisation takes, about.
    pub fn work(&self) -> f64 {
        (0..self.plan.symbolic.num_supernodes()).map(|supernode| self.plan.symbolic.work(supernode)).sum()
    }

    /// Factorises a matrix of the pattern.
    ///
    /// # Errors
    ///
    /// [`SparseError::Singular`] with the unknowns whose pivot vanishes, [`SparseError::NonFinite`] where the matrix
    /// holds a NaN or an infinity.
    pub fn factorize(&self, matrix: &SymmetricMatrix) -> Result<Factor, SparseError> {
        if !matrix.values().iter().all(|v| v.is_finite()) {
            return Err(SparseError::NonFinite);
        }
        let symbolic = &self.plan.symbolic;
        let dofs = symbolic.order.len() * symbolic.block;
        let diagonal = symbolic.diagonal(matrix.values());
        let largest = diagonal.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(SparseError::Singular { dofs: (0..dofs).collect() });
        }
        // It is allocated part by part, by the threads that fill it, once known to fit.
        let entries =
            (0..symbolic.num_supernodes()).map(|supernode| symbolic.shape(supernode).iter().product::<usize>());
        Vec::<f64>::new().try_reserve_exact(entries.sum()).map_err(|_| SparseError::TooLarge { dofs })?;
        let floor = NEGLIGIBLE_PIVOT * largest;
        let undetermined = |factor: &Factor| -> Vec<usize> {
            let pivots =
                factor.pivots().filter(|&(dof, pivot)| !(pivot > VANISHING_PIVOT * diagonal[dof] && pivot > floor));
            pivots.map(|(dof, _)| dof).collect()
        };
        if let Some(factor) = self.eliminate(matrix, None).filter(|factor| undetermined(factor).is_empty()) {
            return Ok(factor);
        }
        // Once more with pivots raised, so that the factorisation runs to its end and every undetermined unknown can be
        // named: in a semi-definite matrix the rest of the column vanishes with the pivot.
        let factor = self.eliminate(matrix, Some(0.5 * floor)).ok_or(SparseError::NonFinite)?;
        let mut dofs = undetermined(&factor);
        dofs.sort_unstable();
        if dofs.is_empty() { Ok(factor) } else { Err(SparseError::Singular { dofs }) }
    }

    /// The factor of a matrix, its pivots raised to `floor` where one is given; `None` where a pivot is not positive.
    fn eliminate(&self, matrix: &SymmetricMatrix, floor: Option<f64>) -> Option<Factor> {
        let panels: Vec<Mutex<Vec<f64>>> = self.plan.tasks.iter().map(|_| Mutex::default()).collect();
        let failed = AtomicBool::new(false);
        self.plan.tasks.upwards(|index, task, below| {
            if failed.load(Ordering::Relaxed) {
                return Update::default();
            }
            let mut elimination = Elimination {
                symbolic: &self.plan.symbolic,
                floor,
                waiting: below,
                spare: Vec::new(),
                runs: Vec::new(),
            };
            match elimination.run(task, matrix.values()) {
                Ok(values) => *lock(&panels[index]) = values,
                Err(_) => failed.store(true, Ordering::Relaxed),
            }
            elimination.waiting.pop().unwrap_or_default()
        });
        let panels = panels.into_iter().map(|panel| std::mem::take(&mut *lock(&panel))).collect();
        (!failed.into_inner()).then(|| Factor { plan: Arc::clone(&self.plan), panels })
    }
}

/// What the elimination of a supernode leaves for its rows: a square, by columns.
#[derive(Default)]
struct Update {
    supernode: usize,
    values: Vec<f64>,
}

/// The elimination of the supernodes of a task.
struct Elimination<'a> {
    symbolic: &'a Symbolic,
    /// To which small pivots are raised.
    floor: Option<f64>,
    /// What waits for the parents of the supernodes done, those of one parent together.
    waiting: Vec<Update>,
    /// Memory to be used again.
    spare: Vec<Vec<f64>>,
    runs: Vec<Run>,
}

impl Elimination<'_> {
    /// Returns the panels; what the task's root leaves is then all that waits.
    fn run(&mut self, task: &Task, values: &[f64]) -> Result<Vec<f64>, LltError> {
        let sizes = task.supernodes.clone().map(|supernode| self.symbolic.shape(supernode).iter().product::<usize>());
        let mut panels = vec![0.0; sizes.sum()];
        let mut rest = panels.as_mut_slice();
        for supernode in task.supernodes.clone() {
            let [rows, columns] = self.symbolic.shape(supernode);
            let panel;
            (panel, rest) = rest.split_at_mut(rows * columns);
            let mut update = self.spare.pop().unwrap_or_default();
            update.clear();
            update.resize((rows - columns).pow(2), 0.0);
            let mut front = Front { panel, update: &mut update, rows, columns };
            front.scatter(self.symbolic, supernode, values);
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
            if self.symbolic.parent[supernode] != NONE {
                self.waiting.push(Update { supernode, values: update });
            }
        }
        Ok(panels)
    }
}
