//! Meshes large enough for parallel tasks and tiled fronts: bits on any number of threads, compact factors, fill.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Mesh, assembled, hexahedra, in_pool, perforated_grid, quads, solution_error};
use fedic_sparse::{Cholesky, SpdFactor, SpdSolver};

/// Large enough for several tasks and for fronts divided into tiles.
const SIDE: usize = 170;

#[test]
fn solutions_are_bit_identical_on_any_number_of_threads() {
    let cases = [(perforated_grid(SIDE), 2), (perforated_grid(SIDE / 2), 3), (hexahedra(10), 3)];
    for (mesh, block) in cases {
        let mesh = mesh.with_node_cells();
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let bits = |threads: usize| {
            in_pool(threads, || {
                let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
                let mut found = Vec::new();
                for factor in [cholesky.factorize(&matrix).unwrap(), cholesky.factorize_compact(&matrix).unwrap()] {
                    for num_sides in [1, 3] {
                        let mut x: Vec<f64> = (0..num_sides * pattern.num_dofs()).map(|k| (k as f64).cos()).collect();
                        let mut sequential = x.clone();
                        factor.solve(&mut x);
                        factor.solve_sequentially(&mut sequential);
                        let [x, sequential] =
                            [x, sequential].map(|x| x.into_iter().map(f64::to_bits).collect::<Vec<_>>());
                        assert!(x == sequential, "{block} components, {threads} threads: sequential solve differs");
                        found.extend(x);
                    }
                }
                found
            })
        };
        let one = bits(1);
        for threads in [2, 3, 4] {
            assert!(bits(threads) == one, "{block} components, {threads} threads");
        }
    }
}

#[test]
fn large_meshes_are_solved_in_double_and_single_precision() {
    for (mesh, block) in [(perforated_grid(SIDE), 2), (perforated_grid(SIDE / 2), 3), (hexahedra(10), 3)] {
        let mesh = mesh.with_node_cells();
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        let double = cholesky.factorize(&matrix).unwrap();
        let compact = cholesky.factorize_compact(&matrix).unwrap();
        assert!(solution_error(&double, &matrix, &pattern) < 1e-11);
        assert!(solution_error(&compact, &matrix, &pattern) < 1e-5);
        assert!(compact.is_compact() && !double.is_compact());
        assert_eq!(compact.num_entries(), double.num_entries());
    }
}

#[test]
fn an_ill_conditioned_matrix_is_stored_in_double_precision() {
    let mesh = perforated_grid(20).with_node_cells();
    let pattern = mesh.pattern(2);
    let matrix = assembled(&pattern, 1e-5);
    let factor = Cholesky::new(&pattern, &mesh.points).unwrap().factorize_compact(&matrix).unwrap();
    assert!(!factor.is_compact());
    assert!(solution_error(&factor, &matrix, &pattern) < 1e-9);
}

#[test]
fn the_fill_of_nested_dissection_grows_as_n_log_n() {
    // George (1973), for grids of `n` nodes: 31/8 n log2(n) entries and 829/84 n^1.5 multiplications. `work` counts both
    // triangles of the update matrices, so twice as many; merged supernodes add a few.
    for side in [64, 128, 256] {
        let mesh = quads(side - 1, side - 1);
        let pattern = mesh.pattern(1);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        let n = (side * side) as f64;
        let entries = cholesky.factorize(&assembled(&pattern, 0.5)).unwrap().num_entries() as f64;
        assert!(entries < 31.0 / 8.0 * n * n.log2(), "{side}: {entries}");
        let work = cholesky.work();
        assert!(work < 1.3 * 2.0 * 829.0 / 84.0 * n.powf(1.5), "{side}: {work}");
    }
}

#[test]
fn the_elimination_order_is_a_permutation_and_ends_with_a_separator() {
    let side = 33;
    let mesh = quads(side - 1, side - 1);
    let pattern = mesh.pattern(2);
    let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
    let order = cholesky.elimination_order();
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    assert!(sorted.iter().copied().eq(0..(side * side) as u32));
    let last: Vec<usize> = order[order.len() - side..].iter().map(|&node| node as usize).collect();
    let straight = |of: fn(usize, usize) -> usize| last.iter().all(|&node| of(node, side) == of(last[0], side));
    assert!(straight(|node, side| node % side) || straight(|node, side| node / side), "{last:?}");
}

#[test]
fn a_chain_of_nodes_is_solved() {
    let nodes = 60_000_u32;
    let cells = (0..nodes - 1).map(|node| vec![node, node + 1]).collect();
    // With these coordinates the elimination tree is as deep as it can be.
    let points: Vec<[f64; 3]> = (0..nodes).map(|node| [2.0_f64.powi(-(node as i32 % 1000)), 0.0, 0.0]).collect();
    let mesh = Mesh { points, cells };
    for block in [2, 3] {
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let factor = Cholesky::new(&pattern, &mesh.points).unwrap().factorize(&matrix).unwrap();
        assert!(solution_error(&factor, &matrix, &pattern) < 1e-11);
    }
}
