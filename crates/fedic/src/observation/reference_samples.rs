//! What is kept of the reference image at the quadrature points, cell by cell.

use fedic_memory::{AlignedBuffer, prefetch};

use crate::kernels::simd::largest;
use crate::observation::quantized_gradient::{MOST_STEPS, Steps, StepsMut};
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::quadrature::shape_table::PADDING;

/// Most points whose numbers are asked for at once.
const MOST_ASKED: usize = 1024;

/// One number per point, those of a cell side by side and padded with zeros: a point costs 9 bytes, or 13. The numbers of one kind
/// lie together over all cells, so that memory is read straight on.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    value: AlignedBuffer<f32>,
    /// In whole steps: gradients only weigh residuals.
    coarse: [AlignedBuffer<i16>; 2],
    fine: AlignedBuffer<u8>,
    /// The step of each cell, of which its largest gradient makes [`MOST_STEPS`].
    steps: Vec<f32>,
    /// Of the cells whose weights vary.
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

/// What is kept of the points of one cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellPoints<'a> {
    /// `f(P(X))`.
    pub(crate) value: &'a [f32],
    /// `grad f(P(X))`, per pixel along `u` and `v`, in steps.
    pub(crate) gradient: Steps<'a>,
    pub(crate) step: f32,
    /// Weights, to be multiplied by `scale`; one each where there are none.
    pub(crate) weights: Option<&'a [f32]>,
    /// Area that a point of weight one stands for: in the mesh's unit squared, or one pixel.
    pub(crate) scale: f64,
}

/// The same, to be filled.
pub(crate) struct CellPointsMut<'a> {
    pub(crate) value: &'a mut [f32],
    gradient: StepsMut<'a>,
    step: &'a mut f32,
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
        let point = size_of::<f32>() + 2 * size_of::<i16>() + size_of::<u8>();
        Vec::<u8>::new().try_reserve_exact(point * first + size_of::<f32>() * first_weight).ok()?;
        let [value, weights] = [first, first_weight].map(AlignedBuffer::zeros);
        let coarse = [AlignedBuffer::zeros(first), AlignedBuffer::zeros(first)];
        Some(Self { value, coarse, fine: AlignedBuffer::zeros(first), steps: vec![0.0; cells.len()], weights, cells })
    }

    /// The numbers of every cell, and what multiplies its weights.
    pub(crate) fn cells_mut(&mut self) -> impl Iterator<Item = (CellPointsMut<'_>, f64)> {
        let mut coarse = self.coarse.each_mut().map(|along| &mut **along);
        let mut fine = &mut *self.fine;
        let (mut value, mut weights) = (&mut *self.value, &mut *self.weights);
        self.cells.iter().zip(&mut self.steps).map(move |(cell, step)| {
            let rows = CellPointsMut {
                value: take(&mut value, cell.padded),
                gradient: StepsMut {
                    coarse: coarse.each_mut().map(|along| take(along, cell.padded)),
                    fine: take(&mut fine, cell.padded),
                },
                step,
                weights: cell.varying.then(|| take(&mut weights, cell.padded)),
            };
            (rows, cell.scale)
        })
    }

    /// Asks the memory for the grey levels of a cell that will be read next.
    pub(crate) fn prefetch_value(&self, cell: usize) {
        let (first, count) = self.asked(cell);
        prefetch(&self.value, first, count);
    }

    /// The same for its gradients.
    pub(crate) fn prefetch_gradient(&self, cell: usize) {
        let (first, count) = self.asked(cell);
        self.coarse.iter().for_each(|along| prefetch(along, first, count));
        prefetch(&self.fine, first, count);
    }

    /// The first point of a cell and how many there are, or may be asked for at once.
    fn asked(&self, cell: usize) -> (usize, usize) {
        let CellEntry { first, padded, .. } = self.cells[cell];
        (first, padded.min(MOST_ASKED))
    }

    /// The numbers of one cell.
    pub(crate) fn cell(&self, cell: usize) -> CellPoints<'_> {
        let CellEntry { first, first_weight, padded, varying, scale } = self.cells[cell];
        let points = first..first + padded;
        CellPoints {
            value: &self.value[points.clone()],
            gradient: Steps { coarse: self.coarse.each_ref().map(|along| &**along), fine: &self.fine }.part(points),
            step: self.steps[cell],
            weights: varying.then(|| &self.weights[first_weight..first_weight + padded]),
            scale,
        }
    }
}

impl CellPointsMut<'_> {
    /// Keeps the gradients of the points.
    pub(crate) fn keep_gradient(&mut self, gradient: [&[f32]; 2]) {
        *self.step = largest(gradient[0]).max(largest(gradient[1])) / MOST_STEPS;
        self.gradient.fill(gradient, *self.step);
    }
}

impl CellPoints<'_> {
    /// Gradient at point `k`, per pixel along `u` and `v`.
    pub(crate) fn gradient_at(&self, k: usize) -> [f32; 2] {
        self.gradient.at(k).map(|steps| self.step * steps)
    }

    /// Area that point `k` stands for.
    pub(crate) fn weight(&self, k: usize) -> f64 {
        self.scale * self.weights.map_or(1.0, |weights| f64::from(weights[k]))
    }
}

/// Takes the first `count` numbers off a row.
fn take<'a, T>(row: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (taken, rest) = std::mem::take(row).split_at_mut(count);
    *row = rest;
    taken
}
