//! Strains of a displacement field.

use super::gradient::surface_gradients;
use crate::Mesh;

/// Small strains `[eps_11, eps_22, eps_12]` at the centre of each cell, in its tangent plane: tension positive, shear as the
/// tensor component.
///
/// The axes are those of [`SurfaceGradients::axes`](crate::SurfaceGradients::axes): `x` and `y` for a mesh parallel to the
/// `(x, y)` plane, else the projection of `x` onto the tangent plane and the in-plane direction perpendicular to it. A
/// displacement has two components, in the `(x, y)` plane, or three.
///
/// # Panics
///
/// If `displacement` does not have one entry per node.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{CellType, cell_strains, rectangle_mesh};
/// let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad)?;
/// let displacement: Vec<[f64; 2]> = mesh.points().iter().map(|p| [0.01 * p[0], 0.0]).collect();
/// let strains = cell_strains(&mesh, &displacement);
/// assert!((strains[0][0] - 0.01).abs() < 1e-15);
/// # Ok::<(), fedic_mesh::MeshError>(())
/// ```
pub fn cell_strains<const D: usize>(mesh: &Mesh, displacement: &[[f64; D]]) -> Vec<[f64; 3]> {
    assert_eq!(displacement.len(), mesh.num_nodes(), "one displacement per node");
    (0..mesh.num_cells())
        .map(|index| {
            let cell = mesh.cell(index);
            let centre = cell.cell_type.reference_centre();
            let gradients = surface_gradients(cell.cell_type, &mesh.cell_points(index), centre);
            let [x, y, _] = gradients.of_vectors(cell.nodes.iter().map(|&node| displacement[node as usize]));
            [x[0], y[1], 0.5 * (x[1] + y[0])]
        })
        .collect()
}
