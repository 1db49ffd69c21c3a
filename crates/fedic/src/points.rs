//! What is kept of the reference image at the quadrature points, cell by cell.

use crate::cell_quadrature::CellQuadrature;
use crate::point_table::PADDING;

/// Rows of one number per point, those of a cell together: grey level, gradient along `u` and along `v`, and the weight where
/// it varies over the cell. Rows are padded with zeros: a point costs 12 bytes, or 16.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    data: Vec<f32>,
    /// Where the rows of each cell begin.
    starts: Vec<usize>,
    /// What multiplies the weights of each cell.
    scales: Vec<f64>,
    varying: Vec<bool>,
}

/// The rows of one cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellPoints<'a> {
    /// `f(P(X))`.
    pub(crate) value: &'a [f32],
    /// `grad f(P(X))`, per pixel along `u` and `v`.
    pub(crate) gradient: [&'a [f32]; 2],
    /// Weights, to be multiplied by `scale`; one each where there are none.
    pub(crate) weights: Option<&'a [f32]>,
    /// Area that a point of weight one stands for: in the mesh's unit squared, or one pixel.
    pub(crate) scale: f64,
}

/// The same, to be filled.
pub(crate) struct CellPointsMut<'a> {
    pub(crate) value: &'a mut [f32],
    pub(crate) gradient: [&'a mut [f32]; 2],
    pub(crate) weights: Option<&'a mut [f32]>,
}

impl Points {
    /// Room for the points of every cell; `scales` are what multiplies its weights, `varying` says whether it has some.
    pub(crate) fn zeros(quadrature: &CellQuadrature, scales: Vec<f64>, varying: Vec<bool>) -> Option<Self> {
        let mut starts = Vec::with_capacity(varying.len() + 1);
        let mut end = 0;
        starts.push(0);
        for (cell, &varying) in varying.iter().enumerate() {
            end += quadrature.range(cell).len().next_multiple_of(PADDING) * (3 + usize::from(varying));
            starts.push(end);
        }
        // Only a zeroed allocation leaves its pages to the threads that fill them; it is asked for once known to fit.
        Vec::<f32>::new().try_reserve_exact(end).ok()?;
        Some(Self { data: vec![0.0; end], starts, scales, varying })
    }

    /// The rows of every cell.
    pub(crate) fn cells_mut(&mut self) -> impl Iterator<Item = CellPointsMut<'_>> {
        let mut rest = self.data.as_mut_slice();
        self.starts.windows(2).zip(&self.varying).map(move |(ends, &varying)| {
            let (rows, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            let padded = rows.len() / (3 + usize::from(varying));
            let (value, rows) = rows.split_at_mut(padded);
            let (along_u, rows) = rows.split_at_mut(padded);
            let (along_v, weights) = rows.split_at_mut(padded);
            CellPointsMut { value, gradient: [along_u, along_v], weights: varying.then_some(weights) }
        })
    }

    /// The rows of one cell.
    pub(crate) fn cell(&self, cell: usize) -> CellPoints<'_> {
        let rows = &self.data[self.starts[cell]..self.starts[cell + 1]];
        let padded = rows.len() / (3 + usize::from(self.varying[cell]));
        let row = |index: usize| &rows[index * padded..(index + 1) * padded];
        CellPoints {
            value: row(0),
            gradient: [row(1), row(2)],
            weights: self.varying[cell].then(|| row(3)),
            scale: self.scales[cell],
        }
    }
}

impl CellPoints<'_> {
    /// Area that point `k` stands for.
    pub(crate) fn weight(&self, k: usize) -> f64 {
        self.scale * self.weights.map_or(1.0, |weights| f64::from(weights[k]))
    }
}
