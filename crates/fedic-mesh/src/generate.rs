//! Regular meshes of a rectangle.

use crate::{CellType, Mesh, MeshError};

/// Regular mesh of a rectangle with cells of about `size`.
///
/// `bounds` are `[x0, y0, x1, y1]`; the number of cells along each side is the length over `size`, rounded, so that the
/// cells fill the rectangle exactly. Triangles halve the quads along alternating diagonals. Nodes run along `x` first.
///
/// # Errors
///
/// [`MeshError::InvalidRectangle`] where the bounds are empty or not finite or the size is not positive.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{CellType, rectangle_mesh};
/// let mesh = rectangle_mesh([0.0, 0.0, 100.0, 50.0], 20.0, CellType::Quad)?;
/// assert_eq!((mesh.num_cells(), mesh.num_nodes()), (5 * 3, 6 * 4));
/// # Ok::<(), fedic_mesh::MeshError>(())
/// ```
pub fn rectangle_mesh(bounds: [f64; 4], size: f64, cell_type: CellType) -> Result<Mesh, MeshError> {
    let [x0, y0, x1, y1] = bounds;
    let finite = bounds.iter().all(|b| b.is_finite()) && size.is_finite();
    if !finite || size <= 0.0 || x0 >= x1 || y0 >= y1 {
        return Err(MeshError::InvalidRectangle { bounds, size });
    }
    let parts = |length: f64| (length / size).round().max(1.0);
    let (columns, rows) = (parts(x1 - x0), parts(y1 - y0));
    if columns * rows > f64::from(u32::MAX / 16) {
        return Err(MeshError::TooLarge { cells: columns * rows });
    }
    let (columns, rows) = (columns as usize, rows as usize);
    let quadratic = cell_type.num_nodes() > cell_type.num_corners();
    let step = if quadratic { 2 } else { 1 };
    let (nx, ny) = (columns * step + 1, rows * step + 1);

    // Quad8 has no node at the centre of its cells: the lattice skips those.
    let skipped = |i: usize, j: usize| cell_type == CellType::Quad8 && i % 2 == 1 && j % 2 == 1;
    let mut points = Vec::with_capacity(nx * ny);
    let mut index = vec![0_i64; nx * ny];
    for j in 0..ny {
        for i in 0..nx {
            if !skipped(i, j) {
                index[j * nx + i] = points.len() as i64;
                let along = |low: f64, high: f64, k: usize, n: usize| low + (high - low) * k as f64 / (n - 1) as f64;
                points.push([along(x0, x1, i, nx), along(y0, y1, j, ny), 0.0]);
            }
        }
    }

    let mut connectivity = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            for corners in cells_of_square(cell_type, (row + column) % 2 == 0) {
                connectivity.extend(cell_type.reference_nodes().iter().map(|&at| {
                    let [i, j] = lattice_place(corners, at, step);
                    index[(row * step + j) * nx + column * step + i]
                }));
            }
        }
    }
    Mesh::new(points, &[(cell_type, connectivity)])
}

/// Corners, on the unit square, of the one quad or two triangles that fill it.
fn cells_of_square(cell_type: CellType, rising: bool) -> &'static [&'static [[f64; 2]]] {
    const QUAD: &[&[[f64; 2]]] = &[&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
    const RISING: &[&[[f64; 2]]] = &[&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], &[[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
    const FALLING: &[&[[f64; 2]]] = &[&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
    match (cell_type.is_triangle(), rising) {
        (false, _) => QUAD,
        (true, true) => RISING,
        (true, false) => FALLING,
    }
}

/// Lattice place of a reference node in a square whose cell has these corners.
fn lattice_place(corners: &[[f64; 2]], at: [f64; 2], step: usize) -> [usize; 2] {
    let linear = if corners.len() == 3 { CellType::Triangle } else { CellType::Quad };
    crate::map(linear, corners, at).map(|c| (c * step as f64).round() as usize)
}
