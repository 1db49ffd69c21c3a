//! Nodes on the edge of a cell that does not have them.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic_mesh::{CellType, Mesh, rectangle_mesh};
use proptest::prelude::*;

/// Two rectangles side by side, with cells of different sizes.
fn side_by_side(gap: f64, sizes: [f64; 2]) -> Mesh {
    let parts = [
        rectangle_mesh([0.0, 0.0, 6.0, 6.0], sizes[0], CellType::Quad).unwrap(),
        rectangle_mesh([6.0 + gap, 0.0, 12.0, 6.0], sizes[1], CellType::Triangle).unwrap(),
    ];
    let shift = parts[0].num_nodes() as i64;
    let nodes =
        |part: &Mesh, shift: i64| part.cells().flat_map(|c| c.nodes.to_vec()).map(|n| i64::from(n) + shift).collect();
    let cells = [(CellType::Quad, nodes(&parts[0], 0)), (CellType::Triangle, nodes(&parts[1], shift))];
    Mesh::new([parts[0].points(), parts[1].points()].concat(), &cells).unwrap()
}

proptest! {
    #[test]
    fn nodes_between_those_of_the_other_part_are_found_in_any_position(angle in -3.0_f64..3.0, scale in 1e-2_f64..1e2) {
        let (sin, cos) = angle.sin_cos();
        let rotation = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let place = |mesh: &Mesh| mesh.scaled(scale).unwrap().rotated(rotation, [3.0, 1.0, 0.0]).unwrap();
        // Nodes at 2 and 4 on one side, at 3 on the other.
        let mesh = side_by_side(0.0, [2.0, 3.0]);
        let hanging = place(&mesh).hanging_nodes(1e-4);
        let heights: Vec<f64> = hanging.iter().map(|&node| mesh.points()[node as usize][1]).collect();
        prop_assert_eq!(heights, [2.0, 4.0, 3.0]);
        prop_assert_eq!(place(&side_by_side(0.0, [2.0, 2.0])).hanging_nodes(1e-4), [0; 0]);
        prop_assert_eq!(place(&side_by_side(0.01, [2.0, 3.0])).hanging_nodes(1e-4), [0; 0]);
    }
}

#[test]
fn conforming_meshes_have_no_hanging_nodes() {
    for cell in CellType::ALL {
        assert_eq!(rectangle_mesh([0.0, 0.0, 6.0, 4.0], 1.0, cell).unwrap().hanging_nodes(1e-4), [0; 0]);
    }
}
