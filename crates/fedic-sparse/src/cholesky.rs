//! Sparse Cholesky factorisation: the symbolic part once per pattern, the numeric part per matrix.
//!
//! The numeric part is multifrontal (Duff and Reid 1983): a supernode is eliminated as a dense matrix, and what that leaves for
//! the rows below is handed up the elimination tree, whose branches are worked on in parallel.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use fedic_memory::AlignedBuffer;

use crate::dissection::nested_dissection;
use crate::elimination::{Elimination, Update};
use crate::factor::{Factor, Values};
use crate::graph::Graph;
use crate::minimum_degree::minimum_degree;
use crate::panel::Stored;
use crate::symbolic::Symbolic;
use crate::tree::{Tasks, Threads, lock};
use crate::{Pattern, SparseError, SymmetricMatrix};

/// A pivot smaller than this fraction of its diagonal entry says that the unknown is not determined.
const VANISHING_PIVOT: f64 = 1e-11;
/// So does one smaller than this fraction of the largest diagonal entry: such small ones are made of rounding.
const NEGLIGIBLE_PIVOT: f64 = 1e-10;
/// Above this fraction of its diagonal entry, single precision serves to store what a pivot divides.
const SMALL_PIVOT: f64 = 1e-3;

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
    /// Orders the nodes by approximate minimum degree and computes the pattern of the factor: for a graph without coordinates.
    /// Where there are some, [`of_mesh`](Self::of_mesh) finds the better order for a large mesh.
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

    /// Multiplications, each with an addition, that a factorisation takes, about: what tells a good order from a poor one.
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
        let checks = self.checks(matrix)?;
        if let Some(eliminated) = self.eliminate(matrix, None)? {
            let (dofs, _) = checks.undetermined(&self.plan.symbolic, &eliminated.pivots);
            if dofs.is_empty() {
                return Ok(Factor::new(Arc::clone(&self.plan), Values::Double(eliminated.values)));
            }
        }
        // Once more with pivots raised, so that the factorisation runs to its end and every undetermined unknown can be
        // named: in a semi-definite matrix the rest of the column vanishes with the pivot.
        let eliminated = self.eliminate(matrix, Some(0.5 * checks.floor))?.ok_or(SparseError::NonFinite)?;
        let (dofs, _) = checks.undetermined(&self.plan.symbolic, &eliminated.pivots);
        if dofs.is_empty() {
            Ok(Factor::new(Arc::clone(&self.plan), Values::Double(eliminated.values)))
        } else {
            Err(SparseError::Singular { dofs })
        }
    }

    /// The same with a factor that is kept in single precision, half as large, where the matrix is well conditioned: where no
    /// pivot is small beside its diagonal entry. All arithmetic is in double precision. Solutions are then those of a
    /// matrix that differs by 1e-7, relatively: as good as any for corrections repeated until they vanish.
    ///
    /// # Errors
    ///
    /// Those of [`factorize`](Self::factorize).
    pub fn factorize_compact(&self, matrix: &SymmetricMatrix) -> Result<Factor, SparseError> {
        let checks = self.checks(matrix)?;
        if let Some(eliminated) = self.eliminate(matrix, None)? {
            let (dofs, smallest) = checks.undetermined(&self.plan.symbolic, &eliminated.pivots);
            if dofs.is_empty() && smallest > SMALL_PIVOT {
                return Ok(Factor::new(Arc::clone(&self.plan), Values::Single(eliminated.values)));
            }
        }
        self.factorize(matrix)
    }

    /// What the pivots of a matrix are compared with.
    fn checks(&self, matrix: &SymmetricMatrix) -> Result<Checks, SparseError> {
        if !matrix.values().iter().all(|v| v.is_finite()) {
            return Err(SparseError::NonFinite);
        }
        let symbolic = &self.plan.symbolic;
        let diagonal = symbolic.diagonal(matrix.values());
        let dofs = diagonal.len();
        let largest = diagonal.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(SparseError::Singular { dofs: (0..dofs).collect() });
        }
        Ok(Checks { diagonal, floor: NEGLIGIBLE_PIVOT * largest })
    }

    /// Eliminates all supernodes, pivots raised to `floor` where one is given; `None` where a pivot is not positive.
    fn eliminate<T: Stored>(
        &self,
        matrix: &SymmetricMatrix,
        floor: Option<f64>,
    ) -> Result<Option<Eliminated<T>>, SparseError> {
        let Plan { symbolic, tasks } = self.plan.as_ref();
        let sizes: Vec<usize> = tasks.iter().map(|task| symbolic.num_stored(&task.supernodes)).collect();
        let total = sizes.iter().sum();
        // Only a zeroed allocation leaves its pages to the threads that fill them; it is made once known to fit.
        let too_large = |_| SparseError::TooLarge { dofs: symbolic.order.len() * symbolic.block };
        Vec::<T>::new().try_reserve_exact(total).map_err(too_large)?;
        let mut values = AlignedBuffer::zeros(total);
        let mut rest = &mut *values;
        let take = |&size: &usize| {
            let own;
            (own, rest) = std::mem::take(&mut rest).split_at_mut(size);
            Mutex::new((own, None::<Vec<f64>>))
        };
        let parts: Vec<Mutex<_>> = sizes.iter().map(take).collect();
        let failed = AtomicBool::new(false);
        tasks.upwards(Threads::All, |index, task, below| {
            if failed.load(Ordering::Relaxed) {
                return Update::default();
            }
            let mut elimination = Elimination::new(symbolic, floor, below);
            let (factor, pivots) = &mut *lock(&parts[index]);
            match elimination.run(task, matrix.values(), factor) {
                Ok(found) => *pivots = Some(found),
                Err(_) => failed.store(true, Ordering::Relaxed),
            }
            elimination.left()
        });
        let pivots: Option<Vec<Vec<f64>>> = parts.into_iter().map(|part| lock(&part).1.take()).collect();
        Ok(pivots.map(|pivots| Eliminated { values, pivots: pivots.concat() }))
    }
}

/// What an elimination makes.
struct Eliminated<T> {
    /// The supernodes of the factor, one after the other.
    values: AlignedBuffer<T>,
    /// The pivots of all their columns.
    pivots: Vec<f64>,
}

/// What pivots are compared with.
struct Checks {
    /// Diagonal of the matrix.
    diagonal: Vec<f64>,
    floor: f64,
}

impl Checks {
    /// The unknowns whose pivots vanish, increasing, and the smallest pivot over its diagonal entry.
    fn undetermined(&self, symbolic: &Symbolic, pivots: &[f64]) -> (Vec<usize>, f64) {
        let d = symbolic.block;
        let (mut dofs, mut smallest) = (Vec::new(), f64::MAX);
        let unknowns = symbolic.order.iter().flat_map(|&node| (0..d).map(move |j| node as usize * d + j));
        for (dof, &pivot) in unknowns.zip(pivots) {
            let relative = pivot / self.diagonal[dof];
            smallest = smallest.min(relative);
            if !(relative > VANISHING_PIVOT && pivot > self.floor) {
                dofs.push(dof);
            }
        }
        dofs.sort_unstable();
        (dofs, smallest)
    }
}
