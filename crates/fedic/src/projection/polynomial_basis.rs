//! Least-squares fit of a polynomial over a cell to a projection known at the nodes and the centre.

use std::sync::OnceLock;

use fedic_mesh::{CellType, MAX_NODES, shape_gradients, shape_values};
use nalgebra::{DMatrix, DVector};

use crate::kernels::node_sums::ShapeMonomials;
use crate::kernels::polynomial::Polynomial;
use crate::quadrature::monomials::{MONOMIALS, exponents, monomials};

/// Singular values below this count as zero.
const RANK: f64 = 1e-10;

/// Number of data of a fit: values, slopes along `xi`, slopes along `eta` at each node, and the value at the centre.
pub(crate) const DATA: usize = 3 * MAX_NODES + 1;

/// The fit and the shape functions of one cell type, in monomials.
pub(crate) struct PolynomialBasis {
    /// Coefficients of the fit for a unit value of each datum.
    pub(crate) pixel: [Polynomial; DATA],
    /// Coefficients of the shape functions.
    pub(crate) shape: [Polynomial; MAX_NODES],
    /// Monomials with a coefficient in some shape function, the constant counted as the first.
    pub(crate) active: Vec<usize>,
    /// Linear fit, constant and two slopes, of a function that is one at one node and zero at the others.
    pub(crate) jacobian: [[f64; 3]; MAX_NODES],
    /// Derivatives of the shape functions at each node.
    pub(crate) gradients: [[[f64; 2]; MAX_NODES]; MAX_NODES],
    pub(crate) centre_shape: [f64; MAX_NODES],
    /// Points at which the polynomial is compared with a smooth camera, and with a piecewise one.
    smooth_check_points: Vec<CheckPoint>,
    piecewise_check_points: Vec<CheckPoint>,
}

/// A point of the reference cell with its monomials and shape functions.
pub(crate) struct CheckPoint {
    pub(crate) monomials: [f64; MONOMIALS],
    pub(crate) shape: [f64; MAX_NODES],
}

/// Largest number of points at which a polynomial is compared with a camera.
pub(crate) const MAX_CHECK_POINTS: usize = 4;

impl PolynomialBasis {
    /// The basis of a cell type.
    pub(crate) fn of(cell_type: CellType) -> &'static Self {
        static BASES: OnceLock<Vec<PolynomialBasis>> = OnceLock::new();
        &BASES.get_or_init(|| CellType::ALL.into_iter().map(Self::new).collect())[cell_type as usize]
    }

    fn new(cell_type: CellType) -> Self {
        let nodes = cell_type.reference_nodes();
        let n = nodes.len();
        let centre = cell_type.reference_centre();
        let determines = cell_type.data().determines;
        let used: Vec<usize> = (0..=MONOMIALS).filter(|&m| determines(exponents(m)[0], exponents(m)[1])).collect();
        let known = DMatrix::from_fn(3 * n + 1, used.len(), |row, column| {
            let ([i, j], [xi, eta]) = (exponents(used[column]), if row < 3 * n { nodes[row % n] } else { centre });
            let power = |x: f64, p: i32| if p < 0 { 0.0 } else { x.powi(p) };
            match row / n {
                1 => f64::from(i) * power(xi, i - 1) * power(eta, j),
                2 => f64::from(j) * power(xi, i) * power(eta, j - 1),
                _ => power(xi, i) * power(eta, j),
            }
        });
        let mut basis = Self {
            pixel: [Polynomial::default(); DATA],
            shape: [Polynomial::default(); MAX_NODES],
            active: Vec::new(),
            jacobian: [[0.0; 3]; MAX_NODES],
            gradients: [[[0.0; 2]; MAX_NODES]; MAX_NODES],
            centre_shape: [0.0; MAX_NODES],
            smooth_check_points: Vec::new(),
            piecewise_check_points: Vec::new(),
        };
        let svd = known.svd(true, true);
        for datum in 0..=3 * n {
            let mut unit = DVector::zeros(3 * n + 1);
            unit[datum] = 1.0;
            if let Ok(column) = svd.solve(&unit, RANK) {
                used.iter().zip(column.iter()).for_each(|(&m, &value)| basis.pixel[datum][m] = value);
            }
        }
        let linear = DMatrix::from_fn(n, 3, |row, column| [1.0, nodes[row][0], nodes[row][1]][column]).svd(true, true);
        for node in 0..n {
            let mut unit = DVector::zeros(n);
            unit[node] = 1.0;
            if let Ok(column) = linear.solve(&unit, RANK) {
                (0..3).for_each(|m| basis.jacobian[node][m] = column[m]);
            }
            basis.gradients[node] = shape_gradients(cell_type, nodes[node]);
        }
        let shape_at_centre = shape_values(cell_type, centre);
        for m in 0..=MONOMIALS {
            for node in 0..n {
                // A shape function has its own slopes at the nodes and its own value at the centre.
                let mut coefficient = basis.pixel[node][m] + basis.pixel[3 * n][m] * shape_at_centre[node];
                for at in 0..n {
                    let [xi, eta] = basis.gradients[at][node];
                    coefficient += basis.pixel[n + at][m] * xi + basis.pixel[2 * n + at][m] * eta;
                }
                basis.shape[node][m] = coefficient;
            }
        }
        basis.active = (0..=MONOMIALS).filter(|&m| basis.shape.iter().any(|shape| shape[m].abs() > RANK)).collect();
        let check = |&at: &[f64; 2]| CheckPoint { monomials: monomials(at), shape: shape_values(cell_type, at) };
        basis.centre_shape = shape_at_centre;
        let domain = cell_type.data().domain;
        basis.smooth_check_points = domain.check_points(false).iter().map(check).collect();
        basis.piecewise_check_points = domain.check_points(true).iter().map(check).collect();
        basis
    }

    /// Shape functions as combinations of monomials.
    pub(crate) fn shape_monomials(&self) -> ShapeMonomials<'_> {
        ShapeMonomials { active: &self.active, coefficients: &self.shape }
    }

    /// Points at which a polynomial is compared with a camera.
    pub(crate) fn check_points(&self, piecewise: bool) -> &[CheckPoint] {
        if piecewise { &self.piecewise_check_points } else { &self.smooth_check_points }
    }
}
