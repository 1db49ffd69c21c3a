//! Points of a triangle divided into similar triangles, or into rows parallel to one edge.

/// Centroids of the sub-triangles from sub-triangle `first` on, row by row.
pub(super) fn centroids(n: u32, first: usize, xi: &mut [f64], eta: &mut [f64]) {
    let n = n as usize;
    let h = 1.0 / n as f64;
    // Row j holds 2 (n - j) - 1 sub-triangles, pointing up and down in alternation.
    let (mut j, mut i) = row_of_triangles(n, first);
    for (x, y) in xi.iter_mut().zip(eta.iter_mut()) {
        let third = if i % 2 == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
        *x = ((i / 2) as f64 + third) * h;
        *y = (j as f64 + third) * h;
        i += 1;
        if i + 2 * j + 1 == 2 * n {
            (i, j) = (0, j + 1);
        }
    }
}

/// Row of the sub-triangle `index`, and its position in the row.
fn row_of_triangles(n: usize, index: usize) -> (usize, usize) {
    let start = |j: usize| n * n - (n - j) * (n - j);
    let rest = (n * n - index.min(n * n)) as f64;
    let mut j = (n as f64 - rest.sqrt().ceil()).max(0.0) as usize;
    while j > 0 && start(j) > index {
        j -= 1;
    }
    while j + 1 < n && start(j + 1) <= index {
        j += 1;
    }
    (j, index - start(j))
}

/// Number of points in `rows` rows, the first of which would have `n` points were it as long as the edge.
pub(super) fn num_points_in_rows(n: u32, rows: u32) -> usize {
    (0..rows).map(|row| in_row(n, rows, row)).sum()
}

/// Number of points in a row: proportional to its length at half its height, at least one.
fn in_row(n: u32, rows: u32, row: u32) -> usize {
    let (n, rows, row) = (u64::from(n), u64::from(rows), u64::from(row));
    ((n * (2 * (rows - row) - 1) + rows) / (2 * rows)).max(1) as usize
}

/// Points from point `first` on of rows parallel to the edge from corner `base` to the next one.
///
/// The height of a row makes its area proportional to its number of points. Its points are at the height of its centroid, so
/// that linear functions are integrated exactly.
pub(super) fn points_in_rows(base: u8, [n, rows]: [u32; 2], first: usize, xi: &mut [f64], eta: &mut [f64]) {
    let total = num_points_in_rows(n, rows) as f64;
    let (mut row, mut start) = (0, 0);
    while row + 1 < rows && start + in_row(n, rows, row) <= first {
        start += in_row(n, rows, row);
        row += 1;
    }
    let mut k = first - start;
    let mut current = Row::new(start, in_row(n, rows, row), total);
    for (x, y) in xi.iter_mut().zip(eta.iter_mut()) {
        if k == current.count && row + 1 < rows {
            (start, row, k) = (start + current.count, row + 1, 0);
            current = Row::new(start, in_row(n, rows, row), total);
        }
        let towards_second = (k as f64 + 0.5) / current.count as f64 * (1.0 - current.height);
        let corners = [1.0 - current.height - towards_second, towards_second, current.height];
        // The barycentric coordinates of corners 1 and 2 are the reference coordinates.
        [*x, *y] = [1, 2].map(|corner| corners[(corner + 3 - usize::from(base)) % 3]);
        k += 1;
    }
}

/// A row of a triangle of height one.
struct Row {
    /// Number of points.
    count: usize,
    /// Height of the centroid above the edge.
    height: f64,
}

impl Row {
    /// The row of `count` points that follows `before` points, out of `total`.
    fn new(before: usize, count: usize, total: f64) -> Self {
        // The triangle above a height has as its area the square of its own height.
        let [low, high] = [before, before + count].map(|points| (1.0 - points as f64 / total).max(0.0).sqrt());
        // Distance of the centroid from the apex: ratio of the integrals of t^2 and t between the two.
        let from_apex = 2.0 / 3.0 * (low * low + low * high + high * high) / (low + high);
        Self { count, height: 1.0 - from_apex }
    }
}
