//! Strains at the nodes, by projection.

use super::projection::project;
use super::strain_field::StrainField;
use super::surface_strain::SurfaceStrain;
use crate::Mesh;
use crate::field::gradient::local_axes;
use crate::isoparametric::{cross, tangents};

/// Cross products of tangents below this fraction of the one at the centre of the cell count as zero.
const COLLAPSED: f64 = 1e-9;

impl<const D: usize> StrainField<'_, D> {
    /// Strain at each node, along the local axes of the surface there: the nodal values of the field in the space of the shape
    /// functions that is closest to the strain in the mean square over the mesh (`L^2` projection, consistent mass matrix).
    ///
    /// Only cells whose strain is finite take part; nodes of no such cell are NaN. On a surface in space the strain is
    /// projected as a tensor, and the axes at a node are those of the mean normal of its cells.
    pub fn at_nodes(&self) -> Vec<SurfaceStrain> {
        let tensors = project(self.mesh, |cell, at| self.in_cell(cell, at).tensor());
        let nodes = tensors.into_iter().zip(node_normals(self.mesh)).zip(self.mesh.points());
        nodes
            .map(|((tensor, normal), &position)| {
                let [first, second, _] = local_axes(normal);
                SurfaceStrain::of_tensor(tensor, [first, second], position)
            })
            .collect()
    }
}

/// Sum of the normals of the cells of each node, each as long as the area element there.
fn node_normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.num_nodes()];
    for index in 0..mesh.num_cells() {
        let (points, num_nodes) = mesh.cell_points_array(index);
        let cell = mesh.cell(index);
        let normal_at = |at| cross(tangents(cell.cell_type, &points[..num_nodes], at));
        let length = |n: [f64; 3]| (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let centre = normal_at(cell.cell_type.reference_centre());
        for (&node, &at) in cell.nodes.iter().zip(cell.cell_type.reference_nodes()) {
            let here = normal_at(at);
            // The corner of a quad with a repeated node has no normal of its own.
            let normal = if length(here) > COLLAPSED * length(centre) { here } else { centre };
            for (sum, c) in normals[node as usize].iter_mut().zip(normal) {
                *sum += c;
            }
        }
    }
    normals
}
