//! Grey levels, gradients and weights of the reference image at the quadrature points.

use fedic_memory::{AlignedBuffer, is_available, prefetch};

use crate::kernels::gradient::largest_magnitude;
use crate::observation::quantized_gradient::{MAX_LEVEL, QuantizedGradient, QuantizedGradientMut};
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::quadrature::shape_table::PADDING;

/// Largest number of points prefetched at once.
const MAX_PREFETCHED: usize = 1024;

/// One array per quantity over all points, those of a cell adjacent and padded with zeros. A point takes 9 bytes, or 13 in a cell
/// of varying weights.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceSamples {
    value: AlignedBuffer<f32>,
    /// Quantised: gradients only weigh residuals.
    high: [AlignedBuffer<i16>; 2],
    low: AlignedBuffer<u8>,
    /// Quantisation step of each cell: its largest gradient is [`MAX_LEVEL`] steps.
    steps: Vec<f32>,
    /// Weights in the cells where they vary.
    weights: AlignedBuffer<f32>,
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

/// Samples of one cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellSamples<'a> {
    /// `f(P(X))`.
    pub(crate) value: &'a [f32],
    /// `grad f(P(X))`, per pixel along `u` and `v`, in units of `step`.
    pub(crate) gradient: QuantizedGradient<'a>,
    pub(crate) step: f32,
    /// Weights, to be multiplied by `scale`; `None` if all are one.
    pub(crate) weights: Option<&'a [f32]>,
    /// Area of a point of weight one: in the mesh's unit squared, or one pixel.
    pub(crate) scale: f64,
}

/// Samples of one cell, to be written.
pub(crate) struct CellSamplesMut<'a> {
    pub(crate) value: &'a mut [f32],
    gradient: QuantizedGradientMut<'a>,
    step: &'a mut f32,
    pub(crate) weights: Option<&'a mut [f32]>,
}

impl ReferenceSamples {
    /// Allocates the samples of every cell. `cell_weights` gives the scale of the weights of each cell and whether they vary.
    /// `None` if there is not enough memory.
    pub(crate) fn zeros(quadrature: &CellQuadrature, cell_weights: &[(f64, bool)]) -> Option<Self> {
        let (mut first, mut first_weight) = (0, 0);
        let mut cells = Vec::with_capacity(cell_weights.len());
        for (cell, &(scale, varying)) in cell_weights.iter().enumerate() {
            let padded = quadrature.range(cell).len().next_multiple_of(PADDING);
            cells.push(CellEntry { first, first_weight, padded, varying, scale });
            first += padded;
            first_weight += if varying { padded } else { 0 };
        }
        // Only a zeroed allocation leaves its pages to the threads that write them. Whether it fits is tried first.
        let point = size_of::<f32>() + 2 * size_of::<i16>() + size_of::<u8>();
        if !is_available(point * first + size_of::<f32>() * first_weight) {
            return None;
        }
        let [value, weights] = [first, first_weight].map(AlignedBuffer::zeros);
        let high = [AlignedBuffer::zeros(first), AlignedBuffer::zeros(first)];
        Some(Self { value, high, low: AlignedBuffer::zeros(first), steps: vec![0.0; cells.len()], weights, cells })
    }

    /// Samples of every cell to be written, with the scale of its weights.
    pub(crate) fn cells_mut(&mut self) -> impl Iterator<Item = (CellSamplesMut<'_>, f64)> {
        let mut high = self.high.each_mut().map(|along| &mut **along);
        let mut low = &mut *self.low;
        let (mut value, mut weights) = (&mut *self.value, &mut *self.weights);
        self.cells.iter().zip(&mut self.steps).map(move |(cell, step)| {
            let rows = CellSamplesMut {
                value: take(&mut value, cell.padded),
                gradient: QuantizedGradientMut {
                    high: high.each_mut().map(|along| take(along, cell.padded)),
                    low: take(&mut low, cell.padded),
                },
                step,
                weights: cell.varying.then(|| take(&mut weights, cell.padded)),
            };
            (rows, cell.scale)
        })
    }

    /// Prefetches the grey levels of a cell.
    pub(crate) fn prefetch_value(&self, cell: usize) {
        let (first, count) = self.prefetched(cell);
        prefetch(&self.value, first, count);
    }

    /// Prefetches the gradients of a cell.
    pub(crate) fn prefetch_gradient(&self, cell: usize) {
        let (first, count) = self.prefetched(cell);
        self.high.iter().for_each(|along| prefetch(along, first, count));
        prefetch(&self.low, first, count);
    }

    /// First point of a cell and number of points to prefetch.
    fn prefetched(&self, cell: usize) -> (usize, usize) {
        let CellEntry { first, padded, .. } = self.cells[cell];
        (first, padded.min(MAX_PREFETCHED))
    }

    /// Samples of one cell.
    pub(crate) fn cell(&self, cell: usize) -> CellSamples<'_> {
        let CellEntry { first, first_weight, padded, varying, scale } = self.cells[cell];
        let points = first..first + padded;
        CellSamples {
            value: &self.value[points.clone()],
            gradient: QuantizedGradient { high: self.high.each_ref().map(|along| &**along), low: &self.low }
                .part(points),
            step: self.steps[cell],
            weights: varying.then(|| &self.weights[first_weight..first_weight + padded]),
            scale,
        }
    }
}

impl CellSamplesMut<'_> {
    /// Quantises and stores the gradients of the points.
    pub(crate) fn store_gradient(&mut self, gradient: [&[f32]; 2]) {
        *self.step = largest_magnitude(gradient[0]).max(largest_magnitude(gradient[1])) / MAX_LEVEL;
        self.gradient.fill(gradient, *self.step);
    }
}

impl CellSamples<'_> {
    /// Gradient at point `k`, per pixel along `u` and `v`.
    pub(crate) fn gradient_at(&self, k: usize) -> [f32; 2] {
        self.gradient.at(k).map(|level| self.step * level)
    }

    /// Weight of point `k`: the area that it stands for.
    pub(crate) fn weight(&self, k: usize) -> f64 {
        self.scale * self.weights.map_or(1.0, |weights| f64::from(weights[k]))
    }
}

/// Splits the first `count` entries off a row.
fn take<'a, T>(row: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (taken, rest) = std::mem::take(row).split_at_mut(count);
    *row = rest;
    taken
}
