//! Patches of a mesh: the linear cells around each point of a lattice of nodes, connected across edges.

use std::collections::BTreeSet;

use fedic_mesh::{Mesh, map, shape_values};
use nalgebra::Vector3;

/// Number of coefficients of a quadratic polynomial in two variables.
const NUM_QUADRATIC: usize = 6;

/// The linear cells around a point that are connected across the edges at this point.
///
/// Points are the nodes, and the centres of cells whose nodes leave a gap there. Quadratic cells are cut into linear ones between
/// these points. Cells on the two sides of a crack, or that meet in the point alone, belong to different patches.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// Points of these cells, increasing: nodes of the mesh, and the number of nodes plus the number of the cell for the centre of a
    /// cell. Patches with too few points for a quadratic polynomial have those of the cells across their edges as well.
    pub(crate) points: Vec<u32>,
    /// Nodes that the values at the points depend on, increasing.
    pub(crate) nodes: Vec<u32>,
    /// Cells of the mesh around the point.
    pub(crate) cells: Vec<u32>,
    /// Share of the area of these cells.
    pub(crate) area: f64,
    /// Unit normal.
    pub(crate) normal: [f64; 3],
    /// Whether the cells surround the point.
    pub(crate) surrounded: bool,
}

/// A linear cell.
struct LinearCell {
    /// Cell of the mesh that it is part of.
    cell: u32,
    /// Corners, of which neighbours may be the same.
    points: Vec<u32>,
    /// Integral of the normal.
    area_vector: Vector3<f64>,
}

/// An edge, its lower point first, and one of its cells.
type Side = ([u32; 2], u32);

/// Patches of a mesh, in the order of their points.
pub(crate) fn patches(mesh: &Mesh) -> Vec<Patch> {
    let cells = linear_cells(mesh);
    let mut sides: Vec<Side> = cells.iter().enumerate().flat_map(|(index, cell)| sides_of(index, cell)).collect();
    sides.sort_unstable();
    let edges = || sides.chunk_by(|a, b| a.0 == b.0);
    let mut across = vec![Vec::new(); cells.len()];
    for edge in edges() {
        for &(_, a) in edge {
            across[a as usize].extend(edge.iter().map(|&(_, b)| b).filter(|&b| b != a));
        }
    }
    // Each edge at both of its points.
    let mut stars: Vec<(u32, &[Side])> = edges().flat_map(|edge| edge[0].0.map(|point| (point, edge))).collect();
    stars.sort_by_key(|&(point, _)| point);
    stars.chunk_by(|a, b| a.0 == b.0).flat_map(|star| patches_of_point(mesh, &cells, star, &across)).collect()
}

/// Position of a point of the lattice.
pub(crate) fn position(mesh: &Mesh, point: u32) -> [f64; 3] {
    match (point as usize).checked_sub(mesh.num_nodes()) {
        None => mesh.points()[point as usize],
        Some(cell) => {
            let cell_type = mesh.cell(cell).cell_type;
            map(cell_type, &mesh.cell_points(cell), cell_type.reference_centre())
        }
    }
}

/// Nodes that the value at a point of the lattice depends on, and their shares.
pub(crate) fn shares(mesh: &Mesh, point: u32) -> Vec<(u32, f64)> {
    match (point as usize).checked_sub(mesh.num_nodes()) {
        None => vec![(point, 1.0)],
        Some(cell) => {
            let cell = mesh.cell(cell);
            let shape = shape_values(cell.cell_type, cell.cell_type.reference_centre());
            cell.nodes.iter().copied().zip(shape).collect()
        }
    }
}

fn linear_cells(mesh: &Mesh) -> Vec<LinearCell> {
    let mut cells = Vec::new();
    for (index, cell) in mesh.cells().enumerate() {
        let centre = (mesh.num_nodes() + index) as u32;
        for part in cell.cell_type.data().linear_parts {
            let points: Vec<u32> = part.iter().map(|&local| cell.nodes.get(local).copied().unwrap_or(centre)).collect();
            let corners: Vec<Vector3<f64>> = points.iter().map(|&point| position(mesh, point).into()).collect();
            let area_vector =
                corners.windows(2).map(|pair| (pair[0] - corners[0]).cross(&(pair[1] - corners[0])) / 2.0).sum();
            cells.push(LinearCell { cell: index as u32, points, area_vector });
        }
    }
    cells
}

/// Edges of a linear cell, those between repeated points left out.
fn sides_of(index: usize, cell: &LinearCell) -> impl Iterator<Item = Side> {
    let next = cell.points.iter().cycle().skip(1);
    let edges = cell.points.iter().zip(next).filter(|(a, b)| a != b);
    edges.map(move |(&a, &b)| ([a.min(b), a.max(b)], index as u32))
}

/// Patches of a point from the edges there.
fn patches_of_point(mesh: &Mesh, cells: &[LinearCell], star: &[(u32, &[Side])], across: &[Vec<u32>]) -> Vec<Patch> {
    let mut fans: Vec<BTreeSet<u32>> = Vec::new();
    for (_, edge) in star {
        let mut fan: BTreeSet<u32> = edge.iter().map(|&(_, cell)| cell).collect();
        fans.retain(|other| {
            let apart = fan.is_disjoint(other);
            if !apart {
                fan.extend(other);
            }
            apart
        });
        fans.push(fan);
    }
    let patch = |fan: BTreeSet<u32>| {
        let mut area = 0.0;
        let mut normal = Vector3::zeros();
        for cell in fan.iter().map(|&cell| &cells[cell as usize]) {
            area += cell.area_vector.norm() / cell.points.len() as f64;
            // Cells may be numbered in either sense.
            normal += cell.area_vector.dot(&normal).signum() * cell.area_vector;
        }
        let on_mesh: BTreeSet<u32> = fan.iter().map(|&cell| cells[cell as usize].cell).collect();
        let points = points_of(cells, &fan, across);
        let nodes: BTreeSet<u32> = points.iter().flat_map(|&point| shares(mesh, point)).map(|(node, _)| node).collect();
        Patch {
            points,
            nodes: nodes.into_iter().collect(),
            cells: on_mesh.into_iter().collect(),
            area,
            normal: normal.try_normalize(0.0).unwrap_or_else(Vector3::z).into(),
            surrounded: star.iter().all(|(_, edge)| edge.len() > 1 || !fan.contains(&edge[0].1)),
        }
    };
    fans.into_iter().map(patch).collect()
}

/// Points of some linear cells, and of those across their edges until there are enough for a quadratic polynomial.
fn points_of(cells: &[LinearCell], fan: &BTreeSet<u32>, across: &[Vec<u32>]) -> Vec<u32> {
    let mut fan = fan.clone();
    loop {
        let points: BTreeSet<u32> = fan.iter().flat_map(|&cell| &cells[cell as usize].points).copied().collect();
        let before = fan.len();
        if points.len() < NUM_QUADRATIC {
            let grown: Vec<u32> = fan.iter().flat_map(|&cell| &across[cell as usize]).copied().collect();
            fan.extend(grown);
        }
        if fan.len() == before {
            return points.into_iter().collect();
        }
    }
}

/// Number of the part of the mesh that each cell belongs to. Cells of a patch are in the same part.
pub(crate) fn parts(num_cells: usize, patches: &[Patch]) -> Vec<usize> {
    let mut part: Vec<usize> = (0..num_cells).collect();
    let root = |part: &mut Vec<usize>, mut cell: usize| {
        while part[cell] != cell {
            part[cell] = part[part[cell]];
            cell = part[cell];
        }
        cell
    };
    for patch in patches {
        for pair in patch.cells.windows(2) {
            let (a, b) = (root(&mut part, pair[0] as usize), root(&mut part, pair[1] as usize));
            part[a.max(b)] = a.min(b);
        }
    }
    (0..num_cells).map(|cell| root(&mut part, cell)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;

    #[test]
    fn each_point_has_one_patch_which_its_cells_surround_if_it_is_inside() {
        for cell_type in CellType::ALL {
            let mesh = rectangle_mesh([0.0, 0.0, 4.0, 4.0], 1.0, cell_type).unwrap();
            let patches = patches(&mesh);
            let centres = if cell_type == CellType::Quad8 { mesh.num_cells() } else { 0 };
            assert_eq!(patches.len(), mesh.num_nodes() + centres, "{cell_type:?}");
            let inside = |point: usize| position(&mesh, point as u32)[..2].iter().all(|&x| x > 0.0 && x < 4.0);
            assert!((0..patches.len()).all(|point| patches[point].surrounded == inside(point)), "{cell_type:?}");
            assert!(patches.iter().all(|patch| patch.points.len() >= NUM_QUADRATIC && patch.points.is_sorted()));
            assert!(patches.iter().all(|patch| patch.normal == [0.0, 0.0, 1.0]));
            assert!((patches.iter().map(|patch| patch.area).sum::<f64>() - 16.0).abs() < 1e-12, "{cell_type:?}");
            assert!(parts(mesh.num_cells(), &patches).iter().all(|&part| part == 0));
        }
    }

    #[test]
    fn quads_that_share_a_node_alone_are_in_different_patches_and_parts() {
        let at = |x: f64, y: f64| [x, y, 0.0];
        let points = vec![at(0., 0.), at(1., 0.), at(1., 1.), at(0., 1.), at(2., 1.), at(2., 2.), at(1., 2.)];
        let mesh = Mesh::new(points, &[(CellType::Quad, vec![0, 1, 2, 3, 2, 4, 5, 6])]).unwrap();
        let patches = patches(&mesh);
        assert_eq!(patches.len(), 8);
        assert!(patches.iter().all(|patch| patch.cells.len() == 1 && patch.nodes.len() == 4 && !patch.surrounded));
        assert_eq!(parts(2, &patches), [0, 1]);
    }
}
