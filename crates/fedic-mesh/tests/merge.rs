//! Nodes at one place: found and joined.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic_mesh::{CellType, Mesh, MeshError, MeshSet, rectangle_mesh};
use proptest::prelude::*;

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

/// The cells of a mesh with nodes of their own, each moved by the next of `moves`.
fn own_nodes(mesh: &Mesh, mut moves: impl FnMut() -> f64) -> Mesh {
    let cell_type = mesh.cell(0).cell_type;
    let mut points = Vec::new();
    for index in 0..mesh.num_cells() {
        points.extend(mesh.cell_points(index).into_iter().map(|p| [p[0] + moves(), p[1] + moves(), p[2]]));
    }
    let nodes = (0..points.len() as i64).collect();
    Mesh::new(points, &[(cell_type, nodes)]).unwrap()
}

fn mesh(cell: CellType) -> Mesh {
    rectangle_mesh([3.0, -2.0, 9.0, 2.0], 1.0, cell).unwrap()
}

proptest! {
    #[test]
    fn joining_the_nodes_of_separate_cells_gives_the_mesh_back(cell in any_cell(), seed in 0_u64..1000) {
        let whole = mesh(cell);
        let mut state = seed;
        let separate = own_nodes(&whole, || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            1e-7 * ((state >> 40) as f64 / f64::from(1 << 24) - 0.5)
        });
        prop_assert_eq!(whole.coincident_nodes(1e-4), [[0; 2]; 0]);
        prop_assert_eq!(separate.coincident_nodes(1e-4).len(), separate.num_nodes() - whole.num_nodes());
        let joined = separate.merge_nodes(1e-5).unwrap();
        prop_assert_eq!(joined.num_nodes(), whole.num_nodes());
        prop_assert_eq!(joined.coincident_nodes(1e-4), [[0; 2]; 0]);
        for index in 0..whole.num_cells() {
            prop_assert_eq!(joined.cell(index).cell_type, cell);
            for (a, b) in joined.cell_points(index).into_iter().zip(whole.cell_points(index)) {
                prop_assert!((0..3).all(|d| (a[d] - b[d]).abs() < 2e-7));
            }
        }
        prop_assert_eq!(joined.merge_nodes(1e-5).unwrap(), joined);
    }

    #[test]
    fn merging_keeps_the_pairs_apart_that_are_further_than_the_tolerance(gap in 1e-6_f64..1e-2, scale in 1e-3_f64..1e3) {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0 + gap, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0 + gap, 1.0]];
        let points = points.map(|[x, y]| [scale * x, scale * y, 0.0]).to_vec();
        let mesh = Mesh::new(points, &[(CellType::Quad, (0..8).collect())]).unwrap();
        prop_assert_eq!(mesh.merge_nodes(0.99 * gap * scale).unwrap().num_nodes(), 8);
        prop_assert_eq!(mesh.merge_nodes(1.01 * gap * scale).unwrap().num_nodes(), 6);
        prop_assert_eq!(mesh.coincident_nodes(0.99 * gap), [[0; 2]; 0]);
        prop_assert_eq!(mesh.coincident_nodes(1.01 * gap), [[1, 4], [2, 7]]);
    }
}

#[test]
fn sets_follow_the_joined_nodes() {
    let separate = own_nodes(&mesh(CellType::Quad), || 0.0);
    let sets = [("pair", vec![1, 4], vec![1]), ("alone", vec![2], vec![])];
    let separate =
        separate.with_sets(sets.map(|(name, nodes, cells)| (name.to_owned(), MeshSet { nodes, cells }))).unwrap();
    let joined = separate.merge_nodes(0.0).unwrap();
    assert_eq!(joined.sets()["pair"], MeshSet { nodes: vec![1], cells: vec![1] });
    assert_eq!(joined.sets()["alone"].nodes, [2]);
    assert_eq!(joined.num_cells(), separate.num_cells());
}

#[test]
fn nodes_of_no_cell_are_kept_and_not_reported() {
    let whole = mesh(CellType::Triangle);
    let mut points = whole.points().to_vec();
    points.extend([points[0], [100.0, 0.0, 0.0]]);
    let nodes = whole.cells().flat_map(|cell| cell.nodes.to_vec()).map(i64::from).collect();
    let mesh = Mesh::new(points, &[(CellType::Triangle, nodes)]).unwrap();
    assert_eq!(mesh.coincident_nodes(1e-4), [[0; 2]; 0]);
    assert_eq!(mesh.merge_nodes(1e-9).unwrap().num_nodes(), whole.num_nodes() + 1);
}

#[test]
fn a_quad_that_loses_an_edge_is_kept_and_one_that_loses_its_area_is_refused() {
    let points = [[0.0, 0.0], [10.0, 0.0], [10.0, 0.1], [0.0, 5.0], [20.0, 0.0], [20.0, 5.0]];
    let points: Vec<[f64; 3]> = points.map(|[x, y]| [x, y, 0.0]).to_vec();
    let mesh = Mesh::new(points, &[(CellType::Quad, vec![0, 1, 2, 3, 1, 4, 5, 2])]).unwrap();
    let joined = mesh.merge_nodes(0.2).unwrap();
    assert_eq!(joined.cell(0).nodes, [0, 1, 1, 2]);
    assert_eq!(joined.collapsed_as_triangles().cell(0).cell_type, CellType::Triangle);
    let error = mesh.merge_nodes(5.5).unwrap_err();
    assert_eq!(error, MeshError::CollapsedCells { cells: vec![0, 1], tolerance: 5.5 });
    assert_eq!(
        error.to_string(),
        "nodes up to 5.5 apart are joined, which collapses cells 0, 1; choose a tolerance below the shortest edge"
    );
}

#[test]
fn a_tolerance_that_is_negative_or_not_finite_is_refused() {
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        let error = mesh(CellType::Quad).merge_nodes(tolerance).unwrap_err();
        assert!(matches!(error, MeshError::InvalidTolerance { .. }), "{error}");
    }
}
