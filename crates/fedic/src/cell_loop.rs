//! Parallel work over cells whose results are gathered in the order of the cells.

use rayon::prelude::*;

use crate::batch::Batch;
use crate::{Error, Monitor};

/// Cells between two questions whether to stop; bounds the results kept at once.
const BLOCK: usize = 2048;
/// Cells per task at the least.
const GRAIN: usize = 8;

/// Runs `work` on every cell in parallel and `gather` on its results one after the other, in the order of the cells: what
/// is gathered does not depend on the number of threads.
pub(crate) fn for_each_cell<T: Send>(
    num_cells: usize,
    monitor: &dyn Monitor,
    work: impl Fn(&mut Batch, usize) -> T + Sync,
    mut gather: impl FnMut(usize, T),
) -> Result<(), Error> {
    let mut results = Vec::with_capacity(BLOCK.min(num_cells));
    for start in (0..num_cells).step_by(BLOCK) {
        (start..num_cells.min(start + BLOCK))
            .into_par_iter()
            .with_min_len(GRAIN)
            .map_init(Batch::new, |batch, cell| (!monitor.cancelled()).then(|| work(batch, cell)))
            .collect_into_vec(&mut results);
        for (offset, result) in results.drain(..).enumerate() {
            gather(start + offset, result.ok_or(Error::Cancelled)?);
        }
    }
    Ok(())
}
