//! Reading the reference image at the quadrature points, and the Hessian that follows from it.

use fedic_camera::Camera;
use fedic_mesh::{CellType, MAX_NODES, Mesh, jacobian};
use rayon::prelude::*;

use crate::equations::cell_matrix::CellHessian;
use crate::interpolation::cell_prefetch::Ahead;
use crate::kernels::simd::{Readings, add_node_sums, moments, positions, pull_back, weighted_residuals};
use crate::observation::photometry::{Moments, counted_from};
use crate::observation::reference_samples::CellPointsMut;
use crate::observation::workspace::Work;
use crate::projection::cell_projection::CellView;
use crate::projection::projected_points::Sight;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::quadrature::shape_table::PART;
use crate::{COMPONENTS, Sampler};

/// The weights of a cell are taken as one if they differ by no more than this, relatively: below the resolution of `f32`.
const UNIFORM: f64 = 3e-8;
/// About how many nodes give the level from which grey levels are counted.
const PIVOT_NODES: usize = 1000;
/// Points whose weights are found at once.
const BLOCK: usize = 64;

/// What reading the reference image takes.
pub(crate) struct ReferenceReader<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) camera: &'a dyn Camera,
    pub(crate) quadrature: &'a CellQuadrature,
    pub(crate) image: &'a Sampler,
    pub(crate) views: &'a [Sight],
    /// Grey level from which moments are counted.
    pub(crate) pivot: f32,
}

/// What a cell adds to the system.
pub(crate) struct CellReading {
    pub(crate) hessian: CellHessian,
    pub(crate) moments: Moments,
    /// `sum w N^T q f`, its grey levels counted from the pivot, and `sum w N^T q`, by node.
    pub(crate) brightness: [[[f64; COMPONENTS]; MAX_NODES]; 2],
    /// Whether some of its points lie outside the image: they have no weight.
    pub(crate) outside: bool,
}

impl ReferenceReader<'_> {
    /// Fills the rows of a cell, whose weights `scale` multiplies.
    pub(crate) fn read_cell(
        &self,
        work: &mut Work,
        cell: usize,
        mut rows: CellPointsMut<'_>,
        scale: f64,
    ) -> CellReading {
        let count = self.quadrature.range(cell).len();
        let view = work.cells.view(self.mesh, cell, self.views, self.camera, None);
        work.resize(count);
        self.read(work, cell, &view, rows.value);
        let CellPointsMut { value, weights, .. } = &mut rows;
        if let Some(weights) = weights {
            self.weigh(cell, &mut weights[..count]);
        }
        let mut outside = false;
        for k in 0..count {
            if !value[k].is_nan() {
                continue;
            }
            outside = true;
            value[k] = 0.0;
            work.gradient.iter_mut().chain(&mut work.q).for_each(|along| along[k] = 0.0);
            if let Some(weights) = weights {
                weights[k] = 0.0;
            }
        }
        rows.keep_gradient(work.gradient.each_ref().map(|along| &**along));
        let reading = self.sum(work, cell, &view, &rows, scale, outside);
        if let Some(next) = Ahead::new(self.image.interpolator(), self.mesh, Some(cell + 1), self.views) {
            next.ask_upper();
            next.ask_lower();
        }
        reading
    }

    /// Grey levels at the points of a cell and, in `work.gradient`, gradients; where it has no expansion, `work.q` too.
    fn read(&self, work: &mut Work, cell: usize, view: &CellView<'_>, value: &mut [f32]) {
        let (cell_type, count) = (self.mesh.cell(cell).cell_type, self.quadrature.range(cell).len());
        let Some(expansion) = &view.expansion else {
            let (q, [along_u, along_v]) = (&mut work.q, &mut work.gradient);
            return view.for_each_batch(&mut work.batch, self.quadrature, cell, self.camera, |batch, points| {
                let gradient = [&mut along_u[points.clone()], &mut along_v[points.clone()]];
                batch.read(self.image, &mut value[points.clone()], gradient);
                for (k, point) in points.enumerate() {
                    for (c, q) in q.iter_mut().enumerate() {
                        q[point] = batch.pull_back(c, k, [along_u[point], along_v[point]]) as f32;
                    }
                }
            });
        };
        for first in (0..count).step_by(PART) {
            let part = first..count.min(first + PART);
            let rows = work.own_table.rows(self.quadrature, cell, cell_type, first);
            let [u, v] = work.pixel.each_mut().map(|row| &mut row[..rows.padded()]);
            positions(rows, expansion, u, v);
            let (u, v) = (&u[..part.len()], &v[..part.len()]);
            let gradient = work.gradient.each_mut().map(|along| &mut along[part.clone()]);
            self.image.values_and_gradients_near(expansion.origin, u, v, &mut value[part], gradient);
        }
    }

    /// Weights of the points of a cell, before what multiplies them all.
    fn weigh(&self, cell: usize, weights: &mut [f32]) {
        if self.quadrature.part_area(cell).is_none() {
            return weights.fill(1.0);
        }
        let (cell_type, nodes) = (self.mesh.cell(cell).cell_type, self.mesh.cell_points(cell));
        let (mut xi, mut eta) = ([0.0; BLOCK], [0.0; BLOCK]);
        for (block, weights) in weights.chunks_mut(BLOCK).enumerate() {
            let n = weights.len();
            self.quadrature.coordinates(cell, block * BLOCK, &mut xi[..n], &mut eta[..n]);
            for (k, weight) in weights.iter_mut().enumerate() {
                *weight = surface_element(cell_type, &nodes, [xi[k], eta[k]]) as f32;
            }
        }
    }

    /// Hessian and moments of a cell.
    fn sum(
        &self,
        work: &mut Work,
        cell: usize,
        view: &CellView<'_>,
        points: &CellPointsMut<'_>,
        scale: f64,
        outside: bool,
    ) -> CellReading {
        let cell_type = self.mesh.cell(cell).cell_type;
        let (value, weights) = (&*points.value, points.weights.as_deref());
        let mut hessian = CellHessian::new(cell_type.num_nodes());
        let mut brightness = [[[0.0; COMPONENTS]; MAX_NODES]; 2];
        let from = value.first().copied().unwrap_or_default();
        let mut levels = [0.0; 2];
        for first in (0..value.len()).step_by(PART) {
            let rows = work.own_table.rows(self.quadrature, cell, cell_type, first);
            let part = first..first + rows.padded();
            let weights = weights.map_or(rows.ones(), |weights| &weights[part.clone()]);
            let [x, y] = work.q.each_mut().map(|q| &mut q[part.clone()]);
            if let Some(expansion) = &view.expansion {
                let gradient = work.gradient.each_ref().map(|along| &along[part.clone()]);
                pull_back(rows, &expansion.jacobian, gradient, [&mut *x, &mut *y]);
            }
            hessian.add(rows, [x, y], weights);
            let value = &value[part];
            let weighted = &mut work.weighted[..rows.padded()];
            let from_pivot = [0.0, self.pivot];
            weighted_residuals(
                Readings { reference: value, deformed: value, weights, correction: from_pivot },
                weighted,
            );
            for (sums, factors) in brightness.iter_mut().zip([&*weighted, weights]) {
                add_node_sums(cell_type, rows, [&*x, &*y], factors, sums);
            }
            levels.iter_mut().zip(moments(value, weights, from)).for_each(|(sum, part)| *sum += part);
        }
        let count = self.quadrature.range(cell).len() as f64;
        let weight = weights.map_or(count, |weights| weights.iter().copied().map(f64::from).sum());
        let [f, ff] = counted_from(f64::from(self.pivot), levels, weight, f64::from(from));
        let [weight, f, ff] = [weight, f, ff].map(|sum| scale * sum);
        let moments = Moments { weight, f, ff, ..Moments::default() };
        hessian.scale(scale);
        brightness.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|sum| *sum *= scale);
        CellReading { hessian, moments, brightness, outside }
    }
}

/// What multiplies the weights of each cell, and whether they vary over it: they do where its map is not affine, and where points
/// may be dropped.
pub(crate) fn weighing(mesh: &Mesh, quadrature: &CellQuadrature, may_drop: bool) -> Vec<(f64, bool)> {
    let weighing = |cell: usize| {
        let Some(area) = quadrature.part_area(cell) else { return (1.0, may_drop) };
        let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let centre = surface_element(cell_type, &nodes, cell_type.reference_centre());
        let differs = |&at: &[f64; 2]| (surface_element(cell_type, &nodes, at) - centre).abs() > UNIFORM * centre;
        let varying = may_drop || cell_type.reference_nodes().iter().any(differs);
        (if varying { area } else { area * centre }, varying)
    };
    (0..mesh.num_cells()).into_par_iter().map(weighing).collect()
}

/// Mean grey level at some nodes: any number near the mean serves as pivot.
pub(crate) fn typical_level(image: &Sampler, views: &[Sight]) -> f32 {
    let some = views.iter().step_by(views.len().div_ceil(PIVOT_NODES).max(1));
    let (u, v): (Vec<f64>, Vec<f64>) = some.map(|view| (view.pixel[0], view.pixel[1])).unzip();
    let mut levels = vec![0.0; u.len()];
    let [mut along_u, mut along_v] = [levels.clone(), levels.clone()];
    image.values_and_gradients(&u, &v, &mut levels, [&mut along_u, &mut along_v]);
    levels.retain(|level| level.is_finite());
    if levels.is_empty() { 0.0 } else { levels.iter().sum::<f32>() / levels.len() as f32 }
}

/// Area of the cell per area of its reference domain at a point.
fn surface_element(cell_type: CellType, nodes: &[[f64; 3]], at: [f64; 2]) -> f64 {
    let [[xx, xy], [yx, yy], [zx, zy]] = jacobian(cell_type, nodes, at);
    let normal = [yx * zy - yy * zx, zx * xy - zy * xx, xx * yy - xy * yx];
    normal.iter().map(|c| c * c).sum::<f64>().sqrt()
}
