//! The direct solver: nested dissection, symbolic factorization once per pattern, numeric factorization per matrix.

use std::sync::Arc;

use crate::numeric::{Factorized, PivotCheck, StoredFloat, factorize};
use crate::ordering::{Graph, nested_dissection};
use crate::solve::Values;
use crate::symbolic::SymbolicFactor;
use crate::{Factor, Pattern, SparseError, SpdSolver, SymmetricMatrix};

/// Multifrontal Cholesky solver for the matrices of one [`Pattern`].
///
/// Clones share the symbolic factorization.
#[derive(Debug, Clone)]
pub struct Cholesky {
    symbolic: Arc<SymbolicFactor>,
}

impl Cholesky {
    /// Orders the nodes by nested dissection and computes the pattern of the factor.
    ///
    /// `points` are the coordinates of the nodes. They determine the ordering alone: poor ones cost time and memory,
    /// not accuracy.
    ///
    /// # Errors
    ///
    /// [`SparseError::TooLarge`] if the entries of the matrix exceed the range of the indices.
    ///
    /// # Panics
    ///
    /// If the number of points is not the number of nodes.
    pub fn new(pattern: &Pattern, points: &[[f64; 3]]) -> Result<Self, SparseError> {
        assert_eq!(points.len(), pattern.num_nodes(), "one point per node");
        if 2 * pattern.num_entries() > u32::MAX as usize {
            return Err(SparseError::TooLarge { dofs: pattern.num_dofs() });
        }
        let graph = Graph::new(pattern);
        let order = nested_dissection(&graph, points);
        Ok(Self { symbolic: Arc::new(SymbolicFactor::new(pattern, &graph, &order)) })
    }

    /// Nodes in the order of their elimination.
    pub fn elimination_order(&self) -> &[u32] {
        &self.symbolic.structure.order
    }

    /// Approximate number of multiply-add operations of a factorization.
    pub fn work(&self) -> f64 {
        let structure = &self.symbolic.structure;
        (0..structure.num_supernodes()).map(|supernode| structure.shape(supernode).work()).sum()
    }

    fn factor(&self, values: Values) -> Factor {
        Factor::new(Arc::clone(&self.symbolic), values)
    }

    /// Factorizes a matrix unless a pivot is not positive, vanishes, or makes it ill-conditioned while that is asked for.
    fn try_factorize<T: StoredFloat>(
        &self,
        matrix: &SymmetricMatrix,
        check: &PivotCheck,
        require_well_conditioned: bool,
    ) -> Result<Option<Factorized<T>>, SparseError> {
        let factorized = factorize(&self.symbolic, matrix, None)?;
        Ok(factorized.filter(|factorized| {
            let report = check.assess(&self.symbolic.structure, &factorized.pivots);
            report.undetermined.is_empty() && (report.well_conditioned || !require_well_conditioned)
        }))
    }
}

impl SpdSolver for Cholesky {
    type Factor = Factor;

    fn factorize(&self, matrix: &SymmetricMatrix) -> Result<Factor, SparseError> {
        let structure = &self.symbolic.structure;
        let check = PivotCheck::new(structure, matrix)?;
        if let Some(factorized) = self.try_factorize(matrix, &check, false)? {
            return Ok(self.factor(Values::Double(factorized.values)));
        }
        // In a semi-definite matrix the rest of a column vanishes with its pivot. With small pivots replaced, the
        // factorization runs to its end and shows every undetermined degree of freedom.
        let replaced = factorize(&self.symbolic, matrix, Some(check.replacement()))?.ok_or(SparseError::NonFinite)?;
        let dofs = check.assess(structure, &replaced.pivots).undetermined;
        if dofs.is_empty() {
            Ok(self.factor(Values::Double(replaced.values)))
        } else {
            Err(SparseError::Singular { dofs })
        }
    }

    fn factorize_compact(&self, matrix: &SymmetricMatrix) -> Result<Factor, SparseError> {
        let check = PivotCheck::new(&self.symbolic.structure, matrix)?;
        match self.try_factorize(matrix, &check, true)? {
            Some(factorized) => Ok(self.factor(Values::Single(factorized.values))),
            None => self.factorize(matrix),
        }
    }
}
