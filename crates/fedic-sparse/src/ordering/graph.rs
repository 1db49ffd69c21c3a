//! Adjacency graph of the nodes.

use crate::Pattern;

/// Neighbours of every node, in compressed rows; a node is not its own neighbour.
pub(crate) struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// Builds the graph of a pattern.
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let nodes = pattern.num_nodes();
        let edges =
            || (0..nodes).flat_map(|low| pattern.node_column(low)[1..].iter().map(move |&high| (low as u32, high)));
        let mut starts = vec![0; nodes + 1];
        for (low, high) in edges() {
            starts[low as usize + 1] += 1;
            starts[high as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; starts[nodes]];
        for (low, high) in edges() {
            for (from, to) in [(low, high), (high, low)] {
                neighbours[next[from as usize]] = to;
                next[from as usize] += 1;
            }
        }
        Self { starts, neighbours }
    }

    /// Number of nodes.
    pub(crate) fn num_nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Nodes adjacent to `node`, in no particular order.
    pub(crate) fn neighbours(&self, node: u32) -> &[u32] {
        &self.neighbours[self.starts[node as usize]..self.starts[node as usize + 1]]
    }
}
