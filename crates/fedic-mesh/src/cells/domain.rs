//! The two reference domains.

/// Domain of the reference coordinates `(xi, eta)` of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReferenceDomain {
    /// Triangle `(0, 0) (1, 0) (0, 1)`.
    Triangle,
    /// Square `[-1, 1]^2`.
    Square,
}

impl ReferenceDomain {
    /// Corners, counter-clockwise.
    pub const fn corners(self) -> &'static [[f64; 2]] {
        match self {
            Self::Triangle => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            Self::Square => &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        }
    }

    /// Area.
    pub const fn area(self) -> f64 {
        match self {
            Self::Triangle => 0.5,
            Self::Square => 4.0,
        }
    }

    /// Centroid.
    pub const fn centre(self) -> [f64; 2] {
        match self {
            Self::Triangle => [1.0 / 3.0, 1.0 / 3.0],
            Self::Square => [0.0, 0.0],
        }
    }

    /// Whether a point lies in the domain or at most about `tolerance` outside.
    pub fn contains(self, [xi, eta]: [f64; 2], tolerance: f64) -> bool {
        match self {
            Self::Triangle => xi >= -tolerance && eta >= -tolerance && xi + eta <= 1.0 + tolerance,
            Self::Square => xi.abs() <= 1.0 + tolerance && eta.abs() <= 1.0 + tolerance,
        }
    }

    /// Points between the nodes where a polynomial fitted to a function at the nodes and the centre errs most: one if the
    /// function is smooth, several if it is piecewise (a spline).
    pub const fn check_points(self, piecewise: bool) -> &'static [[f64; 2]] {
        match (self, piecewise) {
            (Self::Triangle, false) => &[[0.5, 0.25]],
            (Self::Triangle, true) => &[[0.5, 0.25], [0.25, 0.5], [0.25, 0.25]],
            (Self::Square, false) => &[[0.5, 0.5]],
            // Halfway from the centre to the edges the error of a piecewise function is as large as anywhere.
            (Self::Square, true) => &[[0.0, 0.5], [0.0, -0.5], [0.5, 0.0], [-0.5, 0.0]],
        }
    }
}
