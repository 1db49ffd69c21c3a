//! Choice of the instruction set at run time.

use pulp::{Arch, WithSimd};

/// Number of vectors summed in single precision before the sum is added to a total in double precision.
pub(crate) const FLUSH: usize = 32;

/// Runs a kernel with the best instruction set of the processor.
pub(crate) fn run<O: WithSimd>(operation: O) -> O::Output {
    Arch::new().dispatch(operation)
}
