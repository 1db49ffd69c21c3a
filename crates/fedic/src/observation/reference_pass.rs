//! One pass over the cells that samples the reference image and forms the Hessian at the reference position.

use fedic_camera::Camera;
use fedic_mesh::{MAX_NODES, Mesh};

use crate::interpolation::cell_prefetch::CellPrefetch;
use crate::interpolation::image_sampler::ImageSampler;
use crate::kernels::cell_matrix::CellMatrix;
use crate::kernels::gradient::LinearJacobian;
use crate::kernels::node_sums::add_node_sums;
use crate::kernels::residual::{GreyLevels, moments, weighted_residuals};
use crate::observation::cell_context::{CellContext, ImagePoints, exact_sensitivity, linear_sensitivity};
use crate::observation::photometry::{Moments, change_origin};
use crate::observation::pixel_mask::PixelMask;
use crate::observation::reference_samples::CellSamplesMut;
use crate::observation::used_points::{is_too_few, saturated_from};
use crate::observation::weights::fill_weights;
use crate::observation::workspace::Workspace;
use crate::projection::cell_edges::CellEdges;
use crate::projection::polynomial_basis::PolynomialBasis;
use crate::projection::projected_points::{ProjectedPoint, pixel_bounds};
use crate::quadrature::cell_quadrature::CellQuadrature;

/// Largest number of nodes that the grey-level origin is averaged over.
const ORIGIN_NODES: usize = 1000;

/// Input of the pass.
pub(crate) struct ReferencePass<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) camera: &'a dyn Camera,
    pub(crate) quadrature: &'a CellQuadrature,
    pub(crate) image: &'a ImageSampler,
    pub(crate) nodes: &'a [ProjectedPoint],
    /// Origin of the grey levels in moments.
    pub(crate) grey_origin: f32,
    /// Pixels whose points get no weight.
    pub(crate) mask: Option<&'a PixelMask>,
    /// Full scale and saturated pixels, whose points get no weight.
    pub(crate) saturation: Option<&'a (f32, PixelMask)>,
    /// Cuts of the mesh, and the distance from them up to which points get no weight.
    pub(crate) cuts: Option<&'a (CellEdges, f64)>,
}

/// Sums over the points of a cell.
pub(crate) struct ReferenceSums<const D: usize> {
    pub(crate) matrix: CellMatrix<D>,
    pub(crate) moments: Moments,
    /// Sum of the weights of all points, those left out as well.
    pub(crate) full_weight: f64,
    /// `sum w N^T q f`, grey levels counted from the origin, and `sum w N^T q`, by node.
    pub(crate) photometric: [[[f64; D]; MAX_NODES]; 2],
    /// Jacobian of the camera over the cell; `None` where it is not nearly linear.
    pub(crate) jacobian: Option<LinearJacobian<D>>,
    /// Whether some points lie outside the image. They get no weight, as those that are masked or saturated.
    pub(crate) outside: bool,
}

impl ReferencePass<'_> {
    /// Samples the points of a cell and sums over them; `scale` multiplies the weights.
    pub(crate) fn sample_cell<const D: usize>(
        &self,
        workspace: &mut Workspace<D>,
        cell: usize,
        mut samples: CellSamplesMut<'_>,
        scale: f64,
    ) -> ReferenceSums<D> {
        let context = CellContext {
            cell,
            cell_type: self.mesh.cell(cell).cell_type,
            quadrature: self.quadrature,
            camera: self.camera,
            projection: workspace.projections.project(self.mesh, cell, self.nodes, self.camera, None),
        };
        workspace.points.resize(context.count());
        self.evaluate(workspace, &context, samples.value);
        let weighed = self.weigh(workspace, &context, &mut samples);
        samples.store_gradient(workspace.points.gradient.each_ref().map(|along| &**along));
        let sums = self.sum(workspace, &context, &samples, scale, &weighed);
        if let Some(next) = CellPrefetch::new(self.image.interpolator(), self.mesh, Some(cell + 1), self.nodes) {
            next.prefetch_upper_half();
            next.prefetch_lower_half();
        }
        sums
    }

    /// Evaluates grey levels and gradients, and sensitivities where the cell has no polynomial. The grey level is infinite at masked
    /// and saturated points.
    fn evaluate<const D: usize>(&self, workspace: &mut Workspace<D>, context: &CellContext<'_, D>, value: &mut [f32]) {
        let Workspace { projector, points: buffers, .. } = workspace;
        let ([along_u, along_v], q) = (&mut buffers.gradient, &mut buffers.q);
        let touches = |mask: &PixelMask| touches_cell(mask, self.mesh.cell(context.cell).nodes, self.nodes);
        let mask = self.mask.filter(|mask| touches(mask));
        let saturation = self.saturation.filter(|(_, pixels)| touches(pixels));
        let saturated = saturation.map(|&(full_scale, _)| saturated_from(full_scale));
        let cuts = self.cuts.filter(|(cuts, _)| cuts.has(context.cell));
        let clear_cut = |value: &mut [f32], at: &dyn Fn(usize) -> (f64, f64)| {
            let Some((cuts, margin)) = cuts else { return };
            for (k, value) in value.iter_mut().enumerate() {
                let (u, v) = at(k);
                if cuts.distances(context.cell, [u, v]).any(|distance| distance < *margin) {
                    *value = f32::INFINITY;
                }
            }
        };
        context.for_each_projection(projector, |image_points, points| {
            let gradient = [&mut along_u[points.clone()], &mut along_v[points.clone()]];
            let value = &mut value[points.clone()];
            match image_points {
                ImagePoints::Near { origin, u, v } => {
                    self.image.values_and_gradients_near(origin, u, v, value, gradient);
                    let [column, row] = origin.map(|c| c as f64);
                    let at = |k: usize| (column + f64::from(u[k]), row + f64::from(v[k]));
                    mark(value, mask, saturated, at);
                    clear_cut(value, &at);
                }
                ImagePoints::Exact(batch) => {
                    let [u, v] = batch.pixels();
                    self.image.values_and_gradients(u, v, value, gradient);
                    mark(value, mask, saturated, |k| (u[k], v[k]));
                    clear_cut(value, &|k| (u[k], v[k]));
                    exact_sensitivity(batch, points, |k| [along_u[k], along_v[k]], q);
                }
            }
        });
    }

    /// Writes the weights where they vary, and clears the points that get none: all of them if too few are left.
    fn weigh<const D: usize>(
        &self,
        workspace: &mut Workspace<D>,
        context: &CellContext<'_, D>,
        samples: &mut CellSamplesMut<'_>,
    ) -> Weighed {
        let count = context.count();
        let CellSamplesMut { value, weights, .. } = samples;
        if let Some(weights) = weights {
            fill_weights(self.mesh, self.quadrature, context.cell, &mut weights[..count]);
        }
        let buffers = &mut workspace.points;
        let total = |weights: &[f32]| weights[..count].iter().copied().map(f64::from).sum();
        let full_weight = weights.as_deref().map_or(count as f64, total);
        let (mut outside, mut used) = (false, count);
        for k in 0..count {
            if value[k].is_finite() {
                continue;
            }
            outside |= value[k].is_nan();
            used -= 1;
            value[k] = 0.0;
            buffers.gradient.iter_mut().chain(&mut buffers.q).for_each(|along| along[k] = 0.0);
            if let Some(weights) = weights {
                weights[k] = 0.0;
            }
        }
        if let Some(weights) = weights
            && used < count
            && is_too_few(used, count, context.cell_type, D)
        {
            weights.fill(0.0);
        }
        Weighed { full_weight, outside }
    }

    fn sum<const D: usize>(
        &self,
        workspace: &mut Workspace<D>,
        context: &CellContext<'_, D>,
        samples: &CellSamplesMut<'_>,
        scale: f64,
        weighed: &Weighed,
    ) -> ReferenceSums<D> {
        let basis = PolynomialBasis::of(context.cell_type);
        let (value, weights) = (&*samples.value, samples.weights.as_deref());
        let mut matrix = CellMatrix::zeros(context.cell_type.num_nodes());
        let mut photometric = [[[0.0; D]; MAX_NODES]; 2];
        let origin = value.first().copied().unwrap_or_default();
        let mut levels = [0.0; 2];
        let jacobian = context.projection.polynomial.map(|polynomial| polynomial.jacobian);
        let Workspace { projector, points: buffers, weighted, .. } = workspace;
        context.for_each_chunk(&mut projector.shapes, |chunk, points| {
            let weights = weights.map_or(chunk.ones(), |weights| &weights[points.clone()]);
            if let Some(jacobian) = &jacobian {
                let gradient = buffers.gradient.each_ref().map(|along| &along[points.clone()]);
                let q = buffers.q.each_mut().map(|q| &mut q[points.clone()]);
                linear_sensitivity(chunk, jacobian, 1.0, gradient, q);
            }
            let q = buffers.q.each_ref().map(|q| &q[points.clone()]);
            matrix.add(chunk, q, weights);
            let value = &value[points];
            let weighted = &mut weighted[..chunk.padded()];
            // The residual against a zero image with the origin as offset is the grey level counted from the origin.
            let from_origin = [0.0, self.grey_origin];
            weighted_residuals(
                GreyLevels { reference: value, deformed: value, weights, gain_offset: from_origin },
                weighted,
            );
            for (sums, factors) in photometric.iter_mut().zip([&*weighted, weights]) {
                add_node_sums(basis.shape_monomials(), chunk, q, factors, sums);
            }
            levels.iter_mut().zip(moments(value, weights, origin)).for_each(|(sum, part)| *sum += part);
        });
        let count = context.count() as f64;
        let weight = weights.map_or(count, |weights| weights.iter().copied().map(f64::from).sum());
        let [f, ff] = change_origin(f64::from(self.grey_origin), levels, weight, f64::from(origin));
        let [weight, f, ff] = [weight, f, ff].map(|sum| scale * sum);
        matrix.scale(scale);
        photometric.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|sum| *sum *= scale);
        ReferenceSums {
            matrix,
            moments: Moments { weight, f, ff, ..Moments::default() },
            full_weight: scale * weighed.full_weight,
            photometric,
            jacobian,
            outside: weighed.outside,
        }
    }
}

/// Weights of a cell.
struct Weighed {
    /// Sum of the weights of all points.
    full_weight: f64,
    /// Whether some points lie outside the image.
    outside: bool,
}

/// Whether a masked pixel lies near a cell: within the box of its nodes and a quarter more, as edges may be curved.
pub(crate) fn touches_cell(mask: &PixelMask, of_cell: &[u32], nodes: &[ProjectedPoint]) -> bool {
    let [u, v] = pixel_bounds(of_cell.iter().map(|&node| &nodes[node as usize]));
    let margin = [u, v].map(|[low, high]| 0.25 * (high - low) + 1.0);
    mask.touches([u[0] - margin[0], v[0] - margin[1]], [u[1] + margin[0], v[1] + margin[1]])
}

/// Makes the grey levels of masked and saturated points infinite; `at` gives the image point of each.
fn mark(value: &mut [f32], mask: Option<&PixelMask>, saturated: Option<f32>, at: impl Fn(usize) -> (f64, f64)) {
    if let Some(level) = saturated {
        value.iter_mut().filter(|value| **value >= level).for_each(|value| *value = f32::INFINITY);
    }
    let Some(mask) = mask else { return };
    for (k, value) in value.iter_mut().enumerate() {
        let (u, v) = at(k);
        if value.is_finite() && mask.covers(u, v) {
            *value = f32::INFINITY;
        }
    }
}

/// Mean grey level at some nodes. Any level near the mean serves as origin of the grey levels.
pub(crate) fn typical_grey_level(image: &ImageSampler, nodes: &[ProjectedPoint]) -> f32 {
    let some = nodes.iter().step_by(nodes.len().div_ceil(ORIGIN_NODES).max(1));
    let (u, v): (Vec<f64>, Vec<f64>) = some.map(|node| (node.pixel[0], node.pixel[1])).unzip();
    let mut levels = vec![0.0; u.len()];
    let [mut along_u, mut along_v] = [levels.clone(), levels.clone()];
    image.values_and_gradients(&u, &v, &mut levels, [&mut along_u, &mut along_v]);
    levels.retain(|level| level.is_finite());
    if levels.is_empty() { 0.0 } else { levels.iter().sum::<f32>() / levels.len() as f32 }
}
