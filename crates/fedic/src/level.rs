//! The reference image at one resolution, read at every quadrature point: all that the iterations need of it.

use std::sync::Arc;

use fedic_camera::Camera;
use fedic_mesh::{CellType, Mesh, jacobian};
use fedic_sparse::{Factor, SymmetricMatrix};

use crate::batch::{BATCH, Batch};
use crate::brightness::{FLAT, Moments};
use crate::cell_loop::for_each_cell;
use crate::cell_quadrature::CellQuadrature;
use crate::hessian::CellHessian;
use crate::regularization::penalty_factor;
use crate::system::System;
use crate::{COMPONENTS, Error, Monitor, Quadrature, Sampler, SolveError};

/// Gradients below this fraction of those of the best cells count as none.
const FLAT_GRADIENT: f64 = 1e-3;

/// What is kept of the reference image at a quadrature point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Point {
    /// `f(P(X))`.
    pub(crate) value: f32,
    /// `grad f(P(X))`, per pixel along `u` and `v`.
    pub(crate) gradient: [f32; 2],
    /// Area the point stands for: in the mesh's unit squared, or one pixel.
    pub(crate) weight: f32,
}

/// What is kept per point, the place of a pixel in its cell included, stays small beside the images.
const _: () = assert!(size_of::<Point>() + size_of::<[f32; 2]>() <= 24);

/// A level of the pyramid; level 0 is the image as it is.
pub(crate) struct Level {
    pub(crate) camera: Arc<dyn Camera>,
    pub(crate) quadrature: CellQuadrature,
    points: Vec<Point>,
    /// Factor of the Hessian at the reference position, the penalty included.
    pub(crate) factor: Factor,
    /// Factor of the Laplacian in the system, where the displacement is smoothed.
    pub(crate) penalty: Option<f64>,
}

/// How a level is made.
pub(crate) struct LevelSettings {
    pub(crate) quadrature: Quadrature,
    /// Columns and rows of the image.
    pub(crate) size: [usize; 2],
    /// Wavelength, in pixels of this level, below which the displacement is smoothed.
    pub(crate) wavelength: Option<f64>,
    /// Whether a mesh that leaves the image is an error; its points outside are dropped otherwise.
    pub(crate) whole_mesh: bool,
}

impl Level {
    pub(crate) fn new(
        system: &System,
        camera: Arc<dyn Camera>,
        reference: &Sampler,
        settings: &LevelSettings,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let mesh = &system.mesh;
        let [width, height] = settings.size;
        let refuse = |cells| Error::MeshOutsideImage { cells, num_cells: mesh.num_cells(), width, height };
        if settings.whole_mesh {
            let cells = cells_outside(mesh, camera.as_ref(), settings.size);
            if !cells.is_empty() {
                return Err(refuse(cells));
            }
        }
        let quadrature = CellQuadrature::new(mesh, camera.as_ref(), settings.quadrature)?;
        let num_points = quadrature.num_points();
        let mut points = Vec::new();
        points.try_reserve_exact(num_points).map_err(|_| SolveError::TooManyPoints { points: num_points })?;
        let mut hessian = SymmetricMatrix::zeros(&system.pattern);
        let mut energies = Vec::with_capacity(mesh.num_cells());
        let mut moments = Moments::default();
        let mut outside = Vec::new();
        for_each_cell(
            mesh.num_cells(),
            monitor,
            |batch, cell| read_cell(batch, system, camera.as_ref(), &quadrature, reference, cell),
            |cell, read| {
                points.extend_from_slice(&read.points);
                hessian.add_cell(&system.pattern, cell, read.hessian.entries());
                energies.push((read.hessian.trace(), read.moments.weight));
                moments.add(&read.moments);
                if read.outside {
                    outside.push(cell);
                }
            },
        )?;
        if settings.whole_mesh && !outside.is_empty() {
            return Err(refuse(outside));
        }
        let std = moments.std_f();
        if quadrature.num_points() > 0 && (std.is_nan() || std <= FLAT) {
            return Err(Error::Flat { which: "reference", std });
        }
        if settings.wavelength.is_none() {
            system.check_texture(&flat_cells(&energies), &quadrature)?;
        }
        let penalty = settings.wavelength.map(|wavelength| {
            let trace = energies.iter().map(|(trace, _)| trace).sum();
            let factor = penalty_factor(system, camera.as_ref(), trace, wavelength);
            hessian.add_scaled(factor, &system.laplacian().matrix);
            factor
        });
        let factor = system.factorize(&hessian, &quadrature)?;
        Ok(Self { camera, quadrature, points, factor, penalty })
    }

    /// Points of one cell.
    pub(crate) fn cell_points(&self, cell: usize) -> &[Point] {
        &self.points[self.quadrature.range(cell)]
    }

    /// Number of quadrature points.
    pub(crate) fn num_points(&self) -> usize {
        self.points.len()
    }
}

/// Cells whose gradient is negligible beside that of the best: interpolation carries ripples of a texture into the flat part of
/// an image, and they determine nothing. `energies` are the trace of the Hessian and the weight of each cell.
fn flat_cells(energies: &[(f64, f64)]) -> Vec<bool> {
    let densities: Vec<f64> = energies.iter().map(|&(trace, weight)| trace / weight).collect();
    let mut sorted: Vec<f64> = densities.iter().copied().filter(|density| !density.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    // The upper tenth: much of the mesh may be flat.
    let textured = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or_default();
    densities.into_iter().map(|density| density.is_nan() || density <= FLAT_GRADIENT.powi(2) * textured).collect()
}

/// Cells with a node outside the image: looked for first, for a camera in the wrong unit would ask for more quadrature
/// points than there is memory.
fn cells_outside(mesh: &Mesh, camera: &dyn Camera, size: [usize; 2]) -> Vec<usize> {
    let inside = |&point: &[f64; 3]| {
        camera.project(point).iter().zip(size).all(|(&c, size)| c >= -0.5 && c <= size as f64 - 0.5)
    };
    let inside: Vec<bool> = mesh.points().iter().map(inside).collect();
    (0..mesh.num_cells()).filter(|&cell| mesh.cell(cell).nodes.iter().any(|&node| !inside[node as usize])).collect()
}

struct CellReading {
    points: Vec<Point>,
    hessian: CellHessian,
    moments: Moments,
    outside: bool,
}

fn read_cell(
    batch: &mut Batch,
    system: &System,
    camera: &dyn Camera,
    quadrature: &CellQuadrature,
    reference: &Sampler,
    cell: usize,
) -> CellReading {
    let cell_type = system.mesh.cell(cell).cell_type;
    let nodes = system.mesh.cell_points(cell);
    let count = quadrature.range(cell).len();
    let mut reading = CellReading {
        points: Vec::with_capacity(count),
        hessian: CellHessian::new(nodes.len()),
        moments: Moments::default(),
        outside: false,
    };
    let mut q = [[0.0; BATCH]; COMPONENTS];
    let mut weighted = [[0.0; BATCH]; COMPONENTS];
    for first in (0..count).step_by(BATCH) {
        let len = BATCH.min(count - first);
        batch.take(quadrature, cell, cell_type, first, len);
        batch.project_with_jacobian(camera, &nodes);
        batch.read(reference);
        for k in 0..len {
            let value = batch.grey[k];
            let seen = !value.is_nan();
            reading.outside |= !seen;
            let point = if seen {
                let weight = match quadrature.part_area(cell) {
                    Some(area) => area * surface_element(cell_type, &nodes, [batch.xi[k], batch.eta[k]]),
                    None => 1.0,
                };
                Point { value, gradient: [batch.gradient[0][k], batch.gradient[1][k]], weight: weight as f32 }
            } else {
                Point::default()
            };
            let weight = f64::from(point.weight);
            reading.moments.add_point(weight, f64::from(point.value), 0.0);
            for c in 0..COMPONENTS {
                q[c][k] = if seen { batch.pull_back(c, k, point.gradient) } else { 0.0 };
                weighted[c][k] = weight * q[c][k];
            }
            reading.points.push(point);
        }
        batch.clear_tail(&mut q);
        batch.clear_tail(&mut weighted);
        reading.hessian.add(batch, &weighted, &q);
    }
    reading
}

/// Area of the cell per area of its reference domain at a point.
fn surface_element(cell_type: CellType, nodes: &[[f64; 3]], at: [f64; 2]) -> f64 {
    let [[xx, xy], [yx, yy], [zx, zy]] = jacobian(cell_type, nodes, at);
    let normal = [yx * zy - yy * zx, zx * xy - zy * xx, xx * yy - xy * yx];
    normal.iter().map(|c| c * c).sum::<f64>().sqrt()
}
