//! Regular meshes of rectangles.

use fedic_memory::is_available;

use crate::{CellType, Mesh, MeshError};

/// Largest number of places of a grid for nodes: one for 256 pixels of the largest image.
const MAX_PLACES: f64 = (1 << 22) as f64;

/// Memory of a place and of what refers to it, in bytes: at most 174, in a mesh of triangles.
const BYTES_PER_PLACE: usize = 192;

/// Regular mesh of a rectangle with cells of about `size`.
///
/// `bounds` are `[x0, y0, x1, y1]`. The number of squares along each side is its length divided by `size`, rounded, and at
/// least one, so that the cells fill the rectangle exactly. Triangles halve the squares along alternating diagonals. Nodes
/// are numbered along `x` first.
///
/// # Errors
///
/// [`MeshError::InvalidRectangle`] if the bounds are empty or not finite or the size is not positive,
/// [`MeshError::TooLarge`] if there are too many nodes, or too many for the memory.
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
    let count = |length: f64| (length / size).round().max(1.0);
    let (columns, rows) = (count(x1 - x0), count(y1 - y0));
    // The nodes lie on a grid of this many intervals per square.
    let step = cell_type.data().grid_intervals;
    let places = columns * rows * (step * step) as f64;
    if places > MAX_PLACES || !is_available(places as usize * BYTES_PER_PLACE) {
        return Err(MeshError::TooLarge { cells: columns * rows });
    }
    let (columns, rows) = (columns as usize, rows as usize);
    let (nx, ny) = (columns * step + 1, rows * step + 1);

    let mut connectivity = Vec::new();
    let mut used = vec![false; nx * ny];
    for row in 0..rows {
        for column in 0..columns {
            for corners in cells_of_square(cell_type, (row + column) % 2 == 0) {
                for &at in cell_type.reference_nodes() {
                    let [i, j] = grid_place(corners, at, step);
                    let place = (row * step + j) * nx + column * step + i;
                    used[place] = true;
                    connectivity.push(place as i64);
                }
            }
        }
    }

    let mut points = Vec::with_capacity(nx * ny);
    let mut index = vec![0_i64; nx * ny];
    let along = |low: f64, high: f64, k: usize, n: usize| low + (high - low) * k as f64 / (n - 1) as f64;
    for place in (0..nx * ny).filter(|&place| used[place]) {
        index[place] = points.len() as i64;
        points.push([along(x0, x1, place % nx, nx), along(y0, y1, place / nx, ny), 0.0]);
    }
    connectivity.iter_mut().for_each(|node| *node = index[*node as usize]);
    Mesh::new(points, &[(cell_type, connectivity)])
}

/// Corners of the quad or the two triangles that fill the unit square.
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

/// Grid place of a reference node of the cell with these corners in the unit square.
fn grid_place(corners: &[[f64; 2]], at: [f64; 2], step: usize) -> [usize; 2] {
    let linear = if corners.len() == 3 { CellType::Triangle } else { CellType::Quad };
    crate::map(linear, corners, at).map(|c| (c * step as f64).round() as usize)
}
