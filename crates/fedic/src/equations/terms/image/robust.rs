//! Robust weights of the points: a function of the residual, relative to a scale found from neighbouring cells.

use fedic_mesh::Mesh;

use crate::Robust;
use crate::equations::term::WeighedCell;

/// Standard deviation of normal numbers whose median magnitude is one.
const OF_MEDIAN: f64 = 1.4826;
/// Quantile of the median residuals of a cell and its neighbours that is the scale of the cell.
const NEIGHBOUR_QUANTILE: f64 = 0.6;
/// Smallest scale relative to the standard deviation of the reference image: rounding and interpolation.
const MIN_SCALE: f64 = 6e-3;
/// Residual, in units of the scale, that noise does not reach: from there on Tukey's weight is zero. The points of a cell are weighed
/// if one of them is as large.
const OUTLIER: f32 = 4.685;
/// Residual, in units of the scale, from which on Huber's weight falls.
const HUBER: f32 = 1.345;
/// Largest number of points of a cell whose median is taken.
const SAMPLES: usize = 128;
/// Factor on the scale of the first weights; it is halved after each pass with a small correction, down to one.
const FIRST_TOLERANCE: f64 = 8.0;

impl Robust {
    /// Weight of a residual in units of the scale.
    fn weight(self, u: f32) -> f32 {
        match self {
            Self::Huber => (HUBER / u.abs()).min(1.0),
            Self::Tukey => (1.0 - (u / OUTLIER).powi(2)).max(0.0).powi(2),
        }
    }

    /// Derivative of weight times residual.
    fn slope(self, u: f32) -> f32 {
        match self {
            Self::Huber => f32::from(u.abs() < HUBER),
            Self::Tukey => {
                let square = (u / OUTLIER).powi(2);
                if square < 1.0 { (1.0 - square) * (1.0 - 5.0 * square) } else { 0.0 }
            }
        }
    }

    /// Share of its weight below which a cell is damaged.
    pub(crate) fn min_kept(self) -> f64 {
        match self {
            Self::Huber => 0.8,
            Self::Tukey => 0.7,
        }
    }
}

/// Cells that share a node with each cell, itself included.
#[derive(Debug)]
pub(crate) struct CellNeighbours {
    starts: Vec<usize>,
    cells: Vec<u32>,
}

impl CellNeighbours {
    /// Neighbours of the cells of a mesh.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let mut of_node = vec![Vec::new(); mesh.num_nodes()];
        for (index, cell) in mesh.cells().enumerate() {
            cell.nodes.iter().for_each(|&node| of_node[node as usize].push(index as u32));
        }
        let mut found = Self { starts: vec![0], cells: Vec::new() };
        for cell in mesh.cells() {
            let mut neighbours: Vec<u32> =
                cell.nodes.iter().flat_map(|&node| of_node[node as usize].iter().copied()).collect();
            neighbours.sort_unstable();
            neighbours.dedup();
            found.cells.extend(neighbours);
            found.starts.push(found.cells.len());
        }
        found
    }

    fn of(&self, cell: usize) -> &[u32] {
        &self.cells[self.starts[cell]..self.starts[cell + 1]]
    }
}

/// Residuals of a cell: their median, and the median magnitude of their difference from the centre of all residuals. NaN without
/// points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellResiduals {
    median: f32,
    deviation: f32,
}

/// Robust weights of all points for one deformed image.
pub(crate) struct RobustWeights<'a> {
    function: Robust,
    neighbours: &'a CellNeighbours,
    min_scale: f64,
    /// Median of all residuals.
    centre: f32,
    /// Factor on the scale, which falls to one: a displacement or a light that is wrong at first is no damage.
    tolerance: f64,
    /// Scale of the residuals of each cell; empty before they were seen.
    scales: Vec<f32>,
    /// Weights of the points found last; absent in cells without outliers.
    weights: Vec<Option<Box<[f32]>>>,
    /// Cells that are left out.
    dropped: Vec<bool>,
}

impl<'a> RobustWeights<'a> {
    /// Weights before any residual was seen: one. `contrast` is the standard deviation of the reference image.
    pub(crate) fn new(function: Robust, neighbours: &'a CellNeighbours, contrast: f64) -> Self {
        Self {
            function,
            neighbours,
            min_scale: MIN_SCALE * contrast,
            centre: 0.0,
            tolerance: FIRST_TOLERANCE,
            scales: Vec::new(),
            weights: Vec::new(),
            dropped: vec![false; neighbours.starts.len() - 1],
        }
    }

    /// Share of its weight below which a cell is damaged.
    pub(crate) fn min_kept(&self) -> f64 {
        self.function.min_kept()
    }

    /// Makes the next weights stricter, until they are those of the scale of the residuals.
    pub(crate) fn tighten(&mut self) {
        self.tolerance = (0.5 * self.tolerance).max(1.0);
    }

    /// Whether the weights are those of the scale of the residuals. The first ones are those of a larger scale.
    pub(crate) fn is_strict(&self) -> bool {
        self.tolerance == 1.0
    }

    pub(crate) fn is_dropped(&self, cell: usize) -> bool {
        self.dropped[cell]
    }

    /// Leaves out some cells from now on, and returns the number of those that were not yet.
    pub(crate) fn drop_cells(&mut self, cells: impl IntoIterator<Item = usize>) -> usize {
        cells.into_iter().filter(|&cell| !std::mem::replace(&mut self.dropped[cell], true)).count()
    }

    /// Whether some point has another weight than one.
    pub(crate) fn is_active(&self) -> bool {
        self.dropped.contains(&true) || self.weights.iter().any(Option::is_some)
    }

    /// Weights of the points of a cell as found last.
    pub(crate) fn last(&self, cell: usize) -> Option<&[f32]> {
        self.weights.get(cell)?.as_deref()
    }

    /// Weights of the points of a cell with these residuals; `None` if no point is an outlier. Points of weight zero do not count.
    pub(crate) fn of_residuals(&self, cell: usize, residuals: &[f32], base: &[f32]) -> Option<Box<[f32]>> {
        let scale = *self.scales.get(cell)?;
        let inverse = 1.0 / scale;
        let outlier = |(k, r): (usize, &f32)| ((r - self.centre) * inverse).abs() > OUTLIER && base[k] > 0.0;
        if !residuals.iter().enumerate().any(outlier) {
            return None;
        }
        Some(residuals.iter().map(|r| self.function.weight((r - self.centre) * inverse)).collect())
    }

    /// Effect of weights on the residuals of a cell.
    pub(crate) fn effect(
        &self,
        cell: usize,
        residuals: &[f32],
        base: &[f32],
        weights: Option<&[f32]>,
    ) -> Option<WeighedCell> {
        let (weights, scale) = (weights?, *self.scales.get(cell)?);
        let [mut total, mut kept, mut slope, mut power, mut squared] = [0.0; 5];
        for (k, (&r, &weight)) in residuals.iter().zip(weights).enumerate() {
            let own = f64::from(base[k]);
            let residual = r - self.centre;
            total += own;
            kept += own * f64::from(weight);
            slope += own * f64::from(self.function.slope(residual / scale));
            power += own * f64::from(weight * residual).powi(2);
            squared += own * f64::from(weight).powi(2);
        }
        Some(WeighedCell { kept: kept / total, slope: slope / total, power: power / total, squared: squared / total })
    }

    /// Median residuals of a cell, of some of its points; NaN for a cell that is left out.
    pub(crate) fn residuals_of(&self, cell: usize, residuals: &[f32], base: &[f32]) -> CellResiduals {
        let nan = CellResiduals { median: f32::NAN, deviation: f32::NAN };
        if self.dropped[cell] {
            return nan;
        }
        let step = residuals.len().div_ceil(SAMPLES).max(1);
        let used = (0..residuals.len()).step_by(step).filter(|&k| base[k] > 0.0);
        let mut taken: Vec<f32> = used.map(|k| residuals[k]).collect();
        if taken.is_empty() {
            return nan;
        }
        let median = median(&mut taken);
        taken.iter_mut().for_each(|r| *r = (*r - self.centre).abs());
        CellResiduals { median, deviation: self::median(&mut taken) }
    }

    /// Finds centre and scales from the residuals of all cells.
    pub(crate) fn rescale(&mut self, cells: &[CellResiduals]) {
        let of_all = |value: fn(&CellResiduals) -> f32| {
            let mut values: Vec<f32> = cells.iter().map(value).filter(|value| !value.is_nan()).collect();
            if values.is_empty() { f32::NAN } else { median(&mut values) }
        };
        let (centre, deviation) = (of_all(|cell| cell.median), of_all(|cell| cell.deviation));
        if centre.is_nan() {
            return;
        }
        self.centre = centre;
        let least = (OF_MEDIAN * f64::from(deviation)).max(self.min_scale);
        self.scales = (0..cells.len())
            .map(|cell| {
                let around = self.neighbours.of(cell).iter().map(|&other| cells[other as usize].deviation);
                let mut around: Vec<f32> = around.filter(|deviation| !deviation.is_nan()).collect();
                around.sort_unstable_by(f32::total_cmp);
                let at = ((NEIGHBOUR_QUANTILE * around.len() as f64) as usize).min(around.len().saturating_sub(1));
                let scale = around.get(at).map_or(0.0, |&deviation| OF_MEDIAN * f64::from(deviation));
                (self.tolerance * scale.max(least)) as f32
            })
            .collect();
    }

    /// Weights of the points of all cells as found last; absent in cells without outliers.
    pub(crate) fn into_weights(self) -> Vec<Option<Box<[f32]>>> {
        self.weights
    }

    /// Takes note of the weights of all cells.
    pub(crate) fn keep(&mut self, weights: Vec<Option<Box<[f32]>>>) {
        self.weights = weights;
    }
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;

    #[test]
    fn slope_is_the_derivative_of_the_weighed_residual() {
        for function in Robust::ALL {
            for u in [-6.0_f32, -3.0, -1.0, 0.2, 1.2, 2.0, 4.0, 5.0] {
                let psi = |u: f32| function.weight(u) * u;
                let expected = (psi(u + 5e-3) - psi(u - 5e-3)) / 1e-2;
                assert!((function.slope(u) - expected).abs() < 2e-3, "{function} {u}");
            }
        }
    }

    #[test]
    fn cells_without_outliers_are_not_weighed() {
        let mesh = rectangle_mesh([0.0, 0.0, 3.0, 3.0], 1.0, CellType::Quad).unwrap();
        let neighbours = CellNeighbours::new(&mesh);
        assert_eq!(neighbours.of(4).len(), 9);
        let mut weights = RobustWeights::new(Robust::Tukey, &neighbours, 1.0);
        let ones = vec![1.0; 100];
        let residuals: Vec<f32> = (0..100).map(|k| ((k * 37 % 100) as f32 - 49.5) / 30.0).collect();
        assert!(weights.of_residuals(0, &residuals, &ones).is_none());
        let of_cells = vec![weights.residuals_of(0, &residuals, &ones); 9];
        (0..3).for_each(|_| weights.tighten());
        assert!(weights.is_strict());
        weights.rescale(&of_cells);
        assert!(weights.of_residuals(0, &residuals, &ones).is_none());
        let mut outlier = residuals.clone();
        outlier[7] = 20.0;
        let found = weights.of_residuals(0, &outlier, &ones).unwrap();
        assert!(found[7] == 0.0 && found[8] > 0.5);
        let mut base = vec![1.0; 100];
        base[7] = 0.0;
        assert!(weights.of_residuals(0, &outlier, &base).is_none());
        let effect = weights.effect(0, &outlier, &ones, Some(&found)).unwrap();
        assert!(effect.kept > 0.8 && effect.kept < 0.95 && effect.slope < effect.kept);
    }

    #[test]
    fn a_cell_left_out_counts_once_and_has_no_residuals() {
        let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad).unwrap();
        let neighbours = CellNeighbours::new(&mesh);
        let mut weights = RobustWeights::new(Robust::Huber, &neighbours, 1.0);
        assert_eq!((weights.drop_cells([1]), weights.drop_cells([1])), (1, 0));
        assert!(weights.is_dropped(1) && weights.residuals_of(1, &[1.0, 2.0], &[1.0, 1.0]).median.is_nan());
    }
}
