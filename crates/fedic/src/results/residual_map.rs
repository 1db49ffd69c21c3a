//! The residual as an image.

use fedic_image::Interpolator;
use fedic_mesh::shape_values;

use crate::equations::dofs::Dofs;
use crate::equations::terms::image::light::LightField;
use crate::observation::observe::Observation;
use crate::observation::photometry::{GainOffset, Moments};
use crate::observation::workspace::Workspace;
use crate::parallel::for_each_in_order;
use crate::projection::pointwise::BATCH;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::{Brightness, Error, Monitor, Quadrature};

/// Both images and the gain and offset of the deformed one.
pub(crate) struct ImagePair<'a> {
    pub(crate) reference: &'a Interpolator,
    pub(crate) deformed: &'a Interpolator,
    pub(crate) brightness: Brightness,
    /// Over the mesh, of grey levels counted from zero.
    pub(crate) gain_offset: GainOffset,
    /// Light as a field, instead of gain and offset over the mesh.
    pub(crate) light: Option<&'a LightField<'a>>,
}

/// Residual `f - g~` at each pixel of the reference image whose centre lies in the mesh, row after row; NaN at the others.
///
/// # Errors
///
/// [`Error::Cancelled`] if `monitor` asks to stop.
pub(crate) fn residual_map<const D: usize>(
    dofs: &Dofs<D>,
    observation: &Observation<D>,
    images: &ImagePair<'_>,
    displacement: &[[f64; D]],
    monitor: &dyn Monitor,
) -> Result<Vec<f32>, Error> {
    let (mesh, camera) = (&dofs.mesh, observation.camera.as_ref());
    let pixels = CellQuadrature::new(mesh, camera, Quadrature::Pixel)?;
    let [width, height] = observation.size;
    let mut map = vec![f32::NAN; width * height];
    for_each_in_order(
        0..mesh.num_cells(),
        monitor,
        |workspace: &mut Workspace<D>, cell, _| {
            let cell_type = mesh.cell(cell).cell_type;
            let at_rest = mesh.cell_points(cell);
            let mut displaced = at_rest.clone();
            for (point, &node) in displaced.iter_mut().zip(mesh.cell(cell).nodes) {
                point.iter_mut().zip(displacement[node as usize]).for_each(|(x, u)| *x += u);
            }
            let batch = &mut workspace.projector.pointwise;
            let count = pixels.range(cell).len();
            let mut levels = Vec::with_capacity(count);
            let (mut f, mut g) = ([0.0; BATCH], [0.0; BATCH]);
            for first in (0..count).step_by(BATCH) {
                let len = BATCH.min(count - first);
                batch.load(&pixels, cell, cell_type, first, len);
                batch.project(camera, &at_rest);
                let [u, v] = batch.pixels();
                images.reference.values(u, v, &mut f[..len]);
                let nearest = |c: &f64| c.round().max(0.0) as usize;
                let positions: Vec<[usize; 2]> = u.iter().zip(v).map(|(u, v)| [nearest(u), nearest(v)]).collect();
                batch.project(camera, &displaced);
                let [u, v] = batch.pixels();
                images.deformed.values(u, v, &mut g[..len]);
                if let Some(light) = images.light {
                    for (k, g) in g[..len].iter_mut().enumerate() {
                        let shapes = shape_values(cell_type, batch.coordinates(k));
                        *g = light.corrected(mesh.cell(cell).nodes, &shapes, f64::from(*g)) as f32;
                    }
                }
                let grey = |k: usize| [f[k], g[k]].map(f64::from);
                levels.extend(positions.into_iter().enumerate().map(|(k, position)| (position, grey(k))));
            }
            let gain_offset = match images.brightness {
                Brightness::Element => {
                    let mut moments = Moments::default();
                    let inside = levels.iter().filter(|(_, [_, g])| !g.is_nan());
                    inside.for_each(|&(_, [f, g])| moments.add_point(1.0, f, g));
                    moments.gain_offset(0.0)
                }
                _ if images.light.is_some() => GainOffset::IDENTITY,
                _ => images.gain_offset,
            };
            let residual = |(position, [f, g]): ([usize; 2], [f64; 2])| {
                (position, (f - gain_offset.gain * g - gain_offset.offset) as f32)
            };
            levels.into_iter().map(residual).collect::<Vec<_>>()
        },
        |_, residuals| {
            for ([column, row], residual) in residuals {
                if column < width && row < height {
                    map[row * width + column] = residual;
                }
            }
        },
    )?;
    Ok(map)
}
