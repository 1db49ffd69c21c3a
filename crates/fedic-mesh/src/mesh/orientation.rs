//! Orientation of the cells of a mesh, and detection of degenerate cells.

use std::collections::HashMap;

use super::Mesh;
use crate::isoparametric::{cross, tangents};
use crate::{CellType, MeshError};

/// Area elements below this fraction of the squared size of their cell count as zero.
const DEGENERATE: f64 = 1e-9;
/// A connected surface whose area projected onto the `(x, y)` plane is below this fraction of its area counts as vertical.
const VERTICAL: f64 = 1e-6;

/// Indices of the cells to reverse, ascending.
///
/// In a mesh parallel to the `(x, y)` plane these are the clockwise cells. In a surface in space neighbouring cells get the
/// same orientation, and each connected part the one in which most of its area is counter-clockwise seen from `+z`; a
/// vertical or closed part keeps the orientation of its first cell.
///
/// # Errors
///
/// [`MeshError::DegenerateCells`] if cells have zero area or are folded.
pub(super) fn cells_to_reverse(mesh: &Mesh) -> Result<Vec<usize>, MeshError> {
    let mut normals = Vec::with_capacity(mesh.num_cells());
    let mut degenerate = Vec::new();
    for index in 0..mesh.num_cells() {
        let (points, num_nodes) = mesh.cell_points_array(index);
        match centre_normal(mesh.cell(index).cell_type, &points[..num_nodes]) {
            Some(normal) => normals.push(normal),
            None => degenerate.push(index),
        }
    }
    if !degenerate.is_empty() {
        return Err(MeshError::DegenerateCells { cells: degenerate });
    }
    let height = |&node: &u32| mesh.points[node as usize][2];
    let is_level = mesh.nodes.windows(2).all(|pair| height(&pair[0]) == height(&pair[1]));
    let reversed = if is_level { normals.iter().map(|n| n[2] < 0.0).collect() } else { consistent(mesh, &normals) };
    Ok((0..mesh.num_cells()).filter(|&cell| reversed[cell]).collect())
}

/// Normal of a cell at its centre, as long as the area element there; `None` if the area is zero or the normals at the nodes
/// point to the other side.
fn centre_normal(cell_type: CellType, nodes: &[[f64; 3]]) -> Option<[f64; 3]> {
    let extent = |d: usize| {
        let (low, high) = nodes.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[d]), h.max(p[d])));
        high - low
    };
    let smallest = DEGENERATE * (0..3).map(|d| extent(d).powi(2)).sum::<f64>();
    let normal_at = |at| cross(tangents(cell_type, nodes, at));
    let normal = normal_at(cell_type.reference_centre());
    let length = dot(normal, normal).sqrt();
    let same_side = |&at: &[f64; 2]| dot(normal, normal_at(at)) >= -smallest * length;
    (length > smallest && cell_type.reference_nodes().iter().all(same_side)).then_some(normal)
}

/// For each cell, whether to reverse it so that neighbours agree.
fn consistent(mesh: &Mesh, normals: &[[f64; 3]]) -> Vec<bool> {
    let neighbours = Neighbours::new(mesh);
    let mut reversed: Vec<Option<bool>> = vec![None; mesh.num_cells()];
    let (mut part, mut pending) = (Vec::new(), Vec::new());
    for first in 0..mesh.num_cells() {
        if reversed[first].is_some() {
            continue;
        }
        reversed[first] = Some(false);
        part.clear();
        pending.push(first);
        let (mut projected, mut area) = (0.0, 0.0);
        while let Some(cell) = pending.pop() {
            part.push(cell);
            let is_reversed = reversed[cell] == Some(true);
            let weight = mesh.cell(cell).cell_type.reference_area();
            projected += weight * if is_reversed { -normals[cell][2] } else { normals[cell][2] };
            area += weight * dot(normals[cell], normals[cell]).sqrt();
            for (neighbour, agrees) in neighbours.of(mesh, cell) {
                if reversed[neighbour].is_none() {
                    reversed[neighbour] = Some(is_reversed == agrees);
                    pending.push(neighbour);
                }
            }
        }
        if projected < -VERTICAL * area {
            part.iter().for_each(|&cell| reversed[cell] = reversed[cell].map(|is_reversed| !is_reversed));
        }
    }
    reversed.into_iter().map(|is_reversed| is_reversed == Some(true)).collect()
}

/// The cells on each edge, an edge being its two corners in ascending order.
struct Neighbours(HashMap<[u32; 2], Vec<EdgeUse>>);

/// A cell on an edge.
struct EdgeUse {
    cell: usize,
    /// Whether the cell runs along the edge from the lower to the higher node.
    ascending: bool,
}

impl Neighbours {
    fn new(mesh: &Mesh) -> Self {
        let mut edges: HashMap<[u32; 2], Vec<EdgeUse>> = HashMap::with_capacity(2 * mesh.num_cells());
        for cell in 0..mesh.num_cells() {
            for (edge, ascending) in corner_edges(mesh, cell) {
                edges.entry(edge).or_default().push(EdgeUse { cell, ascending });
            }
        }
        Self(edges)
    }

    /// The neighbours of a cell, and whether their orientation agrees with the cell's: they run along the shared edge in
    /// opposite directions. An edge of more than two cells makes no neighbours.
    fn of<'a>(&'a self, mesh: &'a Mesh, cell: usize) -> impl Iterator<Item = (usize, bool)> + 'a {
        corner_edges(mesh, cell).filter_map(move |(edge, ascending)| match self.0.get(&edge).map(Vec::as_slice) {
            Some([one, other]) => {
                let neighbour = if one.cell == cell { other } else { one };
                Some((neighbour.cell, neighbour.ascending != ascending))
            }
            _ => None,
        })
    }
}

/// The edges of a cell between its corners, in ascending order of nodes, and whether the cell runs along them in that order.
/// Two equal corners make no edge.
fn corner_edges(mesh: &Mesh, cell: usize) -> impl Iterator<Item = ([u32; 2], bool)> + '_ {
    let cell = mesh.cell(cell);
    let corners = &cell.nodes[..cell.cell_type.num_corners()];
    let edges = corners.iter().enumerate().map(move |(k, &from)| (from, corners[(k + 1) % corners.len()]));
    edges.filter(|(from, to)| from != to).map(|(from, to)| ([from.min(to), from.max(to)], from < to))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
