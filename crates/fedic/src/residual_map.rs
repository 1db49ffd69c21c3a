//! The residual as an image.

use crate::batch::BATCH;
use crate::brightness::Moments;
use crate::cell_loop::for_each_cell;
use crate::residual::Evaluator;
use crate::{Brightness, COMPONENTS, Error, Monitor};

/// Mean residual of the quadrature points in each pixel of the reference image; NaN where there is none.
pub(crate) fn residual_map(
    evaluator: &Evaluator<'_>,
    displacement: &[[f64; COMPONENTS]],
    [width, height]: [usize; 2],
    monitor: &dyn Monitor,
) -> Result<Vec<f32>, Error> {
    let over_mesh = evaluator.evaluate(displacement, false, monitor)?.correction;
    let mut map = vec![0.0_f32; width * height];
    let mut counts = vec![0_u32; width * height];
    for_each_cell(
        evaluator.system.mesh.num_cells(),
        monitor,
        |batch, cell| {
            let points = evaluator.level.cell_points(cell);
            let (nodes, n) = evaluator.system.displaced(cell, displacement);
            let reference_nodes = evaluator.system.mesh.cell_points(cell);
            let mut readings = Vec::with_capacity(points.len());
            let mut moments = Moments::default();
            for first in (0..points.len()).step_by(BATCH) {
                let len = BATCH.min(points.len() - first);
                evaluator.read_batch(batch, cell, first, len, &nodes[..n], false);
                batch.project(evaluator.level.camera.as_ref(), &reference_nodes);
                for (k, point) in
                    points[first..first + len].iter().enumerate().filter(|&(k, _)| !batch.grey[k].is_nan())
                {
                    let g = f64::from(batch.grey[k]);
                    moments.add_point(f64::from(point.weight), f64::from(point.value), g);
                    readings.push(([batch.pixel[0][k], batch.pixel[1][k]], f64::from(point.value), g));
                }
            }
            let correction = match evaluator.brightness {
                Brightness::Element => moments.correction(),
                Brightness::None | Brightness::Global => over_mesh,
            };
            let residual =
                |(pixel, f, g): ([f64; 2], f64, f64)| (pixel, (f - correction.gain * g - correction.offset) as f32);
            readings.into_iter().map(residual).collect::<Vec<_>>()
        },
        |_, readings| {
            for ([u, v], residual) in readings {
                let (column, row) = (u.round().max(0.0) as usize, v.round().max(0.0) as usize);
                let pixel = row.min(height - 1) * width + column.min(width - 1);
                map[pixel] += residual;
                counts[pixel] += 1;
            }
        },
    )?;
    for (residual, count) in map.iter_mut().zip(counts) {
        *residual = if count == 0 { f32::NAN } else { *residual / count as f32 };
    }
    Ok(map)
}
