//! Entries of the inverse on the pattern of the matrix, compared with dense inverses and with solutions.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Mesh, assembled, dense_solution, hexahedra, in_pool, perforated_grid, quads, random_mesh};
use fedic_sparse::{Cholesky, Factor, Pattern, SpdFactor, SpdSolver, SymmetricMatrix};
use proptest::prelude::*;

/// Columns of the identity matrix, one after the other.
fn identity(n: usize) -> Vec<f64> {
    (0..n * n).map(|k| f64::from(u8::from(k / n == k % n))).collect()
}

/// Largest difference of the selected entries from those of the dense inverse, relative to the largest entry.
fn error(pattern: &Pattern, matrix: &SymmetricMatrix, factor: &Factor) -> f64 {
    let found = factor.selected_inverse().unwrap();
    let n = pattern.num_dofs();
    let dense = identity(n).chunks_exact(n).flat_map(|unit| matrix.multiply(pattern, unit)).collect();
    let exact = dense_solution(dense, identity(n));
    let (starts, rows) = pattern.lower_triangle();
    assert_eq!(found.values().len(), rows.len());
    let (mut difference, mut largest) = (0.0_f64, 0.0_f64);
    for column in 0..n {
        for at in starts[column]..starts[column + 1] {
            let exact = exact[column * n + rows[at]];
            difference = difference.max((found.values()[at] - exact).abs());
            largest = largest.max(exact.abs());
        }
    }
    difference / largest
}

/// Both meshes, not connected.
fn together(mut first: Mesh, second: Mesh) -> Mesh {
    let offset = first.num_nodes() as u32;
    first.points.extend(second.points);
    first.cells.extend(second.cells.into_iter().map(|cell| cell.into_iter().map(|node| node + offset).collect()));
    first
}

fn check_against_dense_inverse(mesh: &Mesh, block: usize) {
    let pattern = mesh.pattern(block);
    let matrix = assembled(&pattern, 0.5);
    let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
    let double = error(&pattern, &matrix, &cholesky.factorize(&matrix).unwrap());
    assert!(double < 1e-12, "{} nodes, {block} components: {double}", mesh.num_nodes());
    let compact = cholesky.factorize_compact(&matrix).unwrap();
    assert!(compact.is_compact());
    let single = error(&pattern, &matrix, &compact);
    assert!(single < 1e-6, "{} nodes, {block} components, single precision: {single}", mesh.num_nodes());
}

#[test]
fn entries_equal_those_of_the_dense_inverse() {
    for block in [1, 2, 3] {
        check_against_dense_inverse(&quads(9, 7), block);
        check_against_dense_inverse(&hexahedra(3), block);
    }
}

#[test]
fn a_single_node_has_the_inverse_of_its_block() {
    for block in [1, 2, 3] {
        check_against_dense_inverse(&Mesh { points: vec![[0.0; 3]], cells: vec![vec![0]] }, block);
    }
}

#[test]
fn parts_that_are_not_connected_are_inverted_each() {
    let node = || Mesh { points: vec![[-5.0, 3.0, 0.0]], cells: vec![vec![0]] };
    let parts = together(together(quads(4, 3), node()), together(quads(2, 6), node()));
    for block in [1, 2, 3] {
        check_against_dense_inverse(&parts, block);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_mesh_and_block_size_is_inverted(nodes in 1_usize..50, block in 1_usize..5, seed: u64, flat: bool) {
        let mesh = random_mesh(nodes, seed, flat);
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        prop_assert!(error(&pattern, &matrix, &cholesky.factorize(&matrix).unwrap()) < 1e-11);
        prop_assert!(error(&pattern, &matrix, &cholesky.factorize_compact(&matrix).unwrap()) < 1e-5);
    }
}

/// Meshes large enough for several tasks and for fronts divided into tiles.
fn large_meshes() -> [(Mesh, usize); 4] {
    [
        (perforated_grid(170), 2),
        (perforated_grid(85), 3),
        (hexahedra(10), 3),
        (together(quads(90, 70), quads(60, 120)), 2),
    ]
    .map(|(mesh, block)| (mesh.with_node_cells(), block))
}

#[test]
fn entries_of_large_meshes_equal_solutions_with_unit_loads() {
    for (mesh, block) in large_meshes() {
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        let (starts, rows) = pattern.lower_triangle();
        let n = pattern.num_dofs();
        let factors = [cholesky.factorize(&matrix).unwrap(), cholesky.factorize_compact(&matrix).unwrap()];
        for (factor, tolerance) in factors.iter().zip([1e-12, 1e-6]) {
            let found = factor.selected_inverse().unwrap();
            // Columns all over the order of elimination, and those eliminated last.
            let order = cholesky.elimination_order();
            let nodes = order.iter().step_by(order.len() / 12).chain(&order[order.len() - 4..]);
            for column in nodes.flat_map(|&node| (0..block).map(move |c| node as usize * block + c)) {
                let mut x = vec![0.0; n];
                x[column] = 1.0;
                factors[0].solve(&mut x);
                for at in starts[column]..starts[column + 1] {
                    let difference = (found.values()[at] - x[rows[at]]).abs();
                    assert!(difference < tolerance * x[column].abs(), "{n} unknowns, column {column}: {difference}");
                }
            }
        }
    }
}

#[test]
fn entries_are_bit_identical_on_any_number_of_threads() {
    for (mesh, block) in large_meshes() {
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        for factor in [cholesky.factorize(&matrix).unwrap(), cholesky.factorize_compact(&matrix).unwrap()] {
            let bits = |threads: usize| {
                let found = in_pool(threads, || factor.selected_inverse().unwrap());
                found.values().iter().map(|value| value.to_bits()).collect::<Vec<u64>>()
            };
            let one = bits(1);
            for threads in [2, 3, 4] {
                assert!(bits(threads) == one, "{block} components, {threads} threads");
            }
        }
    }
}
