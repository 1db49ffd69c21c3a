//! Kernels against plain loops in double precision, for two and three displacement components.

use fedic_mesh::{CellType, MAX_NODES, Subdivision};

use crate::kernels::cell_matrix::CellMatrix;
use crate::kernels::gradient::{LinearJacobian, largest_magnitude, project_gradient};
use crate::kernels::node_sums::add_node_sums;
use crate::kernels::residual::{GreyLevels, moments, weighted_residuals};
use crate::projection::polynomial_basis::PolynomialBasis;
use crate::quadrature::shape_table::ShapeTable;

fn table(cell: CellType) -> (ShapeTable, usize) {
    let subdivision = Subdivision::uniform(cell, 9);
    let (xi, eta): (Vec<f64>, Vec<f64>) = subdivision.all_points().into_iter().map(|[x, y]| (x, y)).unzip();
    let mut table = ShapeTable::default();
    table.fill(cell, &xi, &eta);
    (table, xi.len())
}

/// Unordered values at the points, then zeros.
fn row(seed: usize, len: usize, padded: usize) -> Vec<f32> {
    let value = |k: usize| ((k * 7919 + seed * 104_729) % 1000) as f32 / 250.0 - 2.0;
    (0..padded).map(|k| if k < len { value(k) } else { 0.0 }).collect()
}

fn assert_close(found: f64, expected: f64, case: &str) {
    assert!((found - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{case}: {found} {expected}");
}

fn check_sums<const D: usize>(cell: CellType, jacobian: &LinearJacobian<D>) {
    let (table, len) = table(cell);
    let chunk = table.chunk(0);
    let [f, g, along_u, along_v, w] = [1, 2, 3, 4, 5].map(|seed| row(seed, len, chunk.padded()));
    let weights: Vec<f32> = w.iter().map(|w| w * w).collect();
    let mut weighted = f.clone();
    let grey_levels = GreyLevels { reference: &f, deformed: &g, weights: &weights, gain_offset: [1.2, -0.3] };
    let squares = weighted_residuals(grey_levels, &mut weighted);
    let mut q: [Vec<f32>; D] = std::array::from_fn(|_| f.clone());
    project_gradient(chunk, jacobian, [along_u.as_slice(), &along_v], q.each_mut().map(|q| &mut q[..]));
    let q = q.each_ref().map(|q| &q[..]);
    let mut sums = [[0.0; D]; MAX_NODES];
    add_node_sums(PolynomialBasis::of(cell).shape_monomials(), chunk, q, &weighted, &mut sums);
    let mut matrix = CellMatrix::zeros(chunk.num_nodes());
    matrix.add(chunk, q, &weights);
    matrix.scale(2.0);

    let size = D * chunk.num_nodes();
    let (mut expected, mut expected_squares) = ([[0.0; D]; MAX_NODES], 0.0);
    let mut expected_matrix = vec![0.0; size * size];
    for k in 0..len {
        let [f, g, w] = [f[k], g[k], weights[k]].map(f64::from);
        let residual = f - 1.2 * g + 0.3;
        expected_squares += w * residual * residual;
        let q: [f64; D] = std::array::from_fn(|d| {
            let entry = |c: usize| {
                let [constant, xi, eta] = jacobian[c][d].map(f64::from);
                constant + xi * f64::from(chunk.monomial(1)[k]) + eta * f64::from(chunk.monomial(2)[k])
            };
            entry(0) * f64::from(along_u[k]) + entry(1) * f64::from(along_v[k])
        });
        let shape = |a: usize| f64::from(chunk.shape(a)[k]);
        for row in 0..size {
            let of_row = shape(row / D) * q[row % D];
            expected[row / D][row % D] += w * of_row * residual;
            for column in 0..size {
                expected_matrix[row * size + column] += 2.0 * w * of_row * shape(column / D) * q[column % D];
            }
        }
    }
    let case = format!("{cell}, {D} components");
    assert_close(squares, expected_squares, &case);
    for (found, expected) in sums.as_flattened().iter().zip(expected.as_flattened()) {
        assert_close(*found, *expected, &case);
    }
    for (found, expected) in matrix.entries().iter().zip(&expected_matrix) {
        assert_close(*found, *expected, &case);
    }
    assert_close(matrix.trace(), (0..size).map(|k| expected_matrix[k * size + k]).sum(), &case);
}

#[test]
fn sums_over_the_points_equal_plain_loops() {
    let [u, v] = [
        [[1.1, 0.02, -0.01], [0.1, 0.01, 0.0], [0.4, -0.01, 0.02]],
        [[-0.2, 0.0, 0.03], [0.9, -0.02, 0.01], [-0.3, 0.02, 0.0]],
    ];
    for cell in CellType::ALL {
        check_sums::<2>(cell, &[[u[0], u[1]], [v[0], v[1]]]);
        check_sums::<3>(cell, &[u, v]);
    }
}

#[test]
fn the_largest_magnitude_is_found() {
    let values = row(7, 100, 112);
    assert_eq!(largest_magnitude(&values), values.iter().fold(0.0, |largest, value| value.abs().max(largest)));
}

#[test]
fn moments_are_counted_from_the_origin() {
    let (flat, weights) = (vec![80.0_f32; 64], vec![0.7_f32; 64]);
    assert_eq!(moments(&flat, &weights, 80.0), [0.0; 2]);
    let (grey, weights) = (row(8, 600, 608), row(9, 600, 608));
    let mut expected = [0.0; 2];
    for (grey, weight) in grey.iter().zip(&weights) {
        let counted = f64::from(*grey) - 0.5;
        expected[0] += f64::from(*weight) * counted;
        expected[1] += f64::from(*weight) * counted * counted;
    }
    for (found, expected) in moments(&grey, &weights, 0.5).into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }
}
