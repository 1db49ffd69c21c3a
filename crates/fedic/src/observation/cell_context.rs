//! The steps that every pass over the cells is made of: take the points of a cell, project them, evaluate an image there, and
//! project the image gradient to the displacement components.

use std::ops::Range;

use fedic_camera::Camera;
use fedic_mesh::CellType;

use crate::kernels::gradient::{GradientVectors, LinearJacobian, project_gradient};
use crate::kernels::polynomial::pixel_coordinates;
use crate::observation::workspace::{Projector, UnsharedShapeTable};
use crate::projection::cell_projection::CellProjection;
use crate::projection::pointwise::PointwiseProjector;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::quadrature::shape_table::{CHUNK, ShapeTableChunk};

/// One cell of a pass: its quadrature points and their projection by a camera.
pub(crate) struct CellContext<'a, const D: usize> {
    pub(crate) cell: usize,
    pub(crate) cell_type: CellType,
    pub(crate) quadrature: &'a CellQuadrature,
    pub(crate) camera: &'a dyn Camera,
    pub(crate) projection: CellProjection<'a, D>,
}

/// Image points of some points of a cell.
pub(crate) enum ImagePoints<'a> {
    /// From the cell's polynomial, relative to the pixel `origin`.
    Near { origin: [isize; 2], u: &'a [f32], v: &'a [f32] },
    /// Projected exactly, with the Jacobians of the projection.
    Exact(&'a PointwiseProjector),
}

impl<const D: usize> CellContext<'_, D> {
    /// Number of quadrature points of the cell.
    pub(crate) fn count(&self) -> usize {
        self.quadrature.range(self.cell).len()
    }

    /// Projects the points of the cell, some at a time, and passes them to `evaluate` with the range that they form.
    pub(crate) fn for_each_projection(
        &self,
        projector: &mut Projector,
        mut evaluate: impl FnMut(ImagePoints<'_>, Range<usize>),
    ) {
        let Some(polynomial) = &self.projection.polynomial else {
            return self.for_each_exact_projection(projector, |batch, points| {
                evaluate(ImagePoints::Exact(batch), points);
            });
        };
        let Projector { shapes, pixel, .. } = projector;
        let count = self.count();
        for first in (0..count).step_by(CHUNK) {
            let points = first..count.min(first + CHUNK);
            let chunk = shapes.chunk(self.quadrature, self.cell, self.cell_type, first);
            let [u, v] = pixel.each_mut().map(|row| &mut row[..chunk.padded()]);
            pixel_coordinates(chunk, &polynomial.pixel, u, v);
            let (u, v) = (&u[..points.len()], &v[..points.len()]);
            evaluate(ImagePoints::Near { origin: polynomial.origin, u, v }, points);
        }
    }

    /// Projects the points of the cell by the camera itself, batch by batch.
    pub(crate) fn for_each_exact_projection(
        &self,
        projector: &mut Projector,
        evaluate: impl FnMut(&mut PointwiseProjector, Range<usize>),
    ) {
        let (quadrature, cell, camera) = (self.quadrature, self.cell, self.camera);
        self.projection.for_each_batch(&mut projector.pointwise, quadrature, cell, camera, evaluate);
    }

    /// Passes the shape functions of the points of the cell to `accumulate`, chunk by chunk, with the padded range that they form.
    pub(crate) fn for_each_chunk(
        &self,
        shapes: &mut UnsharedShapeTable,
        mut accumulate: impl FnMut(ShapeTableChunk<'_>, Range<usize>),
    ) {
        for first in (0..self.count()).step_by(CHUNK) {
            let chunk = shapes.chunk(self.quadrature, self.cell, self.cell_type, first);
            accumulate(chunk, first..first + chunk.padded());
        }
    }
}

/// Writes the sensitivity `q = J^T grad f` of a chunk, whose gradients are given in units of `unit`.
pub(crate) fn linear_sensitivity<G: GradientVectors, const D: usize>(
    chunk: ShapeTableChunk<'_>,
    jacobian: &LinearJacobian<D>,
    unit: f32,
    gradient: G,
    q: [&mut [f32]; D],
) {
    let jacobian = jacobian.map(|row| row.map(|entry| entry.map(|c| unit * c)));
    project_gradient(chunk, &jacobian, gradient, q);
}

/// Writes the sensitivities of a batch projected exactly, from the image gradient at each point.
pub(crate) fn exact_sensitivity<const D: usize>(
    batch: &PointwiseProjector,
    points: Range<usize>,
    gradient_at: impl Fn(usize) -> [f32; 2],
    q: &mut [impl std::ops::DerefMut<Target = [f32]>; D],
) {
    for (k, point) in points.enumerate() {
        let gradient = gradient_at(point);
        for (c, q) in q.iter_mut().enumerate() {
            q[point] = batch.project_gradient(c, k, gradient) as f32;
        }
    }
}
