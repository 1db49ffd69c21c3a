//! Evaluation of the deformed image at the points of one cell.

use fedic_image::Interpolator;

use crate::interpolation::cell_prefetch::CellPrefetch;
use crate::kernels::residual::moments;
use crate::observation::cell_context::{CellContext, ImagePoints};
use crate::observation::observe::Observation;
use crate::observation::photometry::{Moments, change_origin};
use crate::observation::used_points::is_too_few;
use crate::observation::workspace::{UnsharedShapeTable, Workspace};
use crate::projection::projected_points::{ProjectedPoint, pixel_bounds};

/// Distance, in standard deviations, up to which a smoothing reaches.
const SMOOTHING_REACH: f64 = 3.0;

/// Moments of both images over a cell.
pub(crate) struct DeformedCell {
    pub(crate) moments: Moments,
    /// Points without weight, if there are any: those outside the deformed image, saturated there or excluded.
    pub(crate) unused: Option<Box<[bool]>>,
}

/// Points of a deformed image that get no weight, beside those outside it.
#[derive(Clone, Copy, Default)]
pub(crate) struct Exclusion<'a> {
    /// Grey level from which on a point is saturated.
    pub(crate) saturated: Option<f32>,
    /// Points of the cell that are left out.
    pub(crate) points: Option<&'a [bool]>,
    /// Corners `(u, v)` of the rectangle outside which the smoothing reaches across the border of the image; `None` for a cell that
    /// lies inside.
    pub(crate) interior: Option<[[f64; 2]; 2]>,
}

/// Rectangle of an image of this size in which a smoothing stays inside it, if some of the points leave it.
pub(crate) fn interior_of<'a>(
    size: [usize; 2],
    smoothing: f64,
    points: impl Iterator<Item = &'a ProjectedPoint>,
) -> Option<[[f64; 2]; 2]> {
    let margin = SMOOTHING_REACH * smoothing - 0.5;
    let [low, high] = [[margin; 2], size.map(|size| size as f64 - 1.0 - margin)];
    let [u, v] = pixel_bounds(points);
    let inside = |axis: usize, [first, last]: [f64; 2]| first >= low[axis] && last <= high[axis];
    (!(inside(0, u) && inside(1, v))).then_some([low, high])
}

/// Evaluates the deformed image at the points of a cell.
///
/// The grey levels are left in `workspace.points.grey`. If some points get no weight, `workspace.points.weights` holds the weights of
/// all points, zero for these; all are zero if too few are left.
pub(crate) fn read_deformed<const D: usize>(
    observation: &Observation<D>,
    deformed: &Interpolator,
    workspace: &mut Workspace<D>,
    context: &CellContext<'_, D>,
    exclusion: Exclusion<'_>,
    next: Option<&CellPrefetch<'_>>,
) -> DeformedCell {
    let (cell, count) = (context.cell, context.count());
    let samples = observation.samples.cell(cell);
    let Workspace { projector, points: buffers, .. } = workspace;
    buffers.resize(count);
    let grey = &mut buffers.grey;
    observation.samples.prefetch_gradient(cell);
    context.for_each_projection(projector, |image_points, points| match image_points {
        ImagePoints::Near { origin, u, v } => {
            deformed.values_near(origin, u, v, &mut grey[points.clone()]);
            let [column, row] = origin.map(|c| c as f64);
            let at = |k: usize| [column + f64::from(u[k]), row + f64::from(v[k])];
            clear_outside(exclusion.interior, at, &mut grey[points]);
        }
        ImagePoints::Exact(batch) => {
            let [u, v] = batch.pixels();
            deformed.values(u, v, &mut grey[points.clone()]);
            clear_outside(exclusion.interior, |k| [u[k], v[k]], &mut grey[points]);
        }
    });
    if let Some(level) = exclusion.saturated {
        buffers.grey[..count].iter_mut().filter(|grey| **grey >= level).for_each(|grey| *grey = f32::NAN);
    }
    if let Some(excluded) = exclusion.points {
        let excluded = buffers.grey.iter_mut().zip(excluded).filter(|(_, out)| **out);
        excluded.for_each(|(grey, _)| *grey = f32::NAN);
    }
    observation.samples.prefetch_value(cell);
    next.iter().for_each(|next| next.prefetch_upper_half());
    let of_reference = observation.moments[cell];
    let weight = of_reference.weight / samples.scale;
    let origin = f64::from(observation.grey_origin);
    let shapes = &mut projector.shapes;
    let [g, gg] = cell_moments(context, shapes, &buffers.grey, samples.weights, weight, origin);
    if !g.is_nan() {
        let moments = Moments { g: samples.scale * g, gg: samples.scale * gg, ..of_reference };
        return DeformedCell { moments, unused: None };
    }
    let mut unused: Box<[bool]> = buffers.grey[..count].iter().map(|grey| grey.is_nan()).collect();
    let weighted = |k: usize| samples.weights.is_none_or(|weights| weights[k] > 0.0);
    let used = (0..count).filter(|&k| !unused[k] && weighted(k)).count();
    if is_too_few(used, count, context.cell_type, D) {
        unused.fill(true);
    }
    let mut weight = 0.0;
    for k in 0..count {
        let inside = !unused[k];
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
    DeformedCell { moments: Moments { weight, f, ff, g, gg }, unused: Some(unused) }
}

/// Makes the grey levels of points outside a rectangle NaN; `at` gives the image point of each.
fn clear_outside(interior: Option<[[f64; 2]; 2]>, at: impl Fn(usize) -> [f64; 2], grey: &mut [f32]) {
    let Some([low, high]) = interior else { return };
    for (k, grey) in grey.iter_mut().enumerate() {
        let point = at(k);
        if (0..2).any(|axis| point[axis] < low[axis] || point[axis] > high[axis]) {
            *grey = f32::NAN;
        }
    }
}

/// Weighted sum of grey levels counted from `origin`, and of their squares, over the points of a cell whose weights add up to
/// `weight`.
pub(crate) fn cell_moments<const D: usize>(
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
