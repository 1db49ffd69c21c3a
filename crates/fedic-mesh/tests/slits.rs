//! Pairs of edges at one place that do not have the same nodes.

#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeSet;

use fedic_mesh::{CellEdge, CellType, Mesh, rectangle_mesh};

fn mesh(cell: CellType) -> Mesh {
    rectangle_mesh([0.0, 0.0, 4.0, 3.0], 1.0, cell).unwrap()
}

/// Places of the corners of an edge, in ascending order.
fn ends(mesh: &Mesh, CellEdge { cell, edge }: CellEdge) -> [[i64; 2]; 2] {
    let corners = mesh.cell(cell).cell_type.num_corners();
    let points = mesh.cell_points(cell);
    let mut ends = [edge, (edge + 1) % corners].map(|corner| [0, 1].map(|d| (1e3 * points[corner][d]).round() as i64));
    ends.sort_unstable();
    ends
}

#[test]
fn a_cut_has_one_slit_for_each_edge() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        assert!(whole.slits(Mesh::COINCIDENT).is_empty());
        let cut = whole.split(&[[0.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 2.0, 0.0]]).unwrap();
        let slits = cut.slits(Mesh::COINCIDENT);
        let places: BTreeSet<_> = slits.iter().map(|sides| ends(&cut, sides[0])).collect();
        let expected = [[[0, 1000], [1000, 1000]], [[1000, 1000], [2000, 1000]], [[2000, 1000], [2000, 2000]]];
        assert_eq!(places, BTreeSet::from(expected), "{cell}");
        assert_eq!(slits.len(), 3, "{cell}");
        assert!(slits.iter().all(|&[one, other]| one.cell < other.cell && ends(&cut, one) == ends(&cut, other)));
        assert!(cut.merge_nodes(0.0).unwrap().slits(Mesh::COINCIDENT).is_empty());
    }
}

#[test]
fn an_edge_whose_middle_node_alone_is_doubled_is_a_slit() {
    for cell in CellType::ALL.into_iter().filter(|cell| cell.edge_intervals() == 2) {
        let cut = mesh(cell).split(&[[1.0, 1.0, 0.0], [2.0, 1.0, 0.0]]).unwrap();
        assert_eq!(cut.slits(Mesh::COINCIDENT).len(), 1, "{cell}");
    }
}

#[test]
fn cells_with_nodes_of_their_own_have_slits_at_all_inner_edges() {
    for cell in CellType::ALL {
        let whole = mesh(cell);
        // As in a file of single precision.
        let points: Vec<[f64; 3]> = (0..whole.num_cells())
            .flat_map(|index| whole.cell_points(index))
            .enumerate()
            .map(|(k, [x, y, z])| [x + 1e-6 * (k as f64).sin(), y + 1e-6 * (k as f64).cos(), z])
            .collect();
        let nodes = (0..points.len() as i64).collect();
        let separate = Mesh::new(points, &[(cell, nodes)]).unwrap();
        let inner = if cell.is_triangle() { 17 + 12 } else { 17 };
        assert_eq!(separate.slits(Mesh::COINCIDENT).len(), inner, "{cell}");
        assert!(separate.slits(1e-9).is_empty());
    }
}

#[test]
fn three_cells_at_one_edge_have_three_slits() {
    // Three flaps around one edge, each with nodes of its own.
    let flap = |angle: f64| [[0.0, 0.0, 0.0], [angle.cos(), angle.sin(), 0.0], [0.0, 0.0, 1.0]];
    let points = [0.0, 2.0, 4.0].into_iter().flat_map(flap).collect();
    let mesh = Mesh::new(points, &[(CellType::Triangle, (0..9).collect())]).unwrap();
    let cells: Vec<[usize; 2]> = mesh.slits(Mesh::COINCIDENT).iter().map(|sides| sides.map(|side| side.cell)).collect();
    assert_eq!(cells, [[0, 1], [0, 2], [1, 2]]);
}

#[test]
fn sides_whose_nodes_do_not_match_have_no_slits() {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.5], [2.0, 0.0], [2.0, 1.0]];
    let cells = [(CellType::Quad, vec![0, 1, 2, 3]), (CellType::Triangle, vec![1, 5, 4, 4, 6, 2, 5, 6, 4])];
    let mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec(), &cells).unwrap();
    assert!(mesh.slits(Mesh::COINCIDENT).is_empty());
}
