//! Sparse Cholesky factorisation through faer: the symbolic part once per pattern, the numeric part per matrix.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal,
};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::{Pattern, SparseError, SymmetricMatrix};

/// A pivot smaller than this fraction of its diagonal entry says that the unknown is not determined.
const VANISHING_PIVOT: f64 = 1e-11;
/// So does one smaller than this fraction of the largest diagonal entry: such small ones are made of rounding.
const NEGLIGIBLE_PIVOT: f64 = 1e-10;

/// The symbolic part of the factorisation: order of the unknowns and pattern of the factor, computed once per pattern.
#[derive(Debug, Clone)]
pub struct Cholesky {
    column_starts: Vec<usize>,
    row_indices: Vec<usize>,
    symbolic: Arc<SymbolicCholesky<usize>>,
}

/// The numeric part: the factor of one matrix.
#[derive(Debug, Clone)]
pub struct Factor {
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
}

impl Cholesky {
    /// Orders the nodes by approximate minimum degree and computes the pattern of the factor.
    ///
    /// # Errors
    ///
    /// [`SparseError::TooLarge`] where the factor cannot be numbered or stored.
    pub fn new(pattern: &Pattern) -> Result<Self, SparseError> {
        let dofs = pattern.num_dofs();
        let too_large = |_: FaerError| SparseError::TooLarge { dofs };
        let (column_starts, row_indices) = columns(pattern);
        let (forward, inverse) = node_order(pattern).map_err(too_large)?;
        let lower = SymbolicSparseColMatRef::new_checked(dofs, dofs, &column_starts, None, &row_indices);
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, dofs));
        let symbolic = factorize_symbolic_cholesky(lower, Side::Lower, order, CholeskySymbolicParams::default())
            .map_err(too_large)?;
        Ok(Self { column_starts, row_indices, symbolic: Arc::new(symbolic) })
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
        let dofs = self.symbolic.nrows();
        let diagonal = |dof: usize| matrix.values()[self.column_starts[dof]];
        let largest = (0..dofs).map(diagonal).fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(SparseError::Singular { dofs: (0..dofs).collect() });
        }
        let symbolic = SymbolicSparseColMatRef::new_checked(dofs, dofs, &self.column_starts, None, &self.row_indices);
        // Pivots below the floor are raised to it, so that the factorisation runs to its end and every undetermined
        // unknown can be named: in a semi-definite matrix the rest of the column vanishes with the pivot.
        let floor = 0.5 * NEGLIGIBLE_PIVOT * largest;
        let regularization =
            LltRegularization { dynamic_regularization_delta: floor, dynamic_regularization_epsilon: floor };
        let too_large = || SparseError::TooLarge { dofs };
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let mut buffer = MemBuffer::try_new(scratch).map_err(|_| too_large())?;
        let mut values = Vec::new();
        values.try_reserve_exact(self.symbolic.len_val()).map_err(|_| too_large())?;
        values.resize(self.symbolic.len_val(), 0.0);
        self.symbolic
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(symbolic, matrix.values()),
                Side::Lower,
                regularization,
                Par::Seq,
                MemStack::new(&mut buffer),
                Spec::default(),
            )
            .map_err(|_| SparseError::NonFinite)?;
        let factor = Factor { symbolic: Arc::clone(&self.symbolic), values };
        let mut singular: Vec<usize> = factor
            .pivots()
            .into_iter()
            .filter(|&(dof, pivot)| !(pivot > VANISHING_PIVOT * diagonal(dof) && pivot > 2.0 * floor))
            .map(|(dof, _)| dof)
            .collect();
        singular.sort_unstable();
        if singular.is_empty() { Ok(factor) } else { Err(SparseError::Singular { dofs: singular }) }
    }
}

impl Factor {
    /// Unknown and pivot of every column of the factor.
    fn pivots(&self) -> Vec<(usize, f64)> {
        let diagonal: Vec<f64> = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                symbolic.col_ptr()[..symbolic.ncols()].iter().map(|&start| self.values[start]).collect()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = supernodal::SupernodalLltRef::new(symbolic, &self.values);
                (0..symbolic.n_supernodes())
                    .flat_map(|s| {
                        let block = factor.supernode(s).val();
                        (0..block.ncols()).map(move |j| block[(j, j)])
                    })
                    .collect()
            }
        };
        let order = self.symbolic.perm().map(|p| p.arrays().0);
        diagonal.iter().enumerate().map(|(k, l)| (order.map_or(k, |order| order[k]), l * l)).collect()
    }

    /// Solves `A x = b` for one right-hand side or several, one after the other; `rhs` holds them and becomes the solutions.
    ///
    /// # Panics
    ///
    /// If `rhs` does not have one entry per unknown and right-hand side.
    pub fn solve(&self, rhs: &mut [f64]) {
        let dofs = self.symbolic.nrows();
        let columns = rhs.len() / dofs;
        let mut buffer = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq));
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, dofs, columns),
            Par::Seq,
            MemStack::new(&mut buffer),
        );
    }
}

/// Compressed columns of the lower triangle, unknown by unknown.
fn columns(pattern: &Pattern) -> (Vec<usize>, Vec<usize>) {
    let d = pattern.block();
    let mut starts = Vec::with_capacity(pattern.num_dofs() + 1);
    let mut rows = Vec::with_capacity(pattern.num_entries());
    for node in 0..pattern.num_nodes() {
        let neighbours = pattern.node_column(node);
        for j in 0..d {
            starts.push(rows.len());
            let dofs = neighbours.iter().flat_map(|&row| (0..d).map(move |i| row as usize * d + i));
            rows.extend(dofs.skip(j));
        }
    }
    starts.push(rows.len());
    (starts, rows)
}

/// Fill-reducing order of the nodes, each expanded to its unknowns: the graph of the nodes is `block^2` times smaller
/// than that of the unknowns and has the same good orders.
fn node_order(pattern: &Pattern) -> Result<(Vec<usize>, Vec<usize>), FaerError> {
    let nodes = pattern.num_nodes();
    let d = pattern.block();
    let starts: Vec<usize> = std::iter::once(0)
        .chain((0..nodes).scan(0, |sum, node| {
            *sum += pattern.node_column(node).len();
            Some(*sum)
        }))
        .collect();
    let rows: Vec<usize> =
        (0..nodes).flat_map(|node| pattern.node_column(node).iter().map(|&row| row as usize)).collect();
    let graph = SymbolicSparseColMatRef::new_checked(nodes, nodes, &starts, None, &rows);
    let mut buffer =
        MemBuffer::try_new(amd::order_scratch::<usize>(nodes, rows.len())).map_err(|_| FaerError::OutOfMemory)?;
    let (mut forward, mut inverse) = (vec![0; nodes], vec![0; nodes]);
    amd::order(&mut forward, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut buffer))?;
    let expand = |order: &[usize]| order.iter().flat_map(|&node| (0..d).map(move |j| node * d + j)).collect();
    Ok((expand(&forward), expand(&inverse)))
}
