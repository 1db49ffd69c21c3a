//! Points of a square divided into equal rectangles.

/// Centres of the sub-quads from sub-quad `first` on, row by row.
pub(super) fn centres(nx: u32, ny: u32, first: usize, xi: &mut [f64], eta: &mut [f64]) {
    let (nx, ny) = (nx as usize, ny as usize);
    let (dx, dy) = (2.0 / nx as f64, 2.0 / ny as f64);
    let (mut i, mut j) = (first % nx, first / nx);
    for (x, y) in xi.iter_mut().zip(eta) {
        *x = (i as f64 + 0.5) * dx - 1.0;
        *y = (j as f64 + 0.5) * dy - 1.0;
        i += 1;
        if i == nx {
            (i, j) = (0, j + 1);
        }
    }
}

/// The same centres, rotated about the centre of the square by an angle that leaves each in its sub-quad.
pub(super) fn rotated_centres(nx: u32, ny: u32, first: usize, xi: &mut [f64], eta: &mut [f64]) {
    centres(nx, ny, first, xi, eta);
    // The same angle both ways leaves the area and the moments of second order.
    let turn = 1.0 / f64::from(nx.max(ny));
    for (x, y) in xi.iter_mut().zip(eta.iter_mut()) {
        (*x, *y) = (*x + turn * *y, *y - turn * *x);
    }
}
