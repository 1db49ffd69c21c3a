//! Least-squares fit of a field to a function.

use nalgebra::DMatrix;

use super::basis::BasisFunctions;
use super::field::{SplineField, check_domain};
use crate::CameraError;

/// Samples per interval.
const SAMPLES: usize = 4;

impl SplineField {
    /// Fits a function by least squares over a grid of four points per interval; `None` if the function has no value at a
    /// point of the grid.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the domain is empty, there is no interval or a value is not finite.
    pub fn fit(
        domain: [f64; 4],
        intervals: [usize; 2],
        function: impl Fn([f64; 2]) -> Option<[f64; 2]>,
    ) -> Result<Option<Self>, CameraError> {
        check_domain(domain)?;
        let axis = |axis: usize| Sampling::new(domain[axis], domain[axis + 2], intervals[axis]);
        let (Some(along), Some(across)) = (axis(0), axis(1)) else {
            return Err(CameraError::SplineShape { intervals, got: 0 });
        };
        let mut samples = [(); 2].map(|()| DMatrix::zeros(across.positions.len(), along.positions.len()));
        for (row, &y) in across.positions.iter().enumerate() {
            for (column, &x) in along.positions.iter().enumerate() {
                let Some(value) = function([x, y]) else { return Ok(None) };
                samples.iter_mut().zip(value).for_each(|(samples, value)| samples[(row, column)] = value);
            }
        }
        let [x, y] = samples.map(|samples| &across.projection * samples * along.projection.transpose());
        let coefficients = x.transpose().iter().zip(y.transpose().iter()).map(|(&x, &y)| [x, y]).collect();
        Self::new(domain, intervals, coefficients).map(Some)
    }
}

/// Sampling of one axis.
struct Sampling {
    positions: Vec<f64>,
    /// Least-squares projection from samples to coefficients.
    projection: DMatrix<f64>,
}

impl Sampling {
    /// `None` if there is no interval.
    fn new(start: f64, end: f64, intervals: usize) -> Option<Self> {
        let last = SAMPLES * intervals;
        let mut basis = DMatrix::zeros(last + 1, intervals + 3);
        let mut positions = Vec::with_capacity(last + 1);
        for row in 0..if intervals > 0 { last + 1 } else { 0 } {
            positions.push(start + (end - start) * row as f64 / last as f64);
            let at = BasisFunctions::new(row as f64 / SAMPLES as f64, intervals, 1.0);
            at.values.into_iter().enumerate().for_each(|(i, value)| basis[(row, at.first + i)] = value);
        }
        let projection = (basis.transpose() * &basis).cholesky()?.solve(&basis.transpose());
        Some(Self { positions, projection })
    }
}
