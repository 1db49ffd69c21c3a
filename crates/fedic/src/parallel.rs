//! Parallel loop over cells.

use rayon::prelude::*;

use crate::{Error, Monitor};

/// Number of cells whose results are kept at once.
const BLOCK: usize = 2048;
/// Smallest number of cells per task.
const GRAIN: usize = 8;

/// Runs `work` on every item in parallel and passes the results to `gather` one after the other, in the order of the items.
///
/// `work` gets scratch buffers of its thread, the index of the item and the item. What `gather` computes does not depend on the
/// number of threads. One block of results is gathered while the next is computed.
///
/// # Errors
///
/// [`Error::Cancelled`] if `monitor` asks to stop.
pub(crate) fn for_each_in_order<S: Default, I: Send, T: Send>(
    items: impl IntoIterator<Item = I>,
    monitor: &dyn Monitor,
    work: impl Fn(&mut S, usize, I) -> T + Sync,
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
                .map_init(S::default, |scratch, (index, item)| {
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
