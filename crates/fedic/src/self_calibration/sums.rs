//! The normal equations of the camera, the motions and the brightness, and what is summed beside them.

use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Keeps directions that nothing determines from taking part in a step.
const LEAST_DAMPING: f64 = 1e-11;

/// Where each unknown stands: the parameters of the camera first, then a block for each moved image, of its motion and of
/// its gain and offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) parameters: usize,
    pub(crate) motion: usize,
    /// 2, or 0 where grey levels are compared as they are.
    pub(crate) brightness: usize,
    /// The reference image included.
    pub(crate) images: usize,
}

impl Layout {
    pub(crate) fn block_len(&self) -> usize {
        self.motion + self.brightness
    }

    pub(crate) fn len(&self) -> usize {
        self.parameters + (self.images - 1) * self.block_len()
    }

    /// The unknowns of an image other than the reference.
    pub(crate) fn block(&self, image: usize) -> Range<usize> {
        let first = self.parameters + (image - 1) * self.block_len();
        first..first + self.block_len()
    }
}

/// Sums over quadrature points.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    pub(crate) layout: Layout,
    /// Upper triangle, row after row.
    matrix: Vec<f64>,
    rhs: Vec<f64>,
    /// Squared residuals of each image, and their degrees of freedom.
    squares: Vec<[f64; 2]>,
    /// What each parameter moves in the images, before what the specimen's own surface absorbs: `sum w s^2`.
    energy: Vec<f64>,
    /// `sum w |q|^2 / 2` over points and images.
    slope: f64,
    /// `sum w`, `sum w m` and `sum w m^2` of the mean grey levels.
    texture: [f64; 3],
}

/// What one point adds: of the images that see it, the rows of the Jacobian.
pub(crate) struct PointRows<'a> {
    pub(crate) weight: f64,
    /// The images that see the point.
    pub(crate) seen: &'a [usize],
    /// For each of them the derivatives by the parameters, already less their mean.
    pub(crate) parameters: &'a [f64],
    /// For each of them the derivatives by its own unknowns; whatever for the reference.
    pub(crate) own: &'a [f64],
    /// For each of them the grey level less the mean.
    pub(crate) residual: &'a [f64],
}

impl Sums {
    pub(crate) fn zeros(layout: Layout) -> Self {
        let n = layout.len();
        Self {
            layout,
            matrix: vec![0.0; n * n],
            rhs: vec![0.0; n],
            squares: vec![[0.0; 2]; layout.images],
            energy: vec![0.0; layout.parameters],
            slope: 0.0,
            texture: [0.0; 3],
        }
    }

    /// Adds the sensitivities of a point: of the parameters before their mean is taken off, and the squared slope.
    pub(crate) fn add_energy(&mut self, weight: f64, parameters: &[f64], slope: f64) {
        for row in parameters.chunks_exact(self.layout.parameters.max(1)) {
            self.energy.iter_mut().zip(row).for_each(|(sum, s)| *sum += weight * s * s);
        }
        self.slope += 0.5 * weight * slope;
    }

    pub(crate) fn add_texture(&mut self, weight: f64, mean: f64) {
        self.texture.iter_mut().zip([1.0, mean, mean * mean]).for_each(|(sum, m)| *sum += weight * m);
    }

    /// Adds a point. The unknown texture is the mean over the images: what an unknown of one image changes there is
    /// taken off all of them.
    pub(crate) fn add(&mut self, rows: &PointRows<'_>) {
        let Layout { parameters: np, images, .. } = self.layout;
        let (n, nb, count) = (self.layout.len(), self.layout.block_len(), rows.seen.len() as f64);
        debug_assert!(rows.seen.iter().all(|&image| image < images));
        for (index, &image) in rows.seen.iter().enumerate() {
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
                for (later, &other) in rows.seen.iter().enumerate().skip(index + 1) {
                    let start = at * n + self.layout.block(other).start;
                    let row = &mut self.matrix[start..start + nb];
                    let others = &rows.own[later * nb..(later + 1) * nb];
                    row.iter_mut().zip(others).for_each(|(sum, o)| *sum -= wm * o / count);
                }
            }
        }
    }

    pub(crate) fn add_sums(&mut self, other: &Self) {
        let add = |sums: &mut [f64], others: &[f64]| sums.iter_mut().zip(others).for_each(|(sum, o)| *sum += o);
        add(&mut self.matrix, &other.matrix);
        add(&mut self.rhs, &other.rhs);
        add(self.squares.as_flattened_mut(), other.squares.as_flattened());
        add(&mut self.energy, &other.energy);
        add(&mut self.texture, &other.texture);
        self.slope += other.slope;
    }

    /// Degrees of freedom of the residual before any unknown is taken off: what the variance is divided by.
    pub(crate) fn freedom(&self) -> f64 {
        self.squares.iter().map(|[_, freedom]| freedom).sum()
    }

    /// Variance of the residual of one image, in grey levels squared; infinite where no two images see a point.
    pub(crate) fn variance(&self) -> f64 {
        let freedom = self.freedom();
        let squares: f64 = self.squares.iter().map(|[squares, _]| squares).sum();
        if freedom > 0.0 { squares / freedom } else { f64::INFINITY }
    }

    /// Variance of the residual of image `image`; `None` where no point of it is seen elsewhere.
    pub(crate) fn image_variance(&self, image: usize) -> Option<f64> {
        let [squares, freedom] = self.squares[image];
        (freedom > 0.0).then(|| squares / freedom)
    }

    /// Variance of the texture under the mesh.
    pub(crate) fn texture_variance(&self) -> f64 {
        let [weight, sum, squares] = self.texture;
        (squares / weight - (sum / weight).powi(2)).max(0.0)
    }

    /// Whether a parameter moves anything that the surface of the specimen does not absorb.
    pub(crate) fn is_visible(&self, parameter: usize, least: f64) -> bool {
        let n = self.layout.len();
        self.matrix[parameter * n + parameter] > least * self.energy[parameter]
    }

    /// The matrix scaled to a diagonal of ones, and the scales; one and zero where an unknown changes nothing.
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

    /// The matrix itself.
    pub(crate) fn matrix(&self) -> DMatrix<f64> {
        let n = self.layout.len();
        DMatrix::from_fn(n, n, |r, c| self.matrix[r.min(c) * n + r.max(c)])
    }

    /// The step that lowers the residual most, held back by `damping` relative to the diagonal and by what is known before:
    /// that parameter `i` is right within a standard deviation of `reach[i]`. `None` where there is none.
    pub(crate) fn step(&self, damping: f64, reach: &[f64]) -> Option<DVector<f64>> {
        let (mut matrix, scale) = self.scaled();
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += damping.max(LEAST_DAMPING);
        }
        for (i, reach) in reach.iter().enumerate() {
            matrix[(i, i)] += self.variance() * (scale[i] / reach).powi(2);
        }
        let factor: Cholesky<f64, Dyn> = matrix.cholesky()?;
        let rhs = DVector::from_fn(self.rhs.len(), |i, _| self.rhs[i] * scale[i]);
        let step = factor.solve(&rhs).component_mul(&scale);
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    /// Root mean square of what a step moves in the images, in their pixels.
    pub(crate) fn visible_motion(&self, step: &DVector<f64>) -> f64 {
        let mut geometric = step.clone();
        for image in 1..self.layout.images {
            let block = self.layout.block(image);
            geometric.rows_mut(block.start + self.layout.motion, self.layout.brightness).fill(0.0);
        }
        ((self.matrix() * &geometric).dot(&geometric).max(0.0) / self.slope).sqrt()
    }
}
