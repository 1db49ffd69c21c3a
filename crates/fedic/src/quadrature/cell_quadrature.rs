//! Quadrature points of every cell: generated from its subdivision, or stored for the pixel rule.

use fedic_camera::Camera;
use fedic_mesh::{Mesh, Subdivision, inverse_map, pixels_in_polygon};
use rayon::prelude::*;

use crate::quadrature::shape_table::{ShapeTable, SharedShapeTables};
use crate::{Error, Quadrature};

/// Quadrature points of a mesh in the reference domains of its cells, numbered cell after cell.
#[derive(Debug, Clone)]
pub(crate) struct CellQuadrature {
    points: Points,
    starts: Vec<usize>,
    tables: SharedShapeTables,
}

#[derive(Debug, Clone)]
enum Points {
    Subdivisions(Vec<Subdivision>),
    Stored(Vec<[f32; 2]>),
}

impl CellQuadrature {
    /// Places the points of `quadrature` in the cells, whose size in pixels is that seen by `camera`.
    pub(crate) fn new(mesh: &Mesh, camera: &dyn Camera, quadrature: Quadrature) -> Result<Self, Error> {
        let pixels: Vec<[f64; 2]> = mesh.points().par_iter().map(|&point| camera.project(point)).collect();
        let cell_pixels = |cell: usize| -> Vec<[f64; 2]> {
            mesh.cell(cell).nodes.iter().map(|&node| pixels[node as usize]).collect()
        };
        let cells = (0..mesh.num_cells()).into_par_iter();
        let (points, counts): (Points, Vec<usize>) = match quadrature {
            Quadrature::Mesh { rule, density } => {
                let subdivisions: Vec<Subdivision> = cells
                    .map(|cell| Subdivision::of_cell(mesh.cell(cell).cell_type, &cell_pixels(cell), rule, density))
                    .collect();
                let counts = subdivisions.iter().map(|s| s.num_points()).collect();
                (Points::Subdivisions(subdivisions), counts)
            }
            Quadrature::Pixel => {
                let stored: Vec<Vec<[f32; 2]>> =
                    cells.map(|cell| pixel_points(mesh, cell, &cell_pixels(cell))).collect();
                let counts = stored.iter().map(Vec::len).collect();
                (Points::Stored(stored.concat()), counts)
            }
        };
        let ends = counts.into_iter().scan(0, |sum: &mut usize, count| {
            *sum += count;
            Some(*sum)
        });
        let tables = match &points {
            Points::Subdivisions(subdivisions) => {
                let types = mesh.cells().map(|cell| cell.cell_type);
                SharedShapeTables::new(&types.zip(subdivisions.iter().copied()).collect::<Vec<_>>())
            }
            Points::Stored(_) => SharedShapeTables::none(mesh.num_cells()),
        };
        Ok(Self { points, starts: std::iter::once(0).chain(ends).collect(), tables })
    }

    /// Number of points of all cells.
    pub(crate) fn num_points(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// Points of one cell, as a range over all points.
    pub(crate) fn range(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell]..self.starts[cell + 1]
    }

    /// Writes the reference coordinates of the points of a cell from its point `first` on, as many as the slices hold. Entries
    /// past the last point of the cell are unspecified.
    pub(crate) fn coordinates(&self, cell: usize, first: usize, xi: &mut [f64], eta: &mut [f64]) {
        match &self.points {
            Points::Subdivisions(subdivisions) => subdivisions[cell].points(first, xi, eta),
            Points::Stored(stored) => {
                let points = &stored[self.range(cell)][first..];
                for ((x, y), point) in xi.iter_mut().zip(eta).zip(points) {
                    [*x, *y] = point.map(f64::from);
                }
            }
        }
    }

    /// Shared shape table of a cell, if any.
    pub(crate) fn shared_table(&self, cell: usize) -> Option<&ShapeTable> {
        self.tables.of(cell)
    }

    /// Reference area of each point of a cell; `None` for the pixel rule, where each point stands for one pixel.
    pub(crate) fn point_area(&self, cell: usize) -> Option<f64> {
        match &self.points {
            Points::Subdivisions(subdivisions) => Some(subdivisions[cell].subcell_area()),
            Points::Stored(_) => None,
        }
    }
}

/// Reference coordinates of the pixels whose centre falls in a cell projected to `pixels`.
fn pixel_points(mesh: &Mesh, cell: usize, pixels: &[[f64; 2]]) -> Vec<[f32; 2]> {
    let cell_type = mesh.cell(cell).cell_type;
    let outline: Vec<[f64; 2]> = cell_type.outline().iter().map(|&node| pixels[node]).collect();
    if !outline.iter().flatten().all(|c| c.abs() < f64::from(i32::MAX / 2)) {
        return Vec::new();
    }
    let mut inside = Vec::new();
    pixels_in_polygon(&outline, &mut inside);
    let inverse = |pixel: [i32; 2]| inverse_map(cell_type, pixels, pixel.map(f64::from));
    inside.into_iter().filter_map(inverse).map(|at| at.map(|c| c as f32)).collect()
}
