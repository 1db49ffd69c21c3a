//! Validation and orientation of plane meshes, and the texts of the errors.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Random, cell_nodes, clockwise, determinant, straight_cell, types_with_edge_intervals};
use fedic_mesh::{CellType, Mesh, MeshError, jacobian};
use proptest::prelude::*;

/// A mesh of one cell.
fn one(cell: CellType, nodes: &[[f64; 2]]) -> Result<Mesh, MeshError> {
    Mesh::new(in_space(nodes), &[(cell, (0..nodes.len() as i64).collect())])
}

fn in_space(nodes: &[[f64; 2]]) -> Vec<[f64; 3]> {
    nodes.iter().map(|p| [p[0], p[1], 0.0]).collect()
}

fn refused(result: Result<Mesh, MeshError>, error: MeshError, text: &str) {
    assert_eq!(result, Err(error.clone()));
    assert_eq!(error.to_string(), text);
}

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const FOLDED: &str = "cell 0 has zero area or a Jacobian that changes sign (inverted, folded or nodes in the wrong order); \
                      fix the mesh there";

fn degenerate(cells: &[usize]) -> MeshError {
    MeshError::DegenerateCells { cells: cells.to_vec() }
}

fn names(conjunction: &str) -> String {
    let names = CellType::ALL.map(CellType::name);
    let [first @ .., last] = &names;
    format!("{} {conjunction} {last}", first.join(", "))
}

#[test]
fn a_mesh_without_cells_is_refused() {
    let text = format!("the mesh has no surface cells; give at least one cell of type {}", names("or"));
    refused(Mesh::new(in_space(&SQUARE), &[]), MeshError::Empty, &text);
    refused(Mesh::new(vec![], &[(CellType::Quad, vec![])]), MeshError::Empty, &text);
}

#[test]
fn cell_types_parse_from_their_names() {
    for cell in CellType::ALL {
        assert_eq!(cell.name().parse(), Ok(cell));
        assert_eq!(cell.to_string(), cell.name());
    }
    let error = "tetra".parse::<CellType>().unwrap_err();
    assert_eq!(error, MeshError::UnknownCellType { name: "tetra".to_owned() });
    assert_eq!(error.to_string(), format!("unknown cell type \"tetra\"; the cell types are {}", names("and")));
}

#[test]
fn an_incomplete_cell_is_refused() {
    let found = MeshError::WrongNodeCount { cell_type: CellType::Quad8, found: 9 };
    let result = Mesh::new(in_space(&SQUARE), &[(CellType::Quad8, vec![0; 9])]);
    refused(result, found, "cells of type quad8 need 8 nodes each, but 9 were given");
}

#[test]
fn a_coordinate_that_is_not_finite_is_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        for d in 0..3 {
            let mut points = in_space(&SQUARE);
            points[2][d] = bad;
            let text = "node 2 has a coordinate that is not finite; check the mesh file";
            refused(
                Mesh::new(points, &[(CellType::Quad, vec![0, 1, 2, 3])]),
                MeshError::NonFinitePoint { node: 2 },
                text,
            );
        }
    }
}

#[test]
fn a_node_that_does_not_exist_is_refused() {
    for node in [-1, 4, i64::from(u32::MAX) + 1, i64::MIN] {
        // Cells are counted over the blocks.
        let blocks = [(CellType::Quad, vec![0, 1, 2, 3]), (CellType::Triangle, vec![0, 1, 2, 0, node, 2])];
        refused(
            Mesh::new(in_space(&SQUARE), &blocks),
            MeshError::NodeOutOfRange { cell: 2, cell_type: CellType::Triangle, node, num_points: 4 },
            &format!("cell 2 (triangle) refers to node {node}, but the nodes are 0 to 3"),
        );
    }
}

#[test]
fn all_degenerate_cells_are_named() {
    let mut cells = vec![0, 1, 2, 3];
    cells.extend([0, 1, 1, 0].repeat(10));
    cells.extend([0, 1, 2, 3]);
    refused(
        Mesh::new(in_space(&SQUARE), &[(CellType::Quad, cells)]),
        degenerate(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]),
        "cells 1, 2, 3, 4, 5, 6, 7, 8 and 2 more have zero area or a Jacobian that changes sign (inverted, folded or nodes \
         in the wrong order); fix the mesh there",
    );
}

#[test]
fn folded_and_flat_cells_are_refused() {
    let quads = [
        ("bow-tie", [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]),
        ("reflex corner", [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]]),
        ("reflex first corner", [[1.0, 1.0], [0.0, 4.0], [0.0, 0.0], [4.0, 0.0]]),
        ("one line", [[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0]]),
        ("one point", [[5.0, 5.0]; 4]),
        ("collapsed diagonal", [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 1.0]]),
    ];
    for (name, corners) in quads {
        for scale in [1e-6, 1.0, 1e6] {
            let corners = corners.map(|p| p.map(|c| c * scale));
            for cell in CellType::ALL.into_iter().filter(|cell| !cell.is_triangle()) {
                let result = one(cell, &straight_cell(cell, &corners));
                assert_eq!(result, Err(degenerate(&[0])), "{name} {cell}");
                assert_eq!(result.unwrap_err().to_string(), FOLDED);
            }
        }
    }
    let line = [[0.0, 0.0], [2.0, 1.0], [4.0, 2.0]];
    for cell in CellType::ALL.into_iter().filter(|cell| cell.is_triangle()) {
        refused(one(cell, &straight_cell(cell, &line)), degenerate(&[0]), FOLDED);
    }
}

#[test]
fn a_middle_node_too_near_a_corner_is_refused() {
    for cell in types_with_edge_intervals(2) {
        let corners = &SQUARE[..cell.num_corners()];
        for (along, valid) in [(0.26, true), (0.24, false), (0.74, true), (0.76, false)] {
            let mut nodes = straight_cell(cell, corners);
            nodes[cell.num_corners()] = [along, 0.0];
            assert_eq!(one(cell, &nodes).is_ok(), valid, "{cell} with its first middle node at {along}");
        }
    }
}

proptest! {
    #[test]
    fn clockwise_cells_are_reversed(
        cell in proptest::sample::select(CellType::ALL.as_slice()),
        seed: u64,
        size in 1e-3..1e3,
    ) {
        let nodes = Random::new(seed).curved_cell(cell, size, 0.04);
        let straight = one(cell, &nodes).unwrap();
        prop_assert_eq!(straight.flipped(), &[] as &[usize]);
        let turned = one(cell, &clockwise(cell, &nodes)).unwrap();
        prop_assert_eq!(turned.flipped(), [0]);
        prop_assert_eq!(cell_nodes(&turned, 0), cell_nodes(&straight, 0));
        for &at in cell.reference_nodes() {
            prop_assert!(determinant(jacobian(cell, &cell_nodes(&turned, 0), at)) > 0.0);
        }
    }
}

#[test]
fn unused_nodes_are_kept_until_the_mesh_is_compacted() {
    // Nodes 0, 3 and 6 belong to no cell; cell 1 is given clockwise.
    let points: Vec<[f64; 3]> =
        [[9.0, 9.0], [0.0, 0.0], [1.0, 0.0], [-9.0, 0.0], [1.0, 1.0], [0.0, 1.0], [7.0, 7.0], [2.0, 0.0]]
            .iter()
            .enumerate()
            .map(|(k, p)| [p[0], p[1], k as f64])
            .collect();
    let blocks = [(CellType::Quad, vec![1, 2, 4, 5]), (CellType::Triangle, vec![2, 4, 7])];
    let mesh = Mesh::new(points.clone(), &blocks).unwrap();
    assert_eq!((mesh.num_nodes(), mesh.num_cells()), (8, 2));
    assert_eq!(mesh.points(), points);
    assert_eq!(mesh.flipped(), [1]);
    assert_eq!(mesh.used_nodes(), [false, true, true, false, true, true, false, true]);

    let (compact, kept) = mesh.compact();
    assert_eq!(kept, [1, 2, 4, 5, 7]);
    assert_eq!(compact.points(), [1, 2, 4, 5, 7].map(|n| points[n]));
    assert_eq!(compact.cells().map(|cell| cell.cell_type).collect::<Vec<_>>(), [CellType::Quad, CellType::Triangle]);
    assert_eq!(compact.cell(0).nodes, [0, 1, 2, 3]);
    assert_eq!(compact.cell(1).nodes, [1, 4, 2]);
    for cell in 0..2 {
        assert_eq!(compact.cell_points(cell), mesh.cell_points(cell));
    }
    assert_eq!(compact.flipped(), [1]);
    assert!(compact.used_nodes().into_iter().all(|used| used));
}
