//! Gain and offset of the deformed image as fields on the mesh, smooth over about two cells.

use fedic_mesh::{CellType, MAX_NODES, Mesh};
use fedic_sparse::{Cholesky, Pattern, SpdFactor, SpdSolver, SymmetricMatrix};

use crate::SolveError;
use crate::equations::terms::laplacian::Laplacian;
use crate::kernels::cell_matrix::CellMatrix;
use crate::kernels::polynomial::{PixelPolynomial, combinations};
use crate::observation::photometry::GainOffset;
use crate::projection::polynomial_basis::PolynomialBasis;
use crate::quadrature::monomials::{MONOMIALS, UP_TO_DEGREE};

/// Unknowns of a node: gain and offset.
const LIGHT: usize = 2;
/// Wavelength, in cells, of the variations of light that the penalty on their gradient halves.
const WAVELENGTH: f64 = 2.5;
/// Share of the mean diagonal that is added to it, so that light is known where no point is.
const RIDGE: f64 = 1e-6;

/// What the light of every deformed image has in common: the pattern of its unknowns and the penalty on its gradient.
pub(crate) struct LightSystem {
    pattern: Pattern,
    cholesky: Cholesky,
    laplacian: Laplacian,
    /// Square of the length, in the mesh's unit, of the penalty.
    squared_length: f64,
}

/// Normal equations of the light, as sums over points with the weight `w`.
pub(crate) struct LightSums {
    matrix: SymmetricMatrix,
    right_hand_side: Vec<f64>,
}

/// Share of one cell.
pub(crate) struct LightShare {
    /// `sum w N^T (s, 1) f`, by node.
    pub(crate) sums: [[f64; LIGHT]; MAX_NODES],
    /// `sum w (N^T (s, 1)) (N^T (s, 1))^T`.
    pub(crate) matrix: CellMatrix<LIGHT>,
}

/// Light of one deformed image: `g~ = gain s + offset` with `s = g / unit`.
pub(crate) struct LightField<'a> {
    system: &'a LightSystem,
    /// Standard deviation of the reference image, in grey levels.
    unit: f64,
    /// Light that is the same everywhere, from which the field is counted.
    uniform: [f64; LIGHT],
    /// Gain and offset of each node.
    values: Vec<[f64; LIGHT]>,
}

impl LightSystem {
    /// Orders the unknowns of a mesh.
    ///
    /// # Errors
    ///
    /// [`SolveError::TooLarge`] if the factor does not fit in memory.
    pub(crate) fn new(mesh: &Mesh) -> Result<Self, SolveError> {
        let pattern = Pattern::new(mesh.num_nodes(), LIGHT, mesh.cells().map(|cell| cell.nodes));
        let too_large = |_| SolveError::TooLarge { dofs: pattern.num_dofs() };
        let cholesky = Cholesky::new(&pattern, mesh.points()).map_err(too_large)?;
        let laplacian = Laplacian::new::<LIGHT>(mesh, &pattern);
        let of_cell = laplacian.area / mesh.num_cells().max(1) as f64;
        let squared_length = of_cell * (WAVELENGTH / std::f64::consts::TAU).powi(2);
        Ok(Self { pattern, cholesky, laplacian, squared_length })
    }

    /// Sums without any point.
    pub(crate) fn sums(&self) -> LightSums {
        LightSums { matrix: SymmetricMatrix::zeros(&self.pattern), right_hand_side: vec![0.0; self.pattern.num_dofs()] }
    }

    /// Adds the share of a cell.
    pub(crate) fn add(&self, sums: &mut LightSums, cell: usize, share: &LightShare) {
        sums.matrix.add_cell(&self.pattern, cell, &share.matrix.entries());
        let all = sums.right_hand_side.as_chunks_mut::<LIGHT>().0;
        for (&node, sums) in self.pattern.cell(cell).iter().zip(&share.sums) {
            all[node as usize].iter_mut().zip(sums).for_each(|(b, sum)| *b += sum);
        }
    }
}

impl<'a> LightField<'a> {
    /// The same light everywhere: a gain and offset of grey levels counted from zero.
    pub(crate) fn uniform(system: &'a LightSystem, unit: f64, light: GainOffset) -> Self {
        let uniform = [light.gain * unit, light.offset];
        Self { system, unit, uniform, values: vec![uniform; system.pattern.num_nodes()] }
    }

    pub(crate) fn system(&self) -> &'a LightSystem {
        self.system
    }

    pub(crate) fn unit(&self) -> f64 {
        self.unit
    }

    /// Gain and offset over a cell.
    pub(crate) fn over_cell(&self, cell_type: CellType, nodes: &[u32]) -> PixelPolynomial {
        let basis = PolynomialBasis::of(cell_type);
        let mut factors = [[0.0; MAX_NODES]; LIGHT];
        for (a, &node) in nodes.iter().enumerate() {
            (0..LIGHT).for_each(|c| factors[c][a] = self.values[node as usize][c]);
        }
        let factors = factors.each_ref().map(|row| &row[..nodes.len()]);
        let polynomials = combinations(factors, &basis.shape[..nodes.len()]);
        let highest = basis.active.last().copied().unwrap_or_default();
        let terms = UP_TO_DEGREE.into_iter().find(|&terms| terms >= highest).unwrap_or(MONOMIALS);
        let coefficients = polynomials.map(|polynomial| std::array::from_fn(|m| polynomial[m] as f32));
        PixelPolynomial { coefficients, remainder: [[0.0; 3]; LIGHT], terms }
    }

    /// Corrected grey level of a point from the values of the shape functions of its cell.
    pub(crate) fn corrected(&self, nodes: &[u32], shapes: &[f64], grey: f64) -> f64 {
        let mut light = [0.0; LIGHT];
        for (&node, shape) in nodes.iter().zip(shapes) {
            (0..LIGHT).for_each(|c| light[c] += shape * self.values[node as usize][c]);
        }
        let [gain, offset] = light;
        gain * grey / self.unit + offset
    }

    /// Fits the light to the sums over all cells, and returns the largest change, in units of the contrast of the reference image.
    ///
    /// # Errors
    ///
    /// [`SolveError::TooLarge`] if the factor does not fit in memory.
    pub(crate) fn fit(&mut self, sums: LightSums) -> Result<f64, SolveError> {
        let LightSums { mut matrix, right_hand_side: mut increment } = sums;
        let LightSystem { pattern, cholesky, laplacian, squared_length } = self.system;
        let num_nodes = pattern.num_nodes();
        // The shape functions add up to one: `sum w s^2` and `sum w`.
        let densities: [f64; LIGHT] = std::array::from_fn(|c| {
            let unit: Vec<f64> = (0..LIGHT * num_nodes).map(|dof| f64::from(dof % LIGHT == c)).collect();
            matrix.quadratic_form(pattern, &unit) / laplacian.area
        });
        if densities[1] <= 0.0 {
            return Ok(0.0);
        }
        let uniform: Vec<f64> = std::iter::repeat_n(self.uniform, num_nodes).flatten().collect();
        let known = matrix.multiply(pattern, &uniform);
        increment.iter_mut().zip(known).for_each(|(b, known)| *b -= known);
        // Each unknown is smoothed relative to the weight that the points give it.
        let [gain, offset] = densities.map(f64::sqrt);
        let blocks = vec![[[gain, 0.0], [0.0, offset]]; num_nodes];
        matrix.add_congruent(pattern, *squared_length, &laplacian.matrix, &blocks);
        let ridge = RIDGE * densities[1] * laplacian.area / num_nodes as f64;
        (0..num_nodes).for_each(|node| matrix.add_to_node_diagonal(pattern, node, ridge));
        let too_large = |_| SolveError::TooLarge { dofs: pattern.num_dofs() };
        cholesky.factorize(&matrix).map_err(too_large)?.solve(&mut increment);
        let mut change = 0.0_f64;
        for (value, increment) in self.values.iter_mut().zip(increment.as_chunks::<LIGHT>().0) {
            for c in 0..LIGHT {
                let found = self.uniform[c] + increment[c];
                change = change.max((found - value[c]).abs() / self.unit);
                value[c] = found;
            }
        }
        Ok(change)
    }
}
