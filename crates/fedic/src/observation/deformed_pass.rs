//! Evaluation of the deformed image at the points of one cell.

use fedic_image::Interpolator;

use crate::interpolation::cell_prefetch::CellPrefetch;
use crate::kernels::residual::moments;
use crate::observation::cell_context::{CellContext, ImagePoints};
use crate::observation::observe::Observation;
use crate::observation::photometry::{Moments, change_origin};
use crate::observation::workspace::{UnsharedShapeTable, Workspace};

/// Moments of both images over a cell.
pub(crate) struct DeformedCell {
    pub(crate) moments: Moments,
    /// Whether some points lie outside the deformed image.
    pub(crate) outside: bool,
}

/// Evaluates the deformed image at the points of a cell.
///
/// The grey levels are left in `workspace.points.grey`. If some points lie outside the image, `workspace.points.weights` holds the
/// weights of all points, zero for these.
pub(crate) fn read_deformed<const D: usize>(
    observation: &Observation<D>,
    deformed: &Interpolator,
    workspace: &mut Workspace<D>,
    context: &CellContext<'_, D>,
    next: Option<&CellPrefetch<'_>>,
) -> DeformedCell {
    let (cell, count) = (context.cell, context.count());
    let samples = observation.samples.cell(cell);
    let Workspace { projector, points: buffers, .. } = workspace;
    buffers.resize(count);
    let grey = &mut buffers.grey;
    observation.samples.prefetch_gradient(cell);
    context.for_each_projection(projector, |image_points, points| match image_points {
        ImagePoints::Near { origin, u, v } => deformed.values_near(origin, u, v, &mut grey[points]),
        ImagePoints::Exact(batch) => {
            let [u, v] = batch.pixels();
            deformed.values(u, v, &mut grey[points]);
        }
    });
    observation.samples.prefetch_value(cell);
    next.iter().for_each(|next| next.prefetch_upper_half());
    let of_reference = observation.moments[cell];
    let weight = of_reference.weight / samples.scale;
    let origin = f64::from(observation.grey_origin);
    let shapes = &mut projector.shapes;
    let [g, gg] = cell_moments(context, shapes, &buffers.grey, samples.weights, weight, origin);
    if !g.is_nan() {
        let moments = Moments { g: samples.scale * g, gg: samples.scale * gg, ..of_reference };
        return DeformedCell { moments, outside: false };
    }
    let mut weight = 0.0;
    for k in 0..count {
        let inside = !buffers.grey[k].is_nan();
        buffers.weights[k] = if inside { samples.weights.map_or(1.0, |weights| weights[k]) } else { 0.0 };
        weight += f64::from(buffers.weights[k]);
        if !inside {
            buffers.grey[k] = 0.0;
        }
    }
    let weights = Some(&*buffers.weights);
    let [f, ff] = cell_moments(context, shapes, samples.value, weights, weight, origin);
    let [g, gg] = cell_moments(context, shapes, &buffers.grey, weights, weight, origin);
    let [weight, f, ff, g, gg] = [weight, f, ff, g, gg].map(|sum| samples.scale * sum);
    DeformedCell { moments: Moments { weight, f, ff, g, gg }, outside: true }
}

/// Weighted sum of grey levels counted from `origin`, and of their squares, over the points of a cell whose weights add up to
/// `weight`.
fn cell_moments<const D: usize>(
    context: &CellContext<'_, D>,
    shapes: &mut UnsharedShapeTable,
    grey: &[f32],
    weights: Option<&[f32]>,
    weight: f64,
    origin: f64,
) -> [f64; 2] {
    let Some(&first) = grey.first() else { return [0.0; 2] };
    let mut sums = [0.0; 2];
    context.for_each_chunk(shapes, |chunk, points| {
        let weights = weights.map_or(chunk.ones(), |weights| &weights[points.clone()]);
        let chunk_sums = moments(&grey[points], weights, first);
        sums.iter_mut().zip(chunk_sums).for_each(|(sum, part)| *sum += part);
    });
    change_origin(origin, sums, weight, f64::from(first))
}
