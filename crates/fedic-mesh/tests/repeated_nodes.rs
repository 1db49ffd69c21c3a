//! Quadrilaterals with a repeated node, and strongly distorted cells.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::straight_cell;
use fedic_mesh::{CellType, Mesh, MeshError, cell_areas};
use proptest::prelude::*;

const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 0.3], [0.4, 1.5]];

fn in_space(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points.iter().map(|p| [p[0], p[1], 0.0]).collect()
}

/// Nodes of a triangle listed as a quadrilateral, its edge `edge` collapsed, starting at corner `first` of the triangle.
fn collapsed(cell: CellType, edge: usize, first: usize) -> Vec<i64> {
    // Corners of the triangle at the corners of the quadrilateral.
    let mut corner = first;
    let corners: Vec<usize> = (0..4)
        .map(|k| {
            let here = corner % 3;
            if k != edge {
                corner += 1;
            }
            here
        })
        .collect();
    let mut nodes: Vec<i64> = corners.iter().map(|&c| c as i64).collect();
    if cell == CellType::Quad8 {
        // Nodes 3, 4, 5 of a triangle6 are halfway after its corners 0, 1, 2.
        nodes.extend((0..4).map(|k| if k == edge { corners[k] as i64 } else { 3 + corners[k] as i64 }));
    }
    nodes
}

#[test]
fn a_quad_with_an_edge_of_one_node_becomes_the_triangle() {
    for (quad, triangle) in [(CellType::Quad, CellType::Triangle), (CellType::Quad8, CellType::Triangle6)] {
        let points = in_space(&straight_cell(triangle, &TRIANGLE));
        for (edge, first) in (0..4).flat_map(|edge| (0..3).map(move |first| (edge, first))) {
            let nodes = collapsed(quad, edge, first);
            let mesh = Mesh::new(points.clone(), &[(quad, nodes.clone())]).unwrap();
            assert_eq!(mesh.cell(0).cell_type, quad);
            let measured = mesh.collapsed_as_triangles();
            assert_eq!(measured.cell(0).cell_type, triangle);
            let found: Vec<i64> = measured.cell(0).nodes.iter().map(|&n| i64::from(n)).collect();
            // The triangle's own nodes from some corner on.
            let turned = (0..3).any(|k| {
                let order: Vec<i64> = (0..triangle.num_nodes()).map(|a| (a / 3 * 3 + (a + k) % 3) as i64).collect();
                order == found
            });
            assert!(turned, "{nodes:?} became {found:?}");
        }
    }
}

#[test]
fn cells_keep_their_numbers_and_sets_when_quads_become_triangles() {
    let points = in_space(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]]);
    let mesh = Mesh::new(points, &[(CellType::Quad, vec![1, 4, 5, 5, 0, 1, 2, 3, 1, 1, 5, 2])]).unwrap();
    let measured = mesh.collapsed_as_triangles();
    let types: Vec<CellType> = measured.cells().map(|cell| cell.cell_type).collect();
    assert_eq!(types, [CellType::Triangle, CellType::Quad, CellType::Triangle]);
    assert_eq!(measured.cell(1).nodes, [0, 1, 2, 3]);
    assert_eq!(measured.cell(2).nodes, [1, 5, 2]);
    for (found, exact) in cell_areas(&measured).into_iter().zip(cell_areas(&mesh)) {
        assert!((found - exact).abs() < 1e-14);
    }
    assert_eq!(measured.collapsed_as_triangles(), measured);
}

#[test]
fn a_collapsed_cell_with_a_node_inside_is_refused() {
    let mut points = straight_cell(CellType::Triangle6, &TRIANGLE);
    points.push([0, 1].map(|d| 0.25 * (TRIANGLE[0][d] + TRIANGLE[1][d]) + 0.5 * TRIANGLE[2][d]));
    let error = Mesh::new(in_space(&points), &[(CellType::Quad9, vec![0, 1, 2, 2, 3, 4, 2, 5, 6])]).unwrap_err();
    assert_eq!(error, MeshError::RepeatedNodes { cells: vec![0] });
    assert!(
        error.to_string().starts_with("cell 0 lists a node more than once; a quad with two equal neighbouring corners")
    );
}

#[test]
fn distorted_cells_are_those_of_very_different_area_elements() {
    let trapezium = |top: f64| [[0.0, 0.0], [80.0, 0.0], [40.0 + 0.5 * top, 80.0], [40.0 - 0.5 * top, 80.0]];
    for (top, expected) in [(80.0, vec![]), (10.0, vec![]), (2.0, vec![0]), (0.0, vec![0])] {
        let mesh = Mesh::new(in_space(&trapezium(top)), &[(CellType::Quad, vec![0, 1, 2, 3])]).unwrap();
        assert_eq!(mesh.distorted_cells(Mesh::DISTORTED), expected, "{top}");
    }
    // A repeated node makes a triangle, which is not distorted.
    let mesh = Mesh::new(in_space(&TRIANGLE), &[(CellType::Quad, vec![0, 1, 2, 2])]).unwrap();
    assert_eq!(mesh.distorted_cells(Mesh::DISTORTED), [0; 0]);
}

proptest! {
    #[test]
    fn scaling_and_moving_a_cell_leaves_its_distortion(top in 0.1_f64..80.0, scale in 1e-3_f64..1e3, shift in -1e3_f64..1e3) {
        let corners = [[0.0, 0.0], [80.0, 0.0], [40.0 + 0.5 * top, 80.0], [40.0 - 0.5 * top, 80.0]];
        let mesh = Mesh::new(in_space(&corners), &[(CellType::Quad, vec![0, 1, 2, 3])]).unwrap();
        let moved = mesh.scaled(scale).unwrap().translated([shift, -shift, 0.0]).unwrap();
        prop_assume!((top / 80.0 - 0.1).abs() > 1e-6);
        prop_assert_eq!(moved.distorted_cells(0.1).is_empty(), top > 8.0);
        prop_assert_eq!(mesh.distorted_cells(0.1).is_empty(), top > 8.0);
    }
}
