#[cfg(test)]
mod tests {
    use fedic_mesh::{CellType, Subdivision};

    use super::*;
    use crate::quadrature::shape_table::PointTable;

    fn table(cell: CellType) -> (PointTable, usize) {
        let subdivision = Subdivision::uniform(cell, 9);
        let (xi, eta): (Vec<f64>, Vec<f64>) = subdivision.all_points().into_iter().map(|[x, y]| (x, y)).unzip();
        let mut table = PointTable::default();
        table.fill(cell, &xi, &eta);
        (table, xi.len())
    }

    /// Numbers without order at the points, then zeros.
    fn row(seed: usize, len: usize, padded: usize) -> Vec<f32> {
        let number = |k: usize| ((k * 7919 + seed * 104_729) % 1000) as f32 / 250.0 - 2.0;
        (0..padded).map(|k| if k < len { number(k) } else { 0.0 }).collect()
    }

    #[test]
    fn sums_equal_plain_loops_in_double_precision() {
        for cell in CellType::ALL {
            let (table, len) = table(cell);
            let rows = table.part(0);
            let [f, g, along_u, along_v, w] = [1, 2, 3, 4, 5].map(|seed| row(seed, len, rows.padded()));
            let weights: Vec<f32> = w.iter().map(|w| w * w).collect();
            let jacobian = [[1.1, 0.02, -0.01], [0.1, 0.01, 0.0], [-0.2, 0.0, 0.03], [0.9, -0.02, 0.01]];
            let correction = [1.2, -0.3];
            let mut weighted = f.clone();
            let squares = weighted_residuals(
                Readings { reference: &f, deformed: &g, weights: &weights, correction },
                &mut weighted,
            );
            let mut q = [f.clone(), f.clone()];
            let [x, y] = &mut q;
            pull_back(rows, &jacobian, [along_u.as_slice(), along_v.as_slice()], [x, y]);
            let mut sums = [[0.0; COMPONENTS]; MAX_NODES];
            add_node_sums(cell, rows, [&q[0], &q[1]], &weighted, &mut sums);
            let pairs = rows.num_nodes() * (rows.num_nodes() + 1) / 2;
            let mut hessian = vec![[0.0; PRODUCTS]; pairs];
            hessian_sums(rows, [&q[0], &q[1]], &weights, &mut hessian);

            let (mut expected, mut expected_squares) = ([[0.0; COMPONENTS]; MAX_NODES], 0.0);
            let mut expected_hessian = vec![[0.0; PRODUCTS]; pairs];
            for k in 0..len {
                let [f, g, w] = [f[k], g[k], weights[k]].map(f64::from);
                let residual = f - 1.2 * g + 0.3;
                expected_squares += w * residual * residual;
                let [qx, qy] = [0, 1].map(|c| {
                    let entry = |e: usize| {
                        let [constant, xi, eta] = jacobian[e].map(f64::from);
                        constant + xi * f64::from(rows.monomial(1)[k]) + eta * f64::from(rows.monomial(2)[k])
                    };
                    entry(c) * f64::from(along_u[k]) + entry(2 + c) * f64::from(along_v[k])
                });
                let mut pair = 0;
                for a in 0..rows.num_nodes() {
                    let shape = f64::from(rows.shape(a)[k]);
                    expected[a][0] += w * shape * qx * residual;
                    expected[a][1] += w * shape * qy * residual;
                    for b in 0..=a {
                        let both = w * shape * f64::from(rows.shape(b)[k]);
                        let products = [both * qx * qx, both * qx * qy, both * qy * qy];
                        expected_hessian[pair].iter_mut().zip(products).for_each(|(sum, p)| *sum += p);
                        pair += 1;
                    }
                }
            }
            let close = |found: f64, expected: f64| (found - expected).abs() < 1e-5 * (1.0 + expected.abs());
            assert!(close(squares, expected_squares), "{cell}: {squares} {expected_squares}");
            for (found, expected) in sums.as_flattened().iter().zip(expected.as_flattened()) {
                assert!(close(*found, *expected), "{cell}: {found} {expected}");
            }
            for (found, expected) in hessian.as_flattened().iter().zip(expected_hessian.as_flattened()) {
                assert!(close(*found, *expected), "{cell}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_largest_is_found() {
        let numbers = row(7, 100, 112);
        assert_eq!(largest(&numbers), numbers.iter().fold(0.0, |largest, number| number.abs().max(largest)));
    }

    #[test]
    fn moments_are_counted_from_a_level() {
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
}
