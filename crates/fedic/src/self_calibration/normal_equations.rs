//! Normal equations of the camera parameters, the motions and the brightness, with the residuals per image.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::self_calibration::layout::Layout;

/// Smallest damping relative to the diagonal: a step does not follow undetermined directions.
const MIN_DAMPING: f64 = 1e-11;

/// Sums over quadrature points that make up the normal equations.
#[derive(Debug, Clone)]
pub(crate) struct CalibrationEquations {
    pub(crate) layout: Layout,
    /// Upper triangle, row by row.
    matrix: Vec<f64>,
    rhs: Vec<f64>,
    /// Sum of squared residuals of each image, and its degrees of freedom.
    squares: Vec<[f64; 2]>,
    /// `sum w s^2` of each parameter over points and images, before the mean over the images is subtracted.
    parameter_energy: Vec<f64>,
    /// `sum w |q|^2 / 2` over points and images, with the texture gradient `q` as it appears in the image.
    gradient_energy: f64,
    /// `sum w`, `sum w m` and `sum w m^2` of the mean grey levels `m`.
    texture: [f64; 3],
}

/// Rows of the Jacobian of one point, one for each image that sees it.
pub(crate) struct PointRows<'a> {
    pub(crate) weight: f64,
    /// Images that see the point.
    pub(crate) images: &'a [usize],
    /// For each of these images, derivatives with respect to the parameters, with their mean over the images subtracted.
    pub(crate) parameters: &'a [f64],
    /// For each of these images, derivatives with respect to its own unknowns; not used for the reference image.
    pub(crate) own: &'a [f64],
    /// For each of these images, the grey level minus the mean.
    pub(crate) residual: &'a [f64],
}

impl CalibrationEquations {
    pub(crate) fn zeros(layout: Layout) -> Self {
        let n = layout.len();
        Self {
            layout,
            matrix: vec![0.0; n * n],
            rhs: vec![0.0; n],
            squares: vec![[0.0; 2]; layout.images],
            parameter_energy: vec![0.0; layout.parameters],
            gradient_energy: 0.0,
            texture: [0.0; 3],
        }
    }

    /// Adds the sensitivities of a point to the parameters, before their mean is subtracted, and the sum of the squared
    /// gradients over the images.
    pub(crate) fn add_sensitivities(&mut self, weight: f64, parameters: &[f64], squared_gradient: f64) {
        for row in parameters.chunks_exact(self.layout.parameters.max(1)) {
            self.parameter_energy.iter_mut().zip(row).for_each(|(sum, s)| *sum += weight * s * s);
        }
        self.gradient_energy += 0.5 * weight * squared_gradient;
    }

    /// Adds the mean grey level of a point.
    pub(crate) fn add_texture(&mut self, weight: f64, mean: f64) {
        self.texture.iter_mut().zip([1.0, mean, mean * mean]).for_each(|(sum, m)| *sum += weight * m);
    }

    /// Adds a point. The unknown texture is the mean over the images, so the effect of an unknown of one image is reduced by
    /// its mean over all images.
    pub(crate) fn add(&mut self, rows: &PointRows<'_>) {
        let (np, num_images) = (self.layout.parameters, self.layout.images);
        let (n, nb, count) = (self.layout.len(), self.layout.block_len(), rows.images.len() as f64);
        debug_assert!(rows.images.iter().all(|&image| image < num_images));
        for (index, &image) in rows.images.iter().enumerate() {
            let c = &rows.parameters[index * np..(index + 1) * np];
            let r = rows.residual[index];
            self.squares[image][0] += rows.weight * r * r;
            self.squares[image][1] += rows.weight * (count - 1.0) / count;
            for i in 0..np {
                let wc = rows.weight * c[i];
                self.rhs[i] -= wc * r;
                for k in i..np {
                    self.matrix[i * n + k] += wc * c[k];
                }
            }
            if image == 0 {
                continue;
            }
            let block = self.layout.block(image);
            let m = &rows.own[index * nb..(index + 1) * nb];
            for (i, &c) in c.iter().enumerate() {
                let row = &mut self.matrix[i * n + block.start..i * n + block.end];
                row.iter_mut().zip(m).for_each(|(sum, m)| *sum += rows.weight * c * m);
            }
            for (k, &mk) in m.iter().enumerate() {
                let wm = rows.weight * mk;
                let at = block.start + k;
                self.rhs[at] -= wm * r;
                let own = &mut self.matrix[at * n + at..at * n + block.end];
                own.iter_mut().zip(&m[k..]).for_each(|(sum, other)| *sum += wm * other * (1.0 - 1.0 / count));
                for (later, &other) in rows.images.iter().enumerate().skip(index + 1) {
                    let start = at * n + self.layout.block(other).start;
                    let row = &mut self.matrix[start..start + nb];
                    let others = &rows.own[later * nb..(later + 1) * nb];
                    row.iter_mut().zip(others).for_each(|(sum, o)| *sum -= wm * o / count);
                }
            }
        }
    }

    /// Adds the equations of other points.
    pub(crate) fn add_equations(&mut self, other: &Self) {
        let add = |sums: &mut [f64], others: &[f64]| sums.iter_mut().zip(others).for_each(|(sum, o)| *sum += o);
        add(&mut self.matrix, &other.matrix);
        add(&mut self.rhs, &other.rhs);
        add(self.squares.as_flattened_mut(), other.squares.as_flattened());
        add(&mut self.parameter_energy, &other.parameter_energy);
        add(&mut self.texture, &other.texture);
        self.gradient_energy += other.gradient_energy;
    }

    /// Degrees of freedom of the residual, without the unknowns subtracted: the divisor of the variance.
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        self.squares.iter().map(|[_, degrees]| degrees).sum()
    }

    /// Variance of the residual per image, in grey levels squared; infinite if no two images see a point.
    pub(crate) fn residual_variance(&self) -> f64 {
        let degrees = self.degrees_of_freedom();
        let squares: f64 = self.squares.iter().map(|[squares, _]| squares).sum();
        if degrees > 0.0 { squares / degrees } else { f64::INFINITY }
    }

    /// Variance of the residual of one image; `None` if it shares no point with another image.
    pub(crate) fn image_variance(&self, image: usize) -> Option<f64> {
        let [squares, degrees] = self.squares[image];
        (degrees > 0.0).then(|| squares / degrees)
    }

    /// Variance of the texture over the mesh.
    pub(crate) fn texture_variance(&self) -> f64 {
        let [weight, sum, squares] = self.texture;
        (squares / weight - (sum / weight).powi(2)).max(0.0)
    }

    /// Returns whether at least the part `min_part` of the effect of a parameter remains after its mean over the images, which is
    /// a change of the texture, is subtracted.
    pub(crate) fn is_observable(&self, parameter: usize, min_part: f64) -> bool {
        let n = self.layout.len();
        self.matrix[parameter * n + parameter] > min_part * self.parameter_energy[parameter]
    }

    /// Normal matrix scaled to a diagonal of ones, and the scales. The scale of an unknown without effect is zero.
    pub(crate) fn scaled(&self) -> (DMatrix<f64>, DVector<f64>) {
        let n = self.layout.len();
        let entry = |r: usize, c: usize| self.matrix[r.min(c) * n + r.max(c)];
        let scale = DVector::from_fn(n, |i, _| {
            let d = entry(i, i);
            if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 }
        });
        let matrix = DMatrix::from_fn(n, n, |r, c| if r == c { 1.0 } else { entry(r, c) * scale[r] * scale[c] });
        (matrix, scale)
    }

    /// Normal matrix.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        let n = self.layout.len();
        DMatrix::from_fn(n, n, |r, c| self.matrix[r.min(c) * n + r.max(c)])
    }

    /// Levenberg-Marquardt step with `damping` relative to the diagonal and the prior standard deviation of each parameter.
    /// `None` if there is no finite step.
    pub(crate) fn step(&self, damping: f64, prior_deviations: &[f64]) -> Option<DVector<f64>> {
        let (mut matrix, scale) = self.scaled();
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += damping.max(MIN_DAMPING);
        }
        for (i, deviation) in prior_deviations.iter().enumerate() {
            matrix[(i, i)] += self.residual_variance() * (scale[i] / deviation).powi(2);
        }
        let factor: Cholesky<f64, Dyn> = matrix.cholesky()?;
        let rhs = DVector::from_fn(self.rhs.len(), |i, _| self.rhs[i] * scale[i]);
        let step = factor.solve(&rhs).component_mul(&scale);
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    /// RMS displacement of the image points caused by a step, along the gradient, in pixels of the level.
    pub(crate) fn rms_displacement(&self, step: &DVector<f64>) -> f64 {
        let mut geometric = step.clone();
        for image in 1..self.layout.images {
            let block = self.layout.block(image);
            geometric.rows_mut(block.start + self.layout.motion, self.layout.brightness).fill(0.0);
        }
        ((self.matrix() * &geometric).dot(&geometric).max(0.0) / self.gradient_energy).sqrt()
    }
}
