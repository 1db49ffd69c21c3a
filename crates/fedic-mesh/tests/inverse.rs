//! The inverse of the isoparametric map, and the search for the cell of a point.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Random, cell_nodes, jittered_mesh, types_with_edge_intervals};
use fedic_mesh::{CellType, Locator, Mesh, inverse_map, map};
use proptest::prelude::*;

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

/// A jittered mesh of all linear or all quadratic types, with curved inner edges if quadratic, and its outline.
fn mixed_mesh(random: &mut Random, size: f64) -> (Mesh, Vec<[f64; 2]>) {
    // A curved edge between a linear and a quadratic cell would leave a gap: one family per mesh.
    let quadratic = random.index(2) == 0;
    let types = types_with_edge_intervals(if quadratic { 2 } else { 1 });
    let (mesh, outline) = jittered_mesh(random, [6, 5], &types, size, 0.15);
    let mut points = mesh.points().to_vec();
    for point in points.iter_mut().skip(7 * 6) {
        let place = [point[0], point[1]];
        if common::depth_in_convex(&outline, place) > 1e-6 * size {
            point[0] += random.between(-0.02, 0.02) * size;
            point[1] += random.between(-0.02, 0.02) * size;
        }
    }
    let blocks: Vec<_> =
        mesh.cells().map(|cell| (cell.cell_type, cell.nodes.iter().map(|&n| i64::from(n)).collect())).collect();
    (Mesh::new(points, &blocks).unwrap(), outline)
}

proptest! {
    #[test]
    fn the_inverse_undoes_the_map(cell in any_cell(), seed: u64, size in 0.01..100.0) {
        let mut random = Random::new(seed);
        let nodes = random.curved_cell(cell, size, 0.05);
        let at = random.reference_point(cell);
        let found = inverse_map(cell, &nodes, map(cell, &nodes, at)).unwrap();
        // What the coordinates of the point, up to 1000, lose by rounding in a cell of this size.
        let rounding = 1e-12_f64.max(2e-12 / size);
        for d in 0..2 {
            prop_assert!((found[d] - at[d]).abs() < rounding, "{:?} {:?} {:e}", found, at, found[d] - at[d]);
        }
    }

    #[test]
    fn a_point_in_a_cell_is_found_there(seed: u64, size in 0.01..100.0) {
        let mut random = Random::new(seed);
        let (mesh, _) = mixed_mesh(&mut random, size);
        let locator = Locator::new(&mesh);
        for _ in 0..50 {
            let cell = random.index(mesh.num_cells());
            let cell_type = mesh.cell(cell).cell_type;
            let centre = cell_type.reference_centre();
            let at = random.reference_point(cell_type);
            let at = [0, 1].map(|d| centre[d] + (1.0 - 1e-6) * (at[d] - centre[d]));
            let found = locator.find(map(cell_type, &cell_nodes(&mesh, cell), at));
            prop_assert!(found.is_some(), "{cell_type} at {at:?}");
            let (found_cell, found_at) = found.unwrap();
            prop_assert_eq!(found_cell, cell);
            let error = (found_at[0] - at[0]).abs().max((found_at[1] - at[1]).abs());
            prop_assert!(error < 1e-12_f64.max(1e-12 / size), "{error:e}");
        }
    }

    #[test]
    fn nodes_on_shared_edges_go_to_the_first_of_their_cells(seed: u64, size in 0.1..100.0) {
        let (mesh, _) = mixed_mesh(&mut Random::new(seed), size);
        let locator = Locator::new(&mesh);
        for (node, point) in mesh.points().iter().enumerate() {
            let first = (0..mesh.num_cells()).find(|&c| mesh.cell(c).nodes.contains(&(node as u32))).unwrap();
            let (cell, at) = locator.find([point[0], point[1]]).unwrap();
            prop_assert_eq!(cell, first, "node {}", node);
            let local = mesh.cell(cell).nodes.iter().position(|&n| n == node as u32).unwrap();
            let exact = mesh.cell(cell).cell_type.reference_nodes()[local];
            let error = (at[0] - exact[0]).abs().max((at[1] - exact[1]).abs());
            prop_assert!(error < 1e-12_f64.max(1e-12 / size), "{error:e}");
        }
    }

    #[test]
    fn a_point_outside_has_no_cell(seed: u64, size in 0.01..100.0, x in -0.5..1.5, y in -0.5..1.5) {
        let (mesh, outline) = mixed_mesh(&mut Random::new(seed), size);
        let locator = Locator::new(&mesh);
        let [a, b, _, d] = [0, 1, 2, 3].map(|k| outline[k]);
        let point = [0, 1].map(|c| a[c] + x * (b[c] - a[c]) + y * (d[c] - a[c]));
        prop_assume!([x, y].into_iter().all(|c: f64| c.abs() > 1e-6 && (c - 1.0).abs() > 1e-6));
        let inside = [x, y].iter().all(|c: &f64| (0.0..1.0).contains(c));
        prop_assert_eq!(locator.find(point).is_some(), inside);
    }
}

#[test]
fn a_point_that_is_not_finite_has_no_cell() {
    let (mesh, _) = mixed_mesh(&mut Random::new(1), 10.0);
    let locator = Locator::new(&mesh);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(locator.find([bad, 0.0]), None);
        assert_eq!(locator.find([0.0, bad]), None);
    }
    assert_eq!(locator.find([1e300, -1e300]), None);
}

#[test]
fn a_point_that_no_reference_point_is_taken_to_has_no_inverse() {
    let trapezium = [[-2.0, 0.0], [2.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
    // Its sides meet at (0, 2): the whole line eta = 3 is taken there, nothing to the right or left of it.
    assert_eq!(inverse_map(CellType::Quad, &trapezium, [1.0, 2.0]), None);
    assert!(inverse_map(CellType::Quad, &trapezium, [1.0, 1.9]).is_some());
    assert_eq!(inverse_map(CellType::Quad, &trapezium, [f64::NAN, 0.0]), None);
}
