//! Regular meshes: numbers of cells and nodes, coverage and connectivity.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashMap;

use common::{cell_nodes, shoelace};
use fedic_mesh::{CellType, Mesh, MeshError, rectangle_mesh};

/// How many cells share each edge, an edge being its nodes in ascending order.
fn edges(mesh: &Mesh) -> HashMap<Vec<u32>, usize> {
    let mut edges = HashMap::new();
    for cell in mesh.cells() {
        let outline = cell.cell_type.outline();
        let per_edge = outline.len() / cell.cell_type.num_corners();
        for first in (0..outline.len()).step_by(per_edge) {
            let mut edge: Vec<u32> =
                (first..=first + per_edge).map(|k| cell.nodes[outline[k % outline.len()]]).collect();
            edge.sort_unstable();
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

#[test]
fn cells_fill_the_rectangle_and_share_their_edges() {
    let (columns, rows) = (7, 4);
    let [x0, y0, x1, y1] = [-3.5, 2.25, 31.5, 22.25];
    // Nodes: corners, edges' middles, centres.
    let (corners, centres) = ((columns + 1) * (rows + 1), columns * rows);
    let straight_edges = columns * (rows + 1) + rows * (columns + 1);
    for cell in CellType::ALL {
        let (cells, diagonals) = if cell.is_triangle() { (2 * centres, centres) } else { (centres, 0) };
        let inside_edges = (straight_edges + diagonals) * (cell.edge_intervals() - 1);
        let inside_cells = cells * (cell.num_nodes() - cell.outline().len());
        let nodes = corners + inside_edges + inside_cells;
        let mesh = rectangle_mesh([x0, y0, x1, y1], 5.0, cell).unwrap();
        assert_eq!((mesh.num_cells(), mesh.num_nodes()), (cells, nodes), "{cell}");
        assert!(mesh.used_nodes().into_iter().all(|used| used) && mesh.flipped().is_empty(), "{cell}");
        assert!(mesh.cells().all(|c| c.cell_type == cell));

        let of_cell = if cell.is_triangle() { 12.5 } else { 25.0 };
        for index in 0..cells {
            let outline: Vec<_> = cell.outline().iter().map(|&node| cell_nodes(&mesh, index)[node]).collect();
            assert!((shoelace(&outline) - of_cell).abs() < 1e-12, "{cell} {index}");
        }

        let edges = edges(&mesh);
        let on_boundary = |edge: &[u32]| {
            let side = |d: usize, at: f64| edge.iter().all(|&n| mesh.points()[n as usize][d] == at);
            side(0, x0) || side(0, x1) || side(1, y0) || side(1, y1)
        };
        assert!(edges.iter().all(|(edge, &shared)| shared == if on_boundary(edge) { 1 } else { 2 }), "{cell}");
        assert_eq!(edges.len(), straight_edges + diagonals, "{cell}");
        assert_eq!(edges.keys().filter(|edge| on_boundary(edge)).count(), 2 * (columns + rows), "{cell}");
    }
}

#[test]
fn diagonals_of_triangles_alternate() {
    let mesh = rectangle_mesh([0.0, 0.0, 5.0, 5.0], 1.0, CellType::Triangle).unwrap();
    let mut triangles = [0; 36];
    mesh.cells().flat_map(|cell| cell.nodes).for_each(|&node| triangles[node as usize] += 1);
    for (i, j) in (1..5).flat_map(|j| (1..5).map(move |i| (i, j))) {
        assert_eq!(triangles[6 * j + i], if (i + j) % 2 == 0 { 8 } else { 4 }, "node ({i}, {j})");
    }
}

#[test]
fn the_size_is_rounded_to_fit() {
    let mesh = |size| rectangle_mesh([0.0, 0.0, 10.0, 4.0], size, CellType::Quad).unwrap();
    assert_eq!(mesh(3.0).num_cells(), 3);
    assert_eq!(mesh(2.6).num_cells(), 4 * 2);
    assert_eq!(mesh(1e9).num_cells(), 1);
}

#[test]
fn bad_bounds_and_sizes_are_refused() {
    for (bounds, size, shown) in [
        ([0.0, 0.0, 0.0, 1.0], 1.0, "[0.0, 0.0, 0.0, 1.0] and 1"),
        ([0.0, 2.0, 1.0, 1.0], 1.0, "[0.0, 2.0, 1.0, 1.0] and 1"),
        ([0.0, 0.0, f64::INFINITY, 1.0], 1.0, "[0.0, 0.0, inf, 1.0] and 1"),
        ([0.0, 0.0, 1.0, 1.0], 0.0, "[0.0, 0.0, 1.0, 1.0] and 0"),
        ([0.0, 0.0, 1.0, 1.0], -2.5, "[0.0, 0.0, 1.0, 1.0] and -2.5"),
        ([0.0, 0.0, 1.0, 1.0], f64::NAN, "[0.0, 0.0, 1.0, 1.0] and NaN"),
    ] {
        let error = rectangle_mesh(bounds, size, CellType::Quad).unwrap_err();
        assert!(matches!(error, MeshError::InvalidRectangle { .. }));
        let expected =
            "rectangle_mesh needs finite bounds (x0, y0, x1, y1) with x0 < x1 and y0 < y1 and a positive size; got";
        assert_eq!(error.to_string(), format!("{expected} {shown}"));
    }
    let error = rectangle_mesh([0.0, 0.0, 1.0, 1.0], 1e-5, CellType::Quad).unwrap_err();
    assert_eq!(error, MeshError::TooLarge { cells: 1e10 });
    assert_eq!(error.to_string(), "a mesh of 1.000e10 cells is too large; choose a larger element size");
    // Not even counted: the numbers overflow.
    let error = rectangle_mesh([-1e308, 0.0, 1e308, 1.0], 1e-300, CellType::Quad).unwrap_err();
    assert!(matches!(error, MeshError::TooLarge { .. }), "{error:?}");
}
