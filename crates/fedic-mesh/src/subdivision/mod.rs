//! Quadrature points inside a cell: the reference domain divided into sub-cells of equal area (paper, Fig. 5).

mod intervals;
mod quads;
mod triangles;

use crate::{CellType, Rule};

/// A reference domain divided into sub-cells of equal area, one quadrature point in each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subdivision {
    /// `n^2` similar sub-triangles, points at their centroids.
    Triangle {
        /// Intervals per edge.
        n: u32,
    },
    /// Rows parallel to one edge, each cut into equal parts. A row of the triangle has as many parts as its length gives,
    /// `n` along the edge, and is as high as its number of parts gives.
    TriangleRows {
        /// Corner at which the edge starts: 0, 1 or 2.
        base: u8,
        /// Intervals along the edge.
        n: u32,
        /// Rows.
        rows: u32,
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
            Rule::Diameter => Self::uniform(cell_type, intervals::by_diameter(cell_type, pixels, per_length)),
            Rule::Edges | Rule::Rotated if cell_type.is_triangle() => {
                let (base, [n, rows]) = intervals::of_triangle(cell_type, pixels, per_length);
                Self::TriangleRows { base, n, rows }
            }
            Rule::Edges => {
                let [nx, ny] = intervals::of_quad(cell_type, pixels, per_length);
                Self::Quad { nx, ny }
            }
            Rule::Rotated => {
                let [nx, ny] = intervals::of_quad(cell_type, pixels, per_length);
                Self::RotatedQuad { nx, ny }
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
            Self::TriangleRows { n, rows, .. } => triangles::num_points_in_rows(n, rows),
            Self::Quad { nx, ny } | Self::RotatedQuad { nx, ny } => nx as usize * ny as usize,
        }
    }

    /// Area of one sub-cell in the reference domain: the weight of a point, without the Jacobian.
    pub fn subcell_area(self) -> f64 {
        let reference = match self {
            Self::Triangle { .. } | Self::TriangleRows { .. } => CellType::Triangle.reference_area(),
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
            Self::Triangle { n } => triangles::centroids(n, first, xi, eta),
            Self::TriangleRows { base, n, rows } => triangles::points_in_rows(base, [n, rows], first, xi, eta),
            Self::Quad { nx, ny } => quads::centres(nx, ny, first, xi, eta),
            Self::RotatedQuad { nx, ny } => quads::rotated_centres(nx, ny, first, xi, eta),
        }
    }
}
