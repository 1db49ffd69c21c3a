//! The strain of a displacement field at reference points of the cells, their centres and points of the plane.

use rayon::prelude::*;

use super::measure::StrainMeasure;
use super::surface_strain::SurfaceStrain;
use crate::field::surface_gradients;
use crate::isoparametric::cross;
use crate::{Locator, Mesh, map};

/// The strain of a nodal displacement field.
///
/// A displacement has two components, in the `(x, y)` plane, or three. The strain of a cell is NaN if the cell is not valid or
/// the displacement of one of its nodes is NaN. Green-Lagrange and Hencky strains are also NaN where a displacement of two
/// components turns the cell inside out.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{CellType, StrainField, StrainMeasure, rectangle_mesh};
/// let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad)?;
/// let displacement: Vec<[f64; 2]> = mesh.points().iter().map(|p| [0.01 * p[0], 0.0]).collect();
/// let strains = StrainField::new(&mesh, &displacement, StrainMeasure::Small).at_cells();
/// assert!((strains[0].components[0] - 0.01).abs() < 1e-15);
/// # Ok::<(), fedic_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StrainField<'a, const D: usize> {
    pub(super) mesh: &'a Mesh,
    displacement: &'a [[f64; D]],
    measure: StrainMeasure,
    valid_cells: Option<&'a [bool]>,
}

impl<'a, const D: usize> StrainField<'a, D> {
    /// Strain of a displacement of the nodes, all cells valid.
    ///
    /// # Panics
    ///
    /// If `displacement` does not have one entry per node.
    pub fn new(mesh: &'a Mesh, displacement: &'a [[f64; D]], measure: StrainMeasure) -> Self {
        assert_eq!(displacement.len(), mesh.num_nodes(), "one displacement per node");
        Self { mesh, displacement, measure, valid_cells: None }
    }

    /// The same field with some cells left out.
    ///
    /// # Panics
    ///
    /// If `valid_cells` does not have one entry per cell.
    pub fn with_valid_cells(self, valid_cells: &'a [bool]) -> Self {
        assert_eq!(valid_cells.len(), self.mesh.num_cells(), "one flag per cell");
        Self { valid_cells: Some(valid_cells), ..self }
    }

    /// Strain at the reference point `at` of a cell, along the local axes there
    /// ([`SurfaceGradients::axes`](crate::SurfaceGradients::axes)).
    ///
    /// # Panics
    ///
    /// If there is no such cell.
    pub fn in_cell(&self, cell: usize, at: [f64; 2]) -> SurfaceStrain {
        let (points, num_nodes) = self.mesh.cell_points_array(cell);
        let (points, is_valid) = (&points[..num_nodes], self.valid_cells.is_none_or(|valid| valid[cell]));
        let cell = self.mesh.cell(cell);
        let surface = surface_gradients(cell.cell_type, points, at);
        let gradient = surface.of_vectors(cell.nodes.iter().map(|&node| self.displacement[node as usize]));
        let inside_out = D == 2 && self.measure != StrainMeasure::Small && turns_over(&surface.axes, &gradient);
        let [first, second, _] = surface.axes;
        SurfaceStrain {
            position: map(cell.cell_type, points, at),
            axes: [first, second],
            components: if is_valid && !inside_out { self.measure.of_gradient(&gradient) } else { [f64::NAN; 3] },
        }
    }

    /// Strain at the centre of each cell.
    pub fn at_cells(&self) -> Vec<SurfaceStrain> {
        let centre = |cell| self.mesh.cell(cell).cell_type.reference_centre();
        (0..self.mesh.num_cells()).map(|cell| self.in_cell(cell, centre(cell))).collect()
    }

    /// Strain at points of the `(x, y)` plane; `None` outside the mesh.
    ///
    /// The strain is that of the cell that contains the point; on an edge, where the strain jumps, that of the cell of lowest
    /// index. A surface in space is searched in its projection onto the `(x, y)` plane.
    pub fn at_points(&self, points: &[[f64; 2]]) -> Vec<Option<SurfaceStrain>> {
        let locator = Locator::new(self.mesh);
        points.par_iter().map(|&point| locator.find(point).map(|(cell, at)| self.in_cell(cell, at))).collect()
    }
}

/// Whether a displacement gradient reverses the orientation of the cell in the `(x, y)` plane.
fn turns_over(axes: &[[f64; 3]; 3], gradient: &[[f64; 2]; 3]) -> bool {
    let deformed = |b: usize| -> [f64; 3] {
        std::array::from_fn(|d| axes[b][d] + (0..3).map(|a| gradient[a][b] * axes[a][d]).sum::<f64>())
    };
    cross([deformed(0), deformed(1)])[2] * axes[2][2] < 0.0
}
