//! Checks that one camera can see a surface and its motion along `x` and `y`.

use fedic_camera::Camera;
use fedic_mesh::{Mesh, jacobian, map};
use nalgebra::{Matrix2, Matrix2x3, Matrix3x2, RowVector3, Vector3};
use rayon::prelude::*;

use crate::Error;

/// Smallest part of the motion along the worse direction that must be seen, relative to the mean of both.
const GRAZING: f64 = 0.1;

/// Checks that `camera` sees every cell of `mesh` from the same side, and the motion of the mesh along `x` and `y`.
///
/// Cells that project to no finite image point are left to the check of the view.
///
/// # Errors
///
/// [`Error::EdgeOn`] if the surface is vertical, or the camera looks along it or along a direction of the measured motion;
/// [`Error::HiddenCells`] if cells face away from the camera.
pub(crate) fn check_visibility(mesh: &Mesh, camera: &dyn Camera) -> Result<(), Error> {
    let num_cells = mesh.num_cells();
    let views: Vec<Option<CellView>> = (0..num_cells).into_par_iter().map(|cell| view_of(mesh, cell, camera)).collect();
    // Sums over the cells, each weighted by its area.
    let sum = |of: fn(&CellView) -> f64| views.iter().flatten().map(|view| view.area * of(view)).sum::<f64>();
    let area = sum(|_| 1.0);
    let grazes = |of| sum(of) < GRAZING * area;
    let vertical = grazes(|view| view.level);
    if vertical || grazes(|view| view.along_surface.abs()) || grazes(|view| view.along_axes.abs()) {
        return Err(Error::EdgeOn { vertical });
    }
    // Most of the surface is seen from its front; of a closed one, the nearer half.
    let front = sum(|view| view.along_surface);
    let is_closed = front.abs() <= GRAZING * sum(|view| view.along_surface.abs());
    let front = if is_closed { -sum(|view| view.along_surface * view.depth) } else { front };
    let is_hidden = |&cell: &usize| views[cell].as_ref().is_some_and(|view| view.along_surface * front < 0.0);
    let cells: Vec<usize> = (0..num_cells).filter(is_hidden).collect();
    if cells.is_empty() { Ok(()) } else { Err(Error::HiddenCells { cells, num_cells }) }
}

/// How a camera sees a cell, at its centre.
struct CellView {
    area: f64,
    /// Part of the normal along `z`.
    level: f64,
    /// How well motions along the surface are seen, with the sign of the side that is seen.
    along_surface: f64,
    /// How well motions along `x` and `y` are seen.
    along_axes: f64,
    /// Distance along the line of sight.
    depth: f64,
}

/// How a camera sees a cell; `None` if it projects to no finite image point.
fn view_of(mesh: &Mesh, index: usize, camera: &dyn Camera) -> Option<CellView> {
    let (cell, nodes) = (mesh.cell(index).cell_type, mesh.cell_points(index));
    let centre = cell.reference_centre();
    let (point, tangents) = (map(cell, &nodes, centre), jacobian(cell, &nodes, centre));
    let [along_xi, along_eta] = [0, 1].map(|k| Vector3::from(tangents.map(|row| row[k])));
    let normal = along_xi.cross(&along_eta);
    let (pixel, [du, dv]) = camera.project_with_jacobian(point);
    let projection = Matrix2x3::from_rows(&[RowVector3::from(du), RowVector3::from(dv)]);
    let tangents = Matrix3x2::from_columns(&[along_xi.normalize(), normal.cross(&along_xi).normalize()]);
    // The null vector of the Jacobian points away from the camera: u runs to the right and v down.
    let sight = Vector3::from(du).cross(&Vector3::from(dv)).normalize();
    let view = CellView {
        area: normal.norm(),
        level: normal.z.abs() / normal.norm(),
        along_surface: conformity(&(projection * tangents)),
        along_axes: conformity(&projection.fixed_columns::<2>(0).into_owned()),
        depth: sight.dot(&Vector3::from(point)),
    };
    (pixel[0].is_finite() && view.along_surface.is_finite() && view.along_axes.is_finite()).then_some(view)
}

/// How nearly a linear map of the plane keeps all directions: 1 if it keeps angles, -1 if it also mirrors, 0 if it maps the plane to
/// a line.
fn conformity(map: &Matrix2<f64>) -> f64 {
    2.0 * map.determinant() / map.norm_squared()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_camera::{ImageFrame, Pinhole};
    use fedic_mesh::CellType;

    use super::*;

    /// A strip of quads over these points of the `(x, z)` plane, extended along `y`.
    fn strip(profile: &[[f64; 2]]) -> Mesh {
        let points = [0.0, 50.0].into_iter().flat_map(|y| profile.iter().map(move |&[x, z]| [x, y, z]));
        let n = profile.len() as i64;
        let cells = (0..n - 1).flat_map(|i| [i, i + 1, n + i + 1, n + i]).collect();
        Mesh::new(points.collect(), &[(CellType::Quad, cells)]).unwrap()
    }

    fn arc(half_angle: f64) -> Mesh {
        let angles = (0..=20).map(|i| half_angle * (f64::from(i) / 10.0 - 1.0));
        strip(&angles.map(|a| [100.0 * a.sin(), -100.0 * a.cos()]).collect::<Vec<_>>())
    }

    #[test]
    fn surfaces_that_face_the_camera_pass() {
        for mesh in [strip(&[[0.0, 0.0], [50.0, 0.0]]), strip(&[[0.0, 0.0], [50.0, 60.0]]), arc(1.4)] {
            assert_eq!(check_visibility(&mesh, &ImageFrame), Ok(()));
        }
    }

    #[test]
    fn cameras_with_their_centre_close_to_the_surface_pass() {
        // A map of the plane to the image, written as a camera of focal length one.
        let rotation = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
        let camera = Pinhole::new([1.0; 2], [0.0; 2], rotation, [0.08, 0.09, 1e-4]).unwrap();
        let points = [[0.0, 0.0], [0.01, 0.0], [0.01, 0.01], [0.0, 0.01]].map(|[x, y]| [x, y, 0.0]);
        let mesh = Mesh::new(points.to_vec(), &[(CellType::Quad, vec![0, 1, 2, 3])]).unwrap();
        assert_eq!(check_visibility(&mesh, &camera), Ok(()));
    }

    #[test]
    fn cells_on_the_far_side_are_refused() {
        for (half_angle, hidden) in [(2.2, [0..3, 17..20]), (std::f64::consts::PI, [0..5, 15..20])] {
            let cells = hidden.into_iter().flatten().collect();
            let expected = Err(Error::HiddenCells { cells, num_cells: 20 });
            assert_eq!(check_visibility(&arc(half_angle), &ImageFrame), expected);
        }
    }

    #[test]
    fn vertical_surfaces_are_refused() {
        let vertical = strip(&[[0.0, 0.0], [0.0, 50.0]]);
        assert_eq!(check_visibility(&vertical, &ImageFrame), Err(Error::EdgeOn { vertical: true }));
    }

    #[test]
    fn cameras_that_look_along_the_surface_are_refused() {
        // The camera looks along y.
        let rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
        let camera = Pinhole::new([1000.0; 2], [100.0; 2], rotation, [0.0, 0.0, 500.0]).unwrap();
        let level = strip(&[[0.0, 0.0], [50.0, 0.0]]);
        assert_eq!(check_visibility(&level, &camera), Err(Error::EdgeOn { vertical: false }));
        let vertical = Mesh::new(
            vec![[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [50.0, 0.0, 50.0], [0.0, 0.0, 50.0]],
            &[(CellType::Quad, vec![0, 1, 2, 3])],
        );
        assert_eq!(check_visibility(&vertical.unwrap(), &camera), Err(Error::EdgeOn { vertical: true }));
    }
}
