//! Area and first moments of cells integrated by the quadrature points: exact for parallelograms and triangles, of second
//! order otherwise.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Random, determinant, shoelace, straight_cell};
use fedic_mesh::{CellType, Subdivision, jacobian, map};
use proptest::prelude::*;

/// Integrals of `1`, `x` and `y` over a cell.
fn integrals(cell: CellType, nodes: &[[f64; 2]], subdivision: Subdivision) -> [f64; 3] {
    let count = subdivision.num_points();
    let (mut xi, mut eta) = (vec![0.0; count], vec![0.0; count]);
    subdivision.points(0, &mut xi, &mut eta);
    let mut sums = [0.0; 3];
    for (&x, &y) in xi.iter().zip(&eta) {
        let weight = subdivision.subcell_area() * determinant(jacobian(cell, nodes, [x, y]));
        let at = map(cell, nodes, [x, y]);
        for (sum, value) in sums.iter_mut().zip([1.0, at[0], at[1]]) {
            *sum += weight * value;
        }
    }
    sums
}

/// Integrals extrapolated from fine subdivisions, to fourth order.
fn extrapolated(cell: CellType, nodes: &[[f64; 2]]) -> [f64; 3] {
    let [coarse, fine] = [256, 512].map(|n| integrals(cell, nodes, cut(cell, n, n)));
    std::array::from_fn(|k| (4.0 * fine[k] - coarse[k]) / 3.0)
}

fn any_case() -> impl Strategy<Value = (CellType, u64, Subdivision)> {
    let cells = proptest::sample::select(CellType::ALL.as_slice());
    (cells, any::<u64>(), 1_u32..40, 1_u32..40, any::<bool>()).prop_map(|(cell, seed, nx, ny, rotated)| {
        let subdivision = match cut(cell, nx, ny) {
            Subdivision::Quad { nx, ny } if rotated => Subdivision::RotatedQuad { nx, ny },
            subdivision => subdivision,
        };
        (cell, seed, subdivision)
    })
}

fn cut(cell: CellType, nx: u32, ny: u32) -> Subdivision {
    if cell.is_triangle() { Subdivision::Triangle { n: nx } } else { Subdivision::Quad { nx, ny } }
}

proptest! {
    #[test]
    fn the_area_of_a_cell_with_straight_edges_is_exact((cell, seed, subdivision) in any_case()) {
        let corners = Random::new(seed).corners(cell, 10.0);
        let area = integrals(cell, &straight_cell(cell, &corners), subdivision)[0];
        let exact = shoelace(&corners);
        prop_assert!((area - exact).abs() < 1e-12 * exact, "{area} {exact}");
    }

    #[test]
    fn first_moments_of_a_parallelogram_or_triangle_are_exact((cell, seed, subdivision) in any_case()) {
        let mut random = Random::new(seed);
        let [[a, b], [c, d]] = random.affine(10.0);
        let (x0, y0) = (random.between(-100.0, 100.0), random.between(-100.0, 100.0));
        let nodes: Vec<[f64; 2]> =
            cell.reference_nodes().iter().map(|&[x, y]| [x0 + a * x + b * y, y0 + c * x + d * y]).collect();
        let [x, y] = cell.reference_centre();
        let area = cell.reference_area() * (a * d - b * c);
        let exact = [area, area * (x0 + a * x + b * y), area * (y0 + c * x + d * y)];
        for (found, exact) in integrals(cell, &nodes, subdivision).into_iter().zip(exact) {
            prop_assert!((found - exact).abs() < 1e-12 * area * 100.0, "{found} {exact}");
        }
    }
}

/// Orders of convergence of the three integrals from `n` to `2 n` intervals, for `n` = 8, 16 and 32.
fn orders(cell: CellType, nodes: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let exact = extrapolated(cell, nodes);
    let errors = [8, 16, 32, 64].map(|n| {
        let found = integrals(cell, nodes, cut(cell, n, n));
        std::array::from_fn::<f64, 3, _>(|k| (found[k] - exact[k]).abs())
    });
    errors.windows(2).map(|pair| std::array::from_fn(|k| (pair[0][k] / pair[1][k]).log2())).collect()
}

#[test]
fn first_moments_of_a_straight_quad_converge_at_second_order() {
    let corners = [[0.0, 0.0], [4.0, 0.5], [5.0, 3.0], [-0.5, 2.0]];
    for cell in CellType::ALL.into_iter().filter(|cell| !cell.is_triangle()) {
        for [_, x, y] in orders(cell, &straight_cell(cell, &corners)) {
            assert!((1.9..2.1).contains(&x) && (1.9..2.1).contains(&y), "{cell}: {x} {y}");
        }
    }
}

#[test]
fn area_and_first_moments_of_a_curved_cell_converge_at_second_order() {
    for cell in CellType::ALL.into_iter().filter(|cell| cell.edge_intervals() > 1) {
        let corners: &[[f64; 2]] = if cell.is_triangle() {
            &[[0.0, 0.0], [4.0, 0.5], [1.0, 3.0]]
        } else {
            &[[0.0, 0.0], [4.0, 0.5], [5.0, 3.0], [-0.5, 2.0]]
        };
        let mut nodes = straight_cell(cell, corners);
        for (k, node) in nodes[cell.num_corners()..].iter_mut().enumerate() {
            node[0] += 0.3 * (k as f64 + 1.0).sin();
            node[1] += 0.4 * (2.0 * k as f64 + 1.0).cos();
        }
        for found in orders(cell, &nodes) {
            assert!(found.iter().all(|order| (1.9..2.1).contains(order)), "{cell}: {found:?}");
        }
    }
}
