//! Noise that is left.

use fedic_mesh::CellType;
use nalgebra::DMatrix;

use super::scene::{System, isotropic, rectangle, sides};

const SIDE: f64 = 24.0;
const LENGTH: f64 = 8.0;

/// Ratio of the standard deviations with and without the penalty, root mean square over some nodes, for noise of the covariance `M`.
fn ratio(system: &System, is_counted: impl Fn([f64; 3]) -> bool) -> f64 {
    let pattern = &system.dofs.pattern;
    let (mut regularized, mut plain) = (0.0, 0.0);
    for (node, _) in system.dofs.mesh.points().iter().enumerate().filter(|(_, point)| is_counted(**point)) {
        let mut unit = vec![0.0; pattern.num_dofs()];
        unit[2 * node] = 1.0;
        // C = A^-1 M A^-1, and M^-1 without the penalty.
        let column = system.solve(&unit);
        regularized += system.hessian.quadratic_form(pattern, column.as_flattened());
        plain += system.solve_plain(&unit)[node][0];
    }
    (regularized / plain).sqrt()
}

#[test]
fn noise_inside_and_at_free_edges_is_lowered_to_a_tenth() {
    for cell_type in CellType::ALL {
        let mesh = rectangle([SIDE, SIDE], cell_type, 0.0);
        let gap = System::gap(&mesh, isotropic(), sides(&mesh, SIDE), LENGTH);
        let curvature = System::curvature(&mesh, LENGTH);
        let inside = |[x, y, _]: [f64; 3]| x > 4.5 && x < SIDE - 4.5 && y > 4.5 && y < SIDE - 4.5;
        let free = |[x, y, _]: [f64; 3]| x < 1e-9 && y > 4.5 && y < SIDE - 4.5;
        let loaded = |[x, y, _]: [f64; 3]| y < 1e-9 && x > 4.5 && x < SIDE - 4.5;
        let of = |system: &System| [ratio(system, inside), ratio(system, free), ratio(system, loaded)];
        let (gap, curvature) = (of(&gap), of(&curvature));
        // Quadratic cells have more noise without a penalty.
        assert!(gap[0] < 0.11 && gap[0] < 0.9 * curvature[0], "{cell_type:?}: {gap:?} {curvature:?}");
        assert!(gap[1] < 0.11, "{cell_type:?}: {gap:?}");
        assert!(gap[2] > 0.5, "{cell_type:?}: loaded edges are not regularized: {gap:?}");
    }
}

#[test]
fn the_variances_are_those_of_a_dense_solution() {
    let mesh = rectangle([5.0, 4.0], CellType::Quad, 0.1);
    let system = System::gap(&mesh, isotropic(), sides(&mesh, 4.0), 5.0);
    let dense = |matrix: &fedic_sparse::SymmetricMatrix| {
        let (starts, rows) = system.dofs.pattern.lower_triangle();
        let mut dense = DMatrix::zeros(starts.len() - 1, starts.len() - 1);
        for column in 0..starts.len() - 1 {
            for k in starts[column]..starts[column + 1] {
                dense[(rows[k], column)] = matrix.values()[k];
                dense[(column, rows[k])] = matrix.values()[k];
            }
        }
        dense
    };
    let (hessian, penalty) = (dense(&system.hessian), dense(&system.penalty));
    let inverse = (&hessian + &penalty).try_inverse().unwrap();
    let covariance = &inverse * &hessian * &inverse;
    let plain = hessian.try_inverse().unwrap();
    let all = |matrix: &DMatrix<f64>| (0..mesh.num_nodes()).map(|node| matrix[(2 * node, 2 * node)]).sum::<f64>();
    let expected = (all(&covariance) / all(&plain)).sqrt();
    assert!((ratio(&system, |_| true) / expected - 1.0).abs() < 1e-9);
}
