//! Checks that one camera can see a surface and its motion along `x` and `y`.

use fedic_camera::Camera;
use fedic_mesh::{Mesh, jacobian, map};
use nalgebra::{Matrix2, Matrix2x3, Matrix3x2, RowVector3, Vector3};

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
    let mut sums = Sums::default();
    let mut facing = Vec::with_capacity(mesh.num_cells());
    for index in 0..mesh.num_cells() {
        let cell = mesh.cell(index).cell_type;
        let centre = cell.reference_centre();
        let nodes = mesh.cell_points(index);
        let tangents = jacobian(cell, &nodes, centre);
        let [along_xi, along_eta] = [0, 1].map(|k| Vector3::from(tangents.map(|row| row[k])));
        let normal = along_xi.cross(&along_eta);
        let point = map(cell, &nodes, centre);
        let (pixel, [du, dv]) = camera.project_with_jacobian(point);
        let projection = Matrix2x3::from_rows(&[RowVector3::from(du), RowVector3::from(dv)]);
        let tangents = Matrix3x2::from_columns(&[along_xi.normalize(), normal.cross(&along_xi).normalize()]);
        let along_surface = conformity(&(projection * tangents));
        let along_axes = conformity(&projection.fixed_columns::<2>(0).into_owned());
        if !(pixel[0].is_finite() && along_surface.is_finite() && along_axes.is_finite()) {
            facing.push(0.0);
            continue;
        }
        let area = normal.norm();
        facing.push(along_surface);
        sums.area += area;
        sums.level += normal.z.abs();
        sums.seen += area * along_surface.abs();
        sums.signed += area * along_surface;
        sums.along_axes += area * along_axes.abs();
        // The null vector of the Jacobian points away from the camera: u runs to the right and v down.
        let view = projection.row(0).cross(&projection.row(1)).normalize();
        sums.depth += area * along_surface * view.transpose().dot(&Vector3::from(point));
    }
    let grazes = |sum: f64| sum < GRAZING * sums.area;
    if grazes(sums.level) || grazes(sums.seen) || grazes(sums.along_axes) {
        return Err(Error::EdgeOn { vertical: grazes(sums.level) });
    }
    // Most of the surface is seen from its front; of a closed one, the nearer half.
    let front = if sums.signed.abs() > GRAZING * sums.seen { sums.signed } else { -sums.depth };
    let cells: Vec<usize> = (0..mesh.num_cells()).filter(|&cell| facing[cell] * front < 0.0).collect();
    if cells.is_empty() { Ok(()) } else { Err(Error::HiddenCells { cells, num_cells: mesh.num_cells() }) }
}

/// How nearly a linear map of the plane keeps all directions: 1 if it keeps angles, -1 if it also mirrors, 0 if it maps the plane to
/// a line.
fn conformity(map: &Matrix2<f64>) -> f64 {
    2.0 * map.determinant() / map.norm_squared()
}

/// Sums over the cells, each weighted by its area.
#[derive(Default)]
struct Sums {
    area: f64,
    /// Parts of the normals along `z`.
    level: f64,
    /// How well motions along the surface are seen.
    seen: f64,
    /// The same, with the sign of the side that is seen.
    signed: f64,
    /// How well motions along `x` and `y` are seen.
    along_axes: f64,
    /// Distances along the line of sight, with the signs of `signed`.
    depth: f64,
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
