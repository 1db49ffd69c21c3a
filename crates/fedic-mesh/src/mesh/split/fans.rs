//! The cells around the nodes of a path, divided by the cut.

use std::collections::{BTreeMap, HashSet};

use super::LineError;
use super::cut::{Cut, CutEdge};
use crate::Mesh;

/// Cells that a cut separates from others around a node, and that need a node of their own.
pub(super) struct Separation {
    pub(super) node: u32,
    pub(super) cells: Vec<usize>,
}

/// A cell at a node with its edges there: their corners, and what is cut.
struct Sector {
    cell: usize,
    edges: Vec<([u32; 2], Option<CutEdge>)>,
}

/// Finds the separations along a path, in its order.
///
/// Cells around a node are joined through the edges between them that are not cut. Of each group that the cut divides, the cells to
/// the left of the path keep the node.
///
/// # Errors
///
/// [`LineError::InsideEdge`] if the path covers a part of an edge.
pub(super) fn separations(mesh: &Mesh, places: &[u32], path: &[u32]) -> Result<Vec<Separation>, LineError> {
    let cut = Cut::new(places, path);
    let on_path: HashSet<u32> = path.iter().copied().collect();
    // By place and node.
    let mut sectors: BTreeMap<(u32, u32), Vec<Sector>> = BTreeMap::new();
    for cell in 0..mesh.num_cells() {
        for edge in mesh.edges(cell) {
            for node in edge.nodes().filter(|&node| on_path.contains(&places[node as usize])) {
                let around = sectors.entry((places[node as usize], node)).or_default();
                if around.last().is_none_or(|sector| sector.cell != cell) {
                    around.push(Sector { cell, edges: Vec::with_capacity(2) });
                }
                if let Some(sector) = around.last_mut() {
                    sector.edges.push((edge.key(), cut.of(mesh, &edge)?));
                }
            }
        }
    }
    let mut found = Vec::new();
    let mut passed = HashSet::new();
    for &place in path.iter().filter(|&&place| passed.insert(place)) {
        for (&(_, node), around) in sectors.range((place, 0)..=(place, u32::MAX)) {
            found.extend(separated(around).into_iter().map(|cells| Separation { node, cells }));
        }
    }
    Ok(found)
}

/// Groups of cells around a node that lose it.
fn separated(around: &[Sector]) -> Vec<Vec<usize>> {
    let joined = |through: fn(Option<CutEdge>) -> bool| {
        components(around.len(), |a, b| {
            let edges = |k: usize| around[k].edges.iter().filter(|(_, cut)| through(*cut)).map(|(key, _)| *key);
            edges(a).any(|key| edges(b).any(|other| other == key))
        })
    };
    // Cells that touch at the node alone were not joined before either: they stay as they are.
    let (before, fans) = (joined(|_| true), joined(|cut| cut.is_none()));
    let mut groups: BTreeMap<usize, BTreeMap<usize, Vec<usize>>> = BTreeMap::new();
    for (sector, (&whole, &fan)) in before.iter().zip(&fans).enumerate() {
        groups.entry(whole).or_default().entry(fan).or_default().push(sector);
    }
    let left = |fan: &Vec<usize>| {
        let edges = fan.iter().flat_map(|&sector| &around[sector].edges);
        edges.filter_map(|(_, cut)| cut.and_then(CutEdge::left_number)).min().unwrap_or(usize::MAX)
    };
    let mut separated = Vec::new();
    for group in groups.into_values() {
        let mut fans: Vec<Vec<usize>> = group.into_values().collect();
        fans.sort_by_key(left);
        separated
            .extend(fans.into_iter().skip(1).map(|fan| fan.into_iter().map(|sector| around[sector].cell).collect()));
    }
    separated
}

/// For each of `count` items the lowest one connected to it.
fn components(count: usize, connected: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut component = vec![usize::MAX; count];
    for first in 0..count {
        if component[first] < usize::MAX {
            continue;
        }
        component[first] = first;
        let mut pending = vec![first];
        while let Some(item) = pending.pop() {
            for other in 0..count {
                if component[other] == usize::MAX && connected(item, other) {
                    component[other] = first;
                    pending.push(other);
                }
            }
        }
    }
    component
}
