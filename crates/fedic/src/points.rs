//! What is kept of the reference image at the quadrature points, cell by cell.

use crate::cell_quadrature::CellQuadrature;
use crate::point_table::PADDING;

/// One number per point, those of a cell side by side and padded with zeros: a point costs 12 bytes, or 16. The numbers of one kind
/// lie together over all cells, so that memory is read straight on.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    value: Vec<f32>,
    gradient: [Vec<f32>; 2],
    /// Of the cells whose weights vary.
    weights: Vec<f32>,
    cells: Vec<CellEntry>,
}

#[derive(Debug, Clone, Copy)]
struct CellEntry {
    first: usize,
    first_weight: usize,
    padded: usize,
    varying: bool,
    scale: f64,
}

/// What is kept of the points of one cell.
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
    /// Room for the points of every cell, of which `weighing` gives what multiplies the weights and whether they vary; `None`
    /// where there is not enough.
    pub(crate) fn zeros(quadrature: &CellQuadrature, weighing: &[(f64, bool)]) -> Option<Self> {
        let (mut first, mut first_weight) = (0, 0);
        let mut cells = Vec::with_capacity(weighing.len());
        for (cell, &(scale, varying)) in weighing.iter().enumerate() {
            let padded = quadrature.range(cell).len().next_multiple_of(PADDING);
            cells.push(CellEntry { first, first_weight, padded, varying, scale });
            first += padded;
            first_weight += if varying { padded } else { 0 };
        }
        // Only a zeroed allocation leaves its pages to the threads that fill them; it is made once known to fit.
        Vec::<f32>::new().try_reserve_exact(3 * first + first_weight).ok()?;
        let zeros = || vec![0.0; first];
        Some(Self { value: zeros(), gradient: [zeros(), zeros()], weights: vec![0.0; first_weight], cells })
    }

    /// The numbers of every cell, and what multiplies its weights.
    pub(crate) fn cells_mut(&mut self) -> impl Iterator<Item = (CellPointsMut<'_>, f64)> {
        let [along_u, along_v] = &mut self.gradient;
        let mut rows = [&mut self.value, along_u, along_v, &mut self.weights].map(Vec::as_mut_slice);
        self.cells.iter().map(move |cell| {
            let mut take = |row: usize, count: usize| {
                let (taken, rest) = std::mem::take(&mut rows[row]).split_at_mut(count);
                rows[row] = rest;
                taken
            };
            let value = take(0, cell.padded);
            let gradient = [take(1, cell.padded), take(2, cell.padded)];
            let weights = cell.varying.then(|| take(3, cell.padded));
            (CellPointsMut { value, gradient, weights }, cell.scale)
        })
    }

    /// The numbers of one cell.
    pub(crate) fn cell(&self, cell: usize) -> CellPoints<'_> {
        let CellEntry { first, first_weight, padded, varying, scale } = self.cells[cell];
        let [along_u, along_v] = &self.gradient;
        let points = first..first + padded;
        CellPoints {
            value: &self.value[points.clone()],
            gradient: [&along_u[points.clone()], &along_v[points]],
            weights: varying.then(|| &self.weights[first_weight..first_weight + padded]),
            scale,
        }
    }
}

impl CellPoints<'_> {
    /// Area that point `k` stands for.
    pub(crate) fn weight(&self, k: usize) -> f64 {
        self.scale * self.weights.map_or(1.0, |weights| f64::from(weights[k]))
    }
}
