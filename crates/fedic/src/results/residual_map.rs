//! The residual as an image.

use fedic_image::Interpolator;

use crate::equations::image_term::Evaluator;
use crate::equations::parallel::for_each_cell;
use crate::observation::photometry::Moments;
use crate::projection::cell_projection::node_views;
use crate::projection::pointwise::BATCH;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::{Brightness, COMPONENTS, Error, Monitor, Quadrature};

/// Residual `f - g~` at each pixel of the reference image whose centre lies in the mesh; NaN at the others.
pub(crate) fn residual_map(
    evaluator: &Evaluator<'_>,
    reference: &Interpolator,
    displacement: &[[f64; COMPONENTS]],
    monitor: &dyn Monitor,
) -> Result<Vec<f32>, Error> {
    let (system, camera) = (evaluator.system, evaluator.level.camera.as_ref());
    let first = evaluator.first_correction(displacement, monitor)?;
    let over_mesh = evaluator.evaluate(displacement, first, None, false, monitor)?.correction;
    let over_mesh = over_mesh.without_pivot(f64::from(evaluator.level.pivot));
    let views = node_views(&system.mesh, camera, Some(displacement));
    let pixels = CellQuadrature::new(&system.mesh, camera, Quadrature::Pixel)?;
    let (width, height) = (reference.width(), reference.height());
    let mut map = vec![f32::NAN; width * height];
    for_each_cell(
        0..system.mesh.num_cells(),
        monitor,
        |work, cell, _| {
            let cell_type = system.mesh.cell(cell).cell_type;
            let rest = system.mesh.cell_points(cell);
            let displaced: Vec<[f64; 3]> =
                system.mesh.cell(cell).nodes.iter().map(|&node| views[node as usize].place).collect();
            let batch = &mut work.batch;
            let count = pixels.range(cell).len();
            let mut readings = Vec::with_capacity(count);
            let (mut f, mut grey) = ([0.0; BATCH], [0.0; BATCH]);
            for first in (0..count).step_by(BATCH) {
                let len = BATCH.min(count - first);
                batch.take(&pixels, cell, cell_type, first, len);
                batch.project(camera, &rest);
                reference.values(&batch.pixel[0][..len], &batch.pixel[1][..len], &mut f[..len]);
                let places = batch.pixel.map(|lane| lane.map(|c| c.round().max(0.0) as usize));
                batch.project(camera, &displaced);
                let [u, v] = &batch.pixel;
                evaluator.deformed.values(&u[..len], &v[..len], &mut grey[..len]);
                readings.extend((0..len).map(|k| ([places[0][k], places[1][k]], f64::from(f[k]), f64::from(grey[k]))));
            }
            let correction = match evaluator.brightness {
                Brightness::Element => {
                    let mut moments = Moments::default();
                    readings.iter().filter(|(_, _, g)| !g.is_nan()).for_each(|&(_, f, g)| moments.add_point(1.0, f, g));
                    moments.correction()
                }
                Brightness::None | Brightness::Global => over_mesh,
            };
            let residual = |(place, f, g)| (place, (f - correction.gain * g - correction.offset) as f32);
            readings.into_iter().map(residual).collect::<Vec<_>>()
        },
        |_, readings| {
            for ([column, row], residual) in readings {
                if column < width && row < height {
                    map[row * width + column] = residual;
                }
            }
        },
    )?;
    Ok(map)
}
