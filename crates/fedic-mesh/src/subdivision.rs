//! Quadrature points inside a cell: the reference domain divided into equal sub-cells (paper, Fig. 5).

use crate::{CellType, Rule};

/// Points per pixel of a triangle's area for the rules [`Rule::Edges`] and [`Rule::Rotated`].
const TRIANGLE_POINTS_PER_PIXEL: f64 = 1.6;

/// A reference domain divided into equal sub-cells, one quadrature point in each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subdivision {
    /// `n^2` similar sub-triangles, points at their centroids.
    Triangle {
        /// Intervals per edge.
        n: u32,
    },
    /// `nx * ny` sub-quads, points at their centres.
    Quad {
        /// Intervals along `xi`.
        nx: u32,
        /// Intervals along `eta`.
        ny: u32,
    },
    /// `nx * ny` sub-quads, their centres rotated about the centre of the domain by an angle that leaves each centre in
    /// its sub-quad.
    RotatedQuad {
        /// Intervals along `xi`.
        nx: u32,
        /// Intervals along `eta`.
        ny: u32,
    },
}

impl Subdivision {
    /// Subdivision of a cell whose nodes project to `pixels`, with about `density` times as many points as the rule gives.
    pub fn of_cell(cell_type: CellType, pixels: &[[f64; 2]], rule: Rule, density: f64) -> Self {
        let per_length = density.sqrt();
        match rule {
            Rule::Diameter => Self::uniform(cell_type, whole((diameter(cell_type, pixels) * per_length).ceil())),
            Rule::Edges | Rule::Rotated if cell_type.is_triangle() => {
                let outline = cell_type.outline().iter().map(|&a| pixels[a]);
                Self::Triangle { n: whole((TRIANGLE_POINTS_PER_PIXEL * polygon_area(outline)).sqrt() * per_length) }
            }
            Rule::Edges | Rule::Rotated => {
                let shorter = |one, other| {
                    whole(edge_length(cell_type, pixels, one).min(edge_length(cell_type, pixels, other)) * per_length)
                };
                let (nx, ny) = (shorter(0, 2), shorter(1, 3));
                if rule == Rule::Edges { Self::Quad { nx, ny } } else { Self::RotatedQuad { nx, ny } }
            }
        }
    }

    /// Subdivision with the same number of intervals along every edge.
    pub const fn uniform(cell_type: CellType, intervals: u32) -> Self {
        if cell_type.is_triangle() {
            Self::Triangle { n: intervals }
        } else {
            Self::Quad { nx: intervals, ny: intervals }
        }
    }

    /// Number of quadrature points.
    pub fn num_points(self) -> usize {
        match self {
            Self::Triangle { n } => n as usize * n as usize,
            Self::Quad { nx, ny } | Self::RotatedQuad { nx, ny } => nx as usize * ny as usize,
        }
    }

    /// Area of one sub-cell in the reference domain: the weight of a point, without the Jacobian.
    pub fn subcell_area(self) -> f64 {
        let reference = match self {
            Self::Triangle { .. } => CellType::Triangle.reference_area(),
            Self::Quad { .. } | Self::RotatedQuad { .. } => CellType::Quad.reference_area(),
        };
        reference / self.num_points() as f64
    }

    /// Reference coordinates of all points, row by row.
    pub fn all_points(self) -> Vec<[f64; 2]> {
        let (mut xi, mut eta) = (vec![0.0; self.num_points()], vec![0.0; self.num_points()]);
        self.points(0, &mut xi, &mut eta);
        xi.into_iter().zip(eta).map(|(x, y)| [x, y]).collect()
    }

    /// Writes the reference coordinates of points `first..first + xi.len()`.
    ///
    /// # Panics
    ///
    /// May panic if `eta` is shorter than `xi`. Coordinates beyond the last point are unspecified.
    pub fn points(self, first: usize, xi: &mut [f64], eta: &mut [f64]) {
        match self {
            Self::Quad { nx, ny } => quad_centres(nx, ny, first, xi, eta),
            Self::RotatedQuad { nx, ny } => {
                quad_centres(nx, ny, first, xi, eta);
                // The same angle both ways leaves the area and the moments of second order.
                let turn = 1.0 / f64::from(nx.max(ny));
                for (x, y) in xi.iter_mut().zip(eta.iter_mut()) {
                    (*x, *y) = (*x + turn * *y, *y - turn * *x);
                }
            }
            Self::Triangle { n } => {
                let n = n as usize;
                let h = 1.0 / n as f64;
                // Row j holds 2 (n - j) - 1 sub-triangles, pointing up and down in alternation.
                let (mut j, mut i) = triangle_row(n, first);
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
        }
    }
}

/// Centres of the sub-quads from sub-quad `first` on, row by row.
fn quad_centres(nx: u32, ny: u32, first: usize, xi: &mut [f64], eta: &mut [f64]) {
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

/// Whole pixels of a length, at least one.
fn whole(length: f64) -> u32 {
    length.floor().max(1.0) as u32
}

/// Row of the sub-triangle `index`, and its position in the row.
fn triangle_row(n: usize, index: usize) -> (usize, usize) {
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

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Largest distance between two nodes, or, in a quad, diagonal of a parallelogram spanned by two adjacent edges.
fn diameter(cell_type: CellType, pixels: &[[f64; 2]]) -> f64 {
    let pairs = pixels.iter().enumerate().flat_map(|(i, &a)| pixels[..i].iter().map(move |&b| distance(a, b)));
    let between_nodes = pairs.fold(0.0, f64::max);
    if cell_type.is_triangle() {
        return between_nodes;
    }
    let fourth = |k: usize| {
        let [before, corner, after] = [k + 3, k, k + 1].map(|c| pixels[c % 4]);
        distance(corner, [before[0] + after[0] - corner[0], before[1] + after[1] - corner[1]])
    };
    (0..4).map(fourth).fold(between_nodes, f64::max)
}

/// Length of the edge that starts at corner `from`, as a polyline through its nodes.
fn edge_length(cell_type: CellType, pixels: &[[f64; 2]], from: usize) -> f64 {
    let (outline, steps) = (cell_type.outline(), cell_type.edge_intervals());
    let node = |k: usize| pixels[outline[k % outline.len()]];
    (from * steps..(from + 1) * steps).map(|k| distance(node(k), node(k + 1))).sum()
}

fn polygon_area(corners: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let next = corners.clone().cycle().skip(1);
    0.5 * corners.zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
}
