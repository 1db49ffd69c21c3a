//! Factorization of all supernodes by the tasks of the schedule.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use fedic_memory::AlignedBuffer;

use crate::symbolic::{SymbolicFactor, Threading, lock};
use crate::{SparseError, SymmetricMatrix};

use super::multifrontal::{Multifrontal, Update};
use super::packed::StoredFloat;

/// The values of a factor and its pivots.
pub(crate) struct Factorized<T> {
    /// Packed columns of the supernodes, one after the other.
    pub(crate) values: AlignedBuffer<T>,
    /// Pivots of all columns.
    pub(crate) pivots: Vec<f64>,
}

/// Factorizes a matrix. Pivots smaller than `replacement` are replaced by it; without one, returns `None` if a pivot is
/// not positive.
///
/// # Errors
///
/// [`SparseError::TooLarge`] if the factor does not fit in memory.
pub(crate) fn factorize<T: StoredFloat>(
    symbolic: &SymbolicFactor,
    matrix: &SymmetricMatrix,
    replacement: Option<f64>,
) -> Result<Option<Factorized<T>>, SparseError> {
    let SymbolicFactor { structure, schedule } = symbolic;
    let sizes: Vec<usize> = schedule.tasks().iter().map(|task| structure.packed_len(&task.supernodes)).collect();
    let total = sizes.iter().sum();
    // The zeroed allocation below leaves its pages to the threads that fill them, but cannot fail gracefully.
    let too_large = |_| SparseError::TooLarge { dofs: structure.num_dofs() };
    Vec::<T>::new().try_reserve_exact(total).map_err(too_large)?;
    let mut values = AlignedBuffer::zeros(total);
    let mut rest = &mut *values;
    let outputs: Vec<Mutex<_>> = sizes
        .iter()
        .map(|&size| {
            let own;
            (own, rest) = std::mem::take(&mut rest).split_at_mut(size);
            Mutex::new((own, None::<Vec<f64>>))
        })
        .collect();
    let failed = AtomicBool::new(false);
    schedule.bottom_up(Threading::Parallel, |index, task, children| {
        if failed.load(Ordering::Relaxed) {
            return Update::default();
        }
        let mut multifrontal = Multifrontal::new(structure, replacement, children);
        let (packed, pivots) = &mut *lock(&outputs[index]);
        match multifrontal.run(task, matrix.values(), packed) {
            Ok(found) => *pivots = Some(found),
            Err(_) => failed.store(true, Ordering::Relaxed),
        }
        multifrontal.into_update()
    });
    let pivots: Option<Vec<Vec<f64>>> = outputs.into_iter().map(|output| lock(&output).1.take()).collect();
    Ok(pivots.map(|pivots| Factorized { values, pivots: pivots.concat() }))
}
