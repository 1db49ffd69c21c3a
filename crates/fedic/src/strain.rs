//! Strains of a displacement field.

use fedic_mesh::{Mesh, jacobian, shape_gradients};

use crate::COMPONENTS;

/// Small strains `[eps_xx, eps_yy, eps_xy]` at the centre of each cell: tension positive, shear as the tensor component.
///
/// # Panics
///
/// If `displacement` does not have one entry per node.
pub fn cell_strains(mesh: &Mesh, displacement: &[[f64; COMPONENTS]]) -> Vec<[f64; 3]> {
    assert_eq!(displacement.len(), mesh.num_nodes(), "one displacement per node");
    (0..mesh.num_cells())
        .map(|index| {
            let cell = mesh.cell(index);
            let centre = cell.cell_type.reference_centre();
            let [[xx, xy], [yx, yy], _] = jacobian(cell.cell_type, &mesh.cell_points(index), centre);
            let det = xx * yy - xy * yx;
            let mut gradient = [[0.0; 2]; COMPONENTS];
            for (&node, [along_xi, along_eta]) in cell.nodes.iter().zip(shape_gradients(cell.cell_type, centre)) {
                let slope = [(yy * along_xi - yx * along_eta) / det, (xx * along_eta - xy * along_xi) / det];
                for (row, u) in gradient.iter_mut().zip(displacement[node as usize]) {
                    row[0] += u * slope[0];
                    row[1] += u * slope[1];
                }
            }
            [gradient[0][0], gradient[1][1], 0.5 * (gradient[0][1] + gradient[1][0])]
        })
        .collect()
}
