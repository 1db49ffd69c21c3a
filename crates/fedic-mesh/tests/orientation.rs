//! Orientation of the cells of surfaces in space, degenerate cells there, transformations and sets.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Random, clockwise, straight_cell};
use fedic_mesh::{CellType, Mesh, MeshError, MeshSet, rectangle_mesh, surface_gradients};
use proptest::prelude::*;

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

/// A mesh on points `place(x, y)` of a rectangle, the cells of some indices listed in the opposite direction.
fn surface(cell: CellType, reversed: impl Fn(usize) -> bool, place: impl Fn(f64, f64) -> [f64; 3]) -> Mesh {
    let flat = rectangle_mesh([0.0, 0.0, 6.0, 2.0], 0.5, cell).unwrap();
    let points = flat.points().iter().map(|p| place(p[0], p[1])).collect();
    let connectivity = flat.cells().enumerate().flat_map(|(index, cell)| {
        let nodes: Vec<i64> = cell.nodes.iter().map(|&n| i64::from(n)).collect();
        if reversed(index) { clockwise(cell.cell_type, &nodes) } else { nodes }
    });
    Mesh::new(points, &[(cell, connectivity.collect())]).unwrap()
}

fn normals(mesh: &Mesh) -> impl Iterator<Item = [f64; 3]> {
    mesh.cells().enumerate().map(|(index, cell)| {
        surface_gradients(cell.cell_type, &mesh.cell_points(index), cell.cell_type.reference_centre()).axes[2]
    })
}

fn cylinder(x: f64, y: f64) -> [f64; 3] {
    [x.cos(), x.sin(), y]
}

proptest! {
    #[test]
    fn neighbours_on_a_vertical_cylinder_follow_the_first_cell(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let choice: Vec<bool> = (0..200).map(|_| random.index(2) == 0).collect();
        let mesh = surface(cell, |index| choice[index], cylinder);
        let side = if choice[0] { -1.0 } else { 1.0 };
        for ([nx, ny, _], index) in normals(&mesh).zip(0..) {
            let points = mesh.cell_points(index);
            let [x, y] = [0, 1].map(|d| points.iter().map(|p| p[d]).sum::<f64>());
            prop_assert!(side * (nx * x + ny * y) > 0.0, "cell {index}");
        }
        let expected: Vec<usize> = (0..mesh.num_cells()).filter(|&index| choice[index] != choice[0]).collect();
        prop_assert_eq!(mesh.flipped(), expected);
    }

    #[test]
    fn a_surface_over_the_plane_is_counter_clockwise_from_above(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let choice: Vec<bool> = (0..200).map(|_| random.index(2) == 0).collect();
        let mesh = surface(cell, |index| choice[index], |x, y| [x, y, 0.3 * x * x - y]);
        prop_assert!(normals(&mesh).all(|n| n[2] > 0.0));
    }

    /// Most of an arch of 200 degrees faces upwards; its ends, which face downwards, agree with it.
    #[test]
    fn an_arch_beyond_its_vertical_tangents_has_one_orientation(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let choice: Vec<bool> = (0..200).map(|_| random.index(2) == 0).collect();
        let angle = |x: f64| (x / 6.0 - 0.5) * 200.0_f64.to_radians();
        let mesh = surface(cell, |index| choice[index], |x, y| [angle(x).sin(), y, angle(x).cos()]);
        for ([nx, _, nz], index) in normals(&mesh).zip(0..) {
            let points = mesh.cell_points(index);
            let [x, z] = [0, 2].map(|d| points.iter().map(|p| p[d]).sum::<f64>());
            prop_assert!(nx * x + nz * z > 0.0, "cell {index}");
        }
    }

    #[test]
    fn orienting_an_oriented_mesh_changes_nothing(cell in any_cell()) {
        for place in [cylinder as fn(f64, f64) -> [f64; 3], |x, y| [x, 0.0, y], |x, y| [x, y, x * y]] {
            let mesh = surface(cell, |index| index % 3 == 0, place);
            let cells = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&n| i64::from(n))).collect();
            let again = Mesh::new(mesh.points().to_vec(), &[(cell, cells)]).unwrap();
            prop_assert!(again.flipped().is_empty() && again.cells().eq(mesh.cells()));
        }
    }
}

#[test]
fn flat_and_folded_cells_in_space_are_refused() {
    let lift = |nodes: Vec<[f64; 2]>| -> Vec<[f64; 3]> { nodes.into_iter().map(|[x, y]| [x, 0.5 * x, y]).collect() };
    for cell in CellType::ALL {
        let corners: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let all: Vec<i64> = (0..cell.num_nodes() as i64).collect();
        let make = |corners: &[[f64; 2]]| {
            let nodes = straight_cell(cell, &corners[..cell.num_corners()]);
            Mesh::new(lift(nodes), &[(cell, all.clone())]).map(|_| ())
        };
        assert_eq!(make(corners), Ok(()), "{cell}");
        let line: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0]];
        assert_eq!(make(line), Err(MeshError::DegenerateCells { cells: vec![0] }), "{cell}");
        if !cell.is_triangle() {
            let bow_tie: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
            assert_eq!(make(bow_tie), Err(MeshError::DegenerateCells { cells: vec![0] }), "{cell}");
        }
    }
}

#[test]
fn cells_that_meet_at_an_edge_of_three_are_oriented_on_their_own() {
    // A T of three vertical quads on the edge 0-1; the third is listed against the second.
    let points = vec![
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [-1.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
        [0.0, 1.0, 1.0],
    ];
    let mesh = Mesh::new(points, &[(CellType::Quad, vec![0, 2, 3, 1, 0, 1, 5, 4, 0, 1, 7, 6])]).unwrap();
    assert!(mesh.flipped().is_empty());
}

#[test]
fn a_moebius_strip_is_accepted() {
    let n = 16_i64;
    let points = (0..n).flat_map(|k| {
        let angle = std::f64::consts::TAU * k as f64 / n as f64;
        [-0.3, 0.3].map(|w| {
            let radius = 1.0 + w * (0.5 * angle).cos();
            [radius * angle.cos(), radius * angle.sin(), w * (0.5 * angle).sin()]
        })
    });
    let cells = (0..n).flat_map(|k| {
        let (a, b) = (2 * k, 2 * k + 1);
        if k + 1 < n { [a, a + 2, b + 2, b] } else { [a, 1, 0, b] }
    });
    assert!(Mesh::new(points.collect(), &[(CellType::Quad, cells.collect())]).is_ok());
}

#[test]
fn transformed_meshes_keep_their_sets_and_report_reversed_cells() {
    let sets = [("left".to_owned(), MeshSet { nodes: vec![3, 0, 3], cells: vec![1] })];
    let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad).unwrap().with_sets(sets).unwrap();
    assert_eq!(mesh.sets()["left"], MeshSet { nodes: vec![0, 3], cells: vec![1] });
    let over = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let turned = mesh.rotated(over, [0.0; 3]).unwrap();
    assert_eq!(turned.flipped(), [0, 1]);
    assert_eq!(turned.rotated(over, [0.0; 3]).unwrap(), mesh);
    for other in [turned, mesh.scaled(2.0).unwrap(), mesh.translated([1.0, 2.0, 3.0]).unwrap()] {
        assert_eq!(other.sets(), mesh.sets());
    }
    assert_eq!(mesh.scaled(0.0), Err(MeshError::InvalidScale { factor: 0.0 }));
    assert_eq!(mesh.scaled(1e308), Err(MeshError::NonFinitePoint { node: 2 }));
    assert_eq!(mesh.translated([f64::NAN, 0.0, 0.0]), Err(MeshError::NonFinitePoint { node: 0 }));
    assert_eq!(mesh.rotated([[2.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], [0.0; 3]), Err(MeshError::InvalidRotation));
}

#[test]
fn compacting_renumbers_the_sets() {
    let points = vec![[9.0, 9.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let set = MeshSet { nodes: vec![0, 1, 3], cells: vec![0] };
    let mesh = Mesh::new(points, &[(CellType::Triangle, vec![1, 2, 3])]).unwrap();
    let mesh = mesh.with_sets([("a".to_owned(), set)]).unwrap();
    assert_eq!(mesh.compact().0.sets()["a"], MeshSet { nodes: vec![0, 2], cells: vec![0] });
    let beyond = MeshSet { nodes: vec![4], cells: vec![] };
    let error = mesh.with_sets([("b".to_owned(), beyond)]).unwrap_err();
    assert_eq!(error.to_string(), "set \"b\" refers to node 4, but the mesh has 4 nodes");
}
