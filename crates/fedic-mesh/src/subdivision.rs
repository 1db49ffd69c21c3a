//! Quadrature points inside a cell: the reference domain cut into equal sub-triangles or sub-quads (paper, Fig. 5).

use std::str::FromStr;

use crate::CellType;

/// How finely a cell is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rule {
    /// Each direction of a quad by the whole pixels in the shorter of its two edges: about one point per pixel, never more
    /// along an edge. A triangle by the root of 1.6 times its area: the centres of sub-triangles leave larger gaps, and it
    /// takes as many points per pixel for the same noise.
    Edges,
    /// As many points as [`Edges`](Self::Edges), those of a quad on a grid turned about its centre by the angle that takes
    /// the points across their parts from one end of the longer rows to the other. Points a pixel apart keep the same place in their pixels all along the
    /// rows and columns of a cell, and the error of the interpolation there does not average out; turned, they sweep all
    /// places.
    #[default]
    Rotated,
    /// The paper's: every edge by the largest distance between two nodes, at least two points per pixel (four in a
    /// triangle). In a quad also by the diagonals of the parallelograms that its corners span, longer where opposite edges
    /// differ: no part is then longer than a pixel, and no pixel without a point.
    Diameter,
}

impl FromStr for Rule {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "edges" => Ok(Self::Edges),
            "rotated" => Ok(Self::Rotated),
            "diameter" => Ok(Self::Diameter),
            _ => Err(format!("unknown quadrature rule \"{name}\"; choose \"rotated\", \"edges\" or \"diameter\"")),
        }
    }
}

/// Of the rules that aim at the fewest points without more noise.
const TRIANGLE_POINTS_PER_PIXEL: f64 = 1.6;

/// A reference domain cut into equal parts, one quadrature point in each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subdivision {
    /// `n^2` homothetic sub-triangles and their centres.
    Triangle {
        /// Parts of each edge.
        n: u32,
    },
    /// `nx * ny` sub-quads and their centres.
    Quad {
        /// Parts along `xi`.
        nx: u32,
        /// Parts along `eta`.
        ny: u32,
    },
    /// `nx * ny` sub-quads, their centres turned about the centre of the whole, by no more than keeps each in its part.
    RotatedQuad {
        /// Parts along `xi`.
        nx: u32,
        /// Parts along `eta`.
        ny: u32,
    },
}

impl Subdivision {
    /// The subdivision of a cell whose nodes are projected to `pixels`, with `density` times the points of the rule.
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

    /// The reference domain cut into `parts` along every edge.
    pub const fn uniform(cell_type: CellType, parts: u32) -> Self {
        if cell_type.is_triangle() { Self::Triangle { n: parts } } else { Self::Quad { nx: parts, ny: parts } }
    }

    /// Number of quadrature points.
    pub fn num_points(self) -> usize {
        match self {
            Self::Triangle { n } => n as usize * n as usize,
            Self::Quad { nx, ny } | Self::RotatedQuad { nx, ny } => nx as usize * ny as usize,
        }
    }

    /// Area of one part of the reference domain: the weight of a point before the Jacobian.
    pub fn part_area(self) -> f64 {
        let reference = match self {
            Self::Triangle { .. } => CellType::Triangle.reference_area(),
            Self::Quad { .. } | Self::RotatedQuad { .. } => CellType::Quad.reference_area(),
        };
        reference / self.num_points() as f64
    }

    /// Reference coordinates of all points.
    pub fn all_points(self) -> Vec<[f64; 2]> {
        let (mut xi, mut eta) = (vec![0.0; self.num_points()], vec![0.0; self.num_points()]);
        self.points(0, &mut xi, &mut eta);
        xi.into_iter().zip(eta).map(|(x, y)| [x, y]).collect()
    }

    /// Writes the reference coordinates of points `first..first + xi.len()`.
    ///
    /// # Panics
    ///
    /// If `eta` is shorter than `xi`. Past the last point the coordinates mean nothing.
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
                // Row j holds 2 (n - j) - 1 sub-triangles, those that point up and down in turn.
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

/// Centres of the sub-quads from the part `first` on, row after row.
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

/// Whole parts of a length in pixels, at least one.
fn whole(length: f64) -> u32 {
    length.floor().max(1.0) as u32
}

/// Row of the sub-triangle `index`, and its place in the row.
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

/// Largest distance between two nodes, or across a parallelogram on two edges of a quad.
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

/// Length of the edge that starts at corner `from`, through its middle node where it has one.
fn edge_length(cell_type: CellType, pixels: &[[f64; 2]], from: usize) -> f64 {
    let outline = cell_type.outline();
    let steps = outline.len() / cell_type.num_corners();
    let node = |k: usize| pixels[outline[k % outline.len()]];
    (from * steps..(from + 1) * steps).map(|k| distance(node(k), node(k + 1))).sum()
}

fn polygon_area(corners: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let next = corners.clone().cycle().skip(1);
    0.5 * corners.zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
}
