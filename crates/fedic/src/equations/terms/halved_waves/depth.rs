//! Distance of the nodes from the edges of a mesh.

use crate::equations::patches::Patch;

/// Smallest number of patches between each node and a free edge, capped at `limit`; nodes at an edge have zero.
pub(super) fn depths(num_nodes: usize, patches: &[Patch], limit: usize) -> Vec<usize> {
    let mut depth = vec![limit; num_nodes];
    for patch in patches.iter().filter(|patch| !patch.surrounded) {
        // The point itself is on the edge; its neighbours are taken to be, too.
        patch.nodes.iter().for_each(|&node| depth[node as usize] = 0);
    }
    for layer in 1..limit {
        let reached: Vec<u32> = patches
            .iter()
            .filter(|patch| patch.nodes.iter().any(|&node| depth[node as usize] == layer - 1))
            .flat_map(|patch| patch.nodes.iter().copied())
            .filter(|&node| depth[node as usize] == limit)
            .collect();
        if reached.is_empty() {
            break;
        }
        reached.into_iter().for_each(|node| depth[node as usize] = layer);
    }
    depth
}
