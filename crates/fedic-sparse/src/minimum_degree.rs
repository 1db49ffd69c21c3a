//! Fill-reducing order of a graph alone: approximate minimum degree, through faer.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;
use faer::sparse::{FaerError, SymbolicSparseColMatRef};

use crate::Pattern;

/// The nodes in the order of their elimination. The graph of the nodes is `block^2` times smaller than that of the unknowns
/// and has the same good orders.
pub(crate) fn minimum_degree(pattern: &Pattern) -> Result<Vec<u32>, FaerError> {
    let nodes = pattern.num_nodes();
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
    Ok(forward.into_iter().map(|node| node as u32).collect())
}
