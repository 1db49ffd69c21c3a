//! Parallel work over cells whose results are gathered in the order of the cells.

use rayon::prelude::*;

use crate::observation::workspace::Work;
use crate::{Error, Monitor};

/// Cells between two questions whether to stop; bounds the results kept at once.
const BLOCK: usize = 2048;
/// Cells per task at the least.
const GRAIN: usize = 8;

/// Runs `work` on every cell in parallel, each with an item of its own, and `gather` on its results one after the other, in the
/// order of the cells: what is gathered does not depend on the number of threads. One block is gathered while the next is
/// worked on.
pub(crate) fn for_each_cell<I: Send, T: Send>(
    items: impl IntoIterator<Item = I>,
    monitor: &dyn Monitor,
    work: impl Fn(&mut Work, usize, I) -> T + Sync,
    mut gather: impl FnMut(usize, T) + Send,
) -> Result<(), Error> {
    let mut items = items.into_iter();
    let (mut results, mut done): (Vec<Option<T>>, Vec<Option<T>>) = (Vec::new(), Vec::new());
    let mut first = 0;
    loop {
        let block: Vec<I> = items.by_ref().take(BLOCK).collect();
        let (count, gathered) = (block.len(), done.len());
        let compute = || {
            block
                .into_par_iter()
                .enumerate()
                .with_min_len(GRAIN)
                .map_init(Work::new, |scratch, (index, item)| {
                    (!monitor.cancelled()).then(|| work(scratch, first + index, item))
                })
                .collect_into_vec(&mut results);
        };
        let take_in = || {
            done.drain(..).enumerate().try_for_each(|(index, result)| {
                gather(first - gathered + index, result.ok_or(Error::Cancelled)?);
                Ok::<(), Error>(())
            })
        };
        let ((), taken) = rayon::join(compute, take_in);
        taken?;
        if count == 0 {
            return Ok(());
        }
        std::mem::swap(&mut results, &mut done);
        first += count;
    }
}
