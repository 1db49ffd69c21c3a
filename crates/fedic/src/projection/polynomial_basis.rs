//! The linear maps from what is known of a camera at a few points of a cell to a polynomial over it.

use std::sync::OnceLock;

use fedic_mesh::{CellType, MAX_NODES, shape_gradients, shape_values};
use nalgebra::{DMatrix, DVector};

/// Monomials `xi^i eta^j` besides the constant, by degree.
const EXPONENTS: [[i32; 2]; MONOMIALS] =
    [[1, 0], [0, 1], [2, 0], [1, 1], [0, 2], [3, 0], [2, 1], [1, 2], [0, 3], [4, 0], [3, 1], [2, 2], [1, 3], [0, 4]];
/// Number of monomials up to degree 4, the constant left out.
pub(crate) const MONOMIALS: usize = 14;
/// Numbers of monomials up to each degree.
pub(crate) const UP_TO_DEGREE: [usize; 4] = [2, 5, 9, 14];

/// Singular values below this count as zero.
const RANK: f64 = 1e-10;

/// Coefficients of the constant and of each monomial, and a zero that fills the last vector.
pub(crate) type Polynomial = [f64; MONOMIALS + 2];

/// Values, then slopes along `xi`, then along `eta`, at each node; then the value at the centre.
pub(crate) const DATA: usize = 3 * MAX_NODES + 1;

/// All monomials but the constant at a point.
pub(crate) fn monomials([xi, eta]: [f64; 2]) -> [f64; MONOMIALS] {
    let mut values = [0.0; MONOMIALS];
    for (value, [i, j]) in values.iter_mut().zip(EXPONENTS) {
        *value = xi.powi(i) * eta.powi(j);
    }
    values
}

/// What serves for all cells of one type.
pub(crate) struct Fit {
    /// What each datum adds to the coefficients: of the constant, then of each monomial.
    pub(crate) pixel: [Polynomial; DATA],
    /// The same of the values at the nodes alone: what the shape functions are made of.
    pub(crate) shape: [Polynomial; MAX_NODES],
    /// The monomials, the constant counted as the first, that the shape functions are made of.
    pub(crate) spanning: Vec<usize>,
    /// What the Jacobian at each node adds to the constant and the two slopes of a linear one.
    pub(crate) jacobian: [[f64; 3]; MAX_NODES],
    /// Derivatives of the shape functions at each node.
    pub(crate) gradients: [[[f64; 2]; MAX_NODES]; MAX_NODES],
    pub(crate) centre_shape: [f64; MAX_NODES],
    /// Where the polynomial is compared with a smooth camera, and with one made of pieces.
    smooth_check: Vec<Check>,
    piece_checks: Vec<Check>,
}

/// A point of the reference cell: its monomials and shape functions.
pub(crate) struct Check {
    pub(crate) monomials: [f64; MONOMIALS],
    pub(crate) shape: [f64; MAX_NODES],
}

/// Most points where a polynomial is compared with a camera.
pub(crate) const MOST_CHECKS: usize = 4;

impl Fit {
    /// The maps for cells of a type.
    pub(crate) fn of(cell_type: CellType) -> &'static Self {
        static FITS: OnceLock<Vec<Fit>> = OnceLock::new();
        &FITS.get_or_init(|| CellType::ALL.into_iter().map(Self::new).collect())[cell_type as usize]
    }

    fn new(cell_type: CellType) -> Self {
        let nodes = cell_type.reference_nodes();
        let n = nodes.len();
        let centre = cell_type.reference_centre();
        let powers = |m: usize| if m == 0 { [0, 0] } else { EXPONENTS[m - 1] };
        let determines = cell_type.data().determines;
        let used: Vec<usize> = (0..=MONOMIALS).filter(|&m| determines(powers(m)[0], powers(m)[1])).collect();
        let known = DMatrix::from_fn(3 * n + 1, used.len(), |row, column| {
            let ([i, j], [xi, eta]) = (powers(used[column]), if row < 3 * n { nodes[row % n] } else { centre });
            let power = |x: f64, p: i32| if p < 0 { 0.0 } else { x.powi(p) };
            match row / n {
                1 => f64::from(i) * power(xi, i - 1) * power(eta, j),
                2 => f64::from(j) * power(xi, i) * power(eta, j - 1),
                _ => power(xi, i) * power(eta, j),
            }
        });
        let mut fit = Self {
            pixel: [Polynomial::default(); DATA],
            shape: [Polynomial::default(); MAX_NODES],
            spanning: Vec::new(),
            jacobian: [[0.0; 3]; MAX_NODES],
            gradients: [[[0.0; 2]; MAX_NODES]; MAX_NODES],
            centre_shape: [0.0; MAX_NODES],
            smooth_check: Vec::new(),
            piece_checks: Vec::new(),
        };
        let svd = known.svd(true, true);
        for datum in 0..=3 * n {
            let mut unit = DVector::zeros(3 * n + 1);
            unit[datum] = 1.0;
            if let Ok(column) = svd.solve(&unit, RANK) {
                used.iter().zip(column.iter()).for_each(|(&m, &value)| fit.pixel[datum][m] = value);
            }
        }
        let linear = DMatrix::from_fn(n, 3, |row, column| [1.0, nodes[row][0], nodes[row][1]][column]).svd(true, true);
        for node in 0..n {
            let mut unit = DVector::zeros(n);
            unit[node] = 1.0;
            if let Ok(column) = linear.solve(&unit, RANK) {
                (0..3).for_each(|m| fit.jacobian[node][m] = column[m]);
            }
            fit.gradients[node] = shape_gradients(cell_type, nodes[node]);
        }
        let shape_at_centre = shape_values(cell_type, centre);
        for m in 0..=MONOMIALS {
            for node in 0..n {
                // A shape function has its own slopes at the nodes and its own value at the centre.
                let mut coefficient = fit.pixel[node][m] + fit.pixel[3 * n][m] * shape_at_centre[node];
                for at in 0..n {
                    let [xi, eta] = fit.gradients[at][node];
                    coefficient += fit.pixel[n + at][m] * xi + fit.pixel[2 * n + at][m] * eta;
                }
                fit.shape[node][m] = coefficient;
            }
        }
        fit.spanning = (0..=MONOMIALS).filter(|&m| fit.shape.iter().any(|shape| shape[m].abs() > RANK)).collect();
        let check = |&at: &[f64; 2]| Check { monomials: monomials(at), shape: shape_values(cell_type, at) };
        fit.centre_shape = shape_at_centre;
        let domain = cell_type.data().domain;
        fit.smooth_check = domain.check_points(false).iter().map(check).collect();
        fit.piece_checks = domain.check_points(true).iter().map(check).collect();
        fit
    }

    /// Where a polynomial is compared with a camera.
    pub(crate) fn checks(&self, in_pieces: bool) -> &[Check] {
        if in_pieces { &self.piece_checks } else { &self.smooth_check }
    }
}
