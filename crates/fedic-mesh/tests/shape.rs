//! Shape functions of the five cells: what they reproduce, and their derivatives.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic_mesh::{CellType, MAX_NODES, shape_gradients, shape_values, shape_values_batch};
use proptest::prelude::*;

const ROUNDING: f64 = 1e-14;

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

/// Points in and around the reference domains.
fn any_point() -> impl Strategy<Value = [f64; 2]> {
    [-1.2..1.2, -1.2..1.2]
}

/// Powers of `xi` and `eta` of the monomials a cell must reproduce: they span its space of shape functions.
fn monomials(cell: CellType) -> &'static [[i32; 2]] {
    const ALL: &[[i32; 2]] = &[[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [0, 2], [2, 1], [1, 2], [2, 2]];
    match cell {
        CellType::Triangle => &ALL[..3],
        CellType::Quad => &ALL[..4],
        CellType::Triangle6 => &ALL[..6],
        CellType::Quad8 => &ALL[..8],
        CellType::Quad9 => ALL,
    }
}

#[test]
fn each_function_is_one_at_its_node_and_zero_at_the_others() {
    for cell in CellType::ALL {
        for (node, &at) in cell.reference_nodes().iter().enumerate() {
            let values = shape_values(cell, at);
            for (function, value) in values.into_iter().enumerate() {
                assert_eq!(value, f64::from(u8::from(function == node)), "{cell}: function {function} at node {node}");
            }
        }
    }
}

proptest! {
    #[test]
    fn functions_sum_to_one_and_their_gradients_to_zero(cell in any_cell(), at in any_point()) {
        let sum: f64 = shape_values(cell, at).iter().sum();
        prop_assert!((sum - 1.0).abs() < ROUNDING, "{sum}");
        for d in 0..2 {
            let sum: f64 = shape_gradients(cell, at).iter().map(|g| g[d]).sum();
            prop_assert!(sum.abs() < ROUNDING, "{sum}");
        }
    }

    #[test]
    fn the_polynomials_of_the_cell_are_reproduced(cell in any_cell(), [x, y] in any_point()) {
        for &[p, q] in monomials(cell) {
            let monomial = |[x, y]: [f64; 2]| x.powi(p) * y.powi(q);
            let nodal = cell.reference_nodes().iter().map(|&node| monomial(node));
            let interpolated: f64 = nodal.zip(shape_values(cell, [x, y])).map(|(value, shape)| value * shape).sum();
            let error = interpolated - monomial([x, y]);
            prop_assert!(error.abs() < ROUNDING, "xi^{p} eta^{q}: {error:e}");
        }
    }

    /// No function is more than quadratic along either axis: a central difference is exact, however long its step.
    #[test]
    fn gradients_are_the_derivatives(cell in any_cell(), [x, y] in any_point(), step in 0.2..0.8) {
        let exact = shape_gradients(cell, [x, y]);
        let difference = |forward: [f64; MAX_NODES], back: [f64; MAX_NODES], node: usize| -> f64 {
            (forward[node] - back[node]) / (2.0 * step)
        };
        let along_x = [shape_values(cell, [x + step, y]), shape_values(cell, [x - step, y])];
        let along_y = [shape_values(cell, [x, y + step]), shape_values(cell, [x, y - step])];
        for node in 0..MAX_NODES {
            let [dx, dy] = exact[node];
            prop_assert!((dx - difference(along_x[0], along_x[1], node)).abs() < 2.0 * ROUNDING, "node {node}");
            prop_assert!((dy - difference(along_y[0], along_y[1], node)).abs() < 2.0 * ROUNDING, "node {node}");
        }
    }

    #[test]
    fn a_batch_gives_the_same_bits_as_its_points(
        cell in any_cell(),
        points in proptest::collection::vec(any_point(), 0..40),
    ) {
        let (xi, eta): (Vec<f64>, Vec<f64>) = points.iter().map(|&[x, y]| (x, y)).unzip();
        let mut batch = vec![f64::NAN; cell.num_nodes() * points.len()];
        shape_values_batch(cell, &xi, &eta, &mut batch);
        for (k, &at) in points.iter().enumerate() {
            for (node, value) in shape_values(cell, at)[..cell.num_nodes()].iter().enumerate() {
                prop_assert_eq!(batch[node * points.len() + k].to_bits(), value.to_bits());
            }
        }
    }
}
