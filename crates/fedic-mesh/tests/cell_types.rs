//! Tests that every cell type passes: consistency of its data, and its shape functions.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashSet;

use common::clockwise;
use fedic_mesh::{CellType, CellVisitor, MAX_NODES, shape_gradients, shape_values, shape_values_batch};
use proptest::prelude::*;

const ROUNDING: f64 = 1e-14;

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

/// Points in and around the reference domains.
fn any_point() -> impl Strategy<Value = [f64; 2]> {
    [-1.2..1.2, -1.2..1.2]
}

/// Whether the shape functions of a cell must reproduce `xi^i eta^j`: all of the degree of the edges, and on the square those
/// of its tensor-product (with all inner nodes) or serendipity space.
fn is_reproduced(cell: CellType, [i, j]: [i32; 2]) -> bool {
    let order = cell.edge_intervals();
    let p = order as i32;
    let square = if cell.num_nodes() == (order + 1).pow(2) { i.max(j) <= p } else { i.max(j) <= p && i.min(j) <= 1 };
    i + j <= p || (!cell.is_triangle() && square)
}

/// `f'(0)` of a polynomial of degree 4 or less.
fn derivative(f: impl Fn(f64) -> f64, step: f64) -> f64 {
    (8.0 * (f(step) - f(-step)) - (f(2.0 * step) - f(-2.0 * step))) / (12.0 * step)
}

#[test]
fn nodes_are_listed_as_corners_then_edges_then_inside() {
    for cell in CellType::ALL {
        let (nodes, corners, intervals) = (cell.reference_nodes(), cell.num_corners(), cell.edge_intervals());
        assert_eq!(&nodes[..corners], cell.data().domain.corners(), "{cell}");
        assert_eq!(cell.outline().len(), corners * intervals, "{cell}");
        for (k, &node) in cell.outline().iter().enumerate() {
            let (from, along) = (k / intervals, (k % intervals) as f64 / intervals as f64);
            let (a, b) = (nodes[from], nodes[(from + 1) % corners]);
            for d in 0..2 {
                assert!((nodes[node][d] - a[d] - along * (b[d] - a[d])).abs() < ROUNDING, "{cell}, node {node}");
            }
            let expected = if k % intervals == 0 { from } else { corners + from * (intervals - 1) + k % intervals - 1 };
            assert_eq!(node, expected, "{cell}");
        }
        assert!(nodes.iter().all(|&at| cell.data().domain.contains(at, 0.0)), "{cell}");
    }
}

#[test]
fn nodes_lie_on_the_grid_of_the_cell_type_and_on_no_coarser_one() {
    let on_grid = |cell: CellType, intervals: usize| {
        let places =
            cell.reference_nodes().iter().flatten().map(|&c| if cell.is_triangle() { c } else { 0.5 + 0.5 * c });
        places.into_iter().all(|c| (c * intervals as f64 - (c * intervals as f64).round()).abs() < 1e-12)
    };
    for cell in CellType::ALL {
        let intervals = cell.data().grid_intervals;
        assert!(on_grid(cell, intervals) && !(1..intervals).any(|fewer| on_grid(cell, fewer)), "{cell}");
    }
}

#[test]
fn reversed_nodes_are_those_of_the_mirrored_domain() {
    for cell in CellType::ALL {
        let indices: Vec<usize> = (0..cell.num_nodes()).collect();
        assert_eq!(cell.data().reversed, clockwise(cell, &indices), "{cell}");
    }
}

#[test]
fn names_and_numbers_of_cell_types_are_unique() {
    let distinct = |keys: Vec<String>| keys.iter().collect::<HashSet<_>>().len() == keys.len();
    assert!(distinct(CellType::ALL.iter().map(|cell| cell.name().to_owned()).collect()));
    assert!(distinct(CellType::ALL.iter().map(|cell| cell.data().vtk_type.to_string()).collect()));
    assert!(distinct(
        CellType::ALL.iter().flat_map(|cell| cell.data().abaqus_suffixes).map(|s| (*s).to_owned()).collect()
    ));
    assert_eq!(CellType::ALL.iter().map(|cell| cell.num_nodes()).max(), Some(MAX_NODES));
}

#[test]
fn visitors_get_the_number_of_nodes() {
    struct Count;
    impl CellVisitor for Count {
        type Output = usize;

        fn visit<const N: usize>(self) -> usize {
            N
        }
    }
    for cell in CellType::ALL {
        assert_eq!(cell.visit(Count), cell.num_nodes());
    }
}

#[test]
fn each_function_is_one_at_its_node_and_zero_at_the_others() {
    for cell in CellType::ALL {
        for (node, &at) in cell.reference_nodes().iter().enumerate() {
            let values = shape_values(cell, at);
            for (function, value) in values.into_iter().enumerate() {
                let expected = f64::from(u8::from(function == node));
                assert!((value - expected).abs() < ROUNDING, "{cell}: function {function} at node {node}: {value}");
            }
        }
    }
}

proptest! {
    #[test]
    fn functions_sum_to_one_and_their_gradients_to_zero(cell in any_cell(), at in any_point()) {
        let sum: f64 = shape_values(cell, at).iter().sum();
        prop_assert!((sum - 1.0).abs() < 10.0 * ROUNDING, "{sum}");
        for d in 0..2 {
            let sum: f64 = shape_gradients(cell, at).iter().map(|g| g[d]).sum();
            prop_assert!(sum.abs() < 10.0 * ROUNDING, "{sum}");
        }
    }

    #[test]
    fn the_polynomials_of_the_cell_are_reproduced(cell in any_cell(), [x, y] in any_point()) {
        for [p, q] in (0..4).flat_map(|p| (0..4).map(move |q| [p, q])).filter(|&powers| is_reproduced(cell, powers)) {
            let monomial = |[x, y]: [f64; 2]| x.powi(p) * y.powi(q);
            let nodal = cell.reference_nodes().iter().map(|&node| monomial(node));
            let interpolated: f64 = nodal.zip(shape_values(cell, [x, y])).map(|(value, shape)| value * shape).sum();
            let error = interpolated - monomial([x, y]);
            prop_assert!(error.abs() < 10.0 * ROUNDING, "xi^{p} eta^{q}: {error:e}");
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_functions(cell in any_cell(), [x, y] in any_point(), step in 0.1..0.4) {
        let exact = shape_gradients(cell, [x, y]);
        for (node, [dx, dy]) in exact.into_iter().enumerate() {
            let along_x = derivative(|h| shape_values(cell, [x + h, y])[node], step);
            let along_y = derivative(|h| shape_values(cell, [x, y + h])[node], step);
            prop_assert!((dx - along_x).abs() < 20.0 * ROUNDING, "node {node}: {:e}", dx - along_x);
            prop_assert!((dy - along_y).abs() < 20.0 * ROUNDING, "node {node}: {:e}", dy - along_y);
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
