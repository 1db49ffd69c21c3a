//! The quadrature rules: how finely a cell is subdivided.

use std::str::FromStr;

use thiserror::Error;

/// Rule that sets the number of quadrature points of a cell from its projection in the reference image.
///
/// [`Rotated`](Self::Rotated) is the one to use; the other two are kept for comparison with the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Rule {
    /// About one point per pixel of the projected area, whatever the shape of the cell. A parallelogram has, along each
    /// direction, as many sub-cells as whole pixels in the edge; any other quad as many as leave no two neighbouring points
    /// more than 1.2 pixels apart. A triangle is cut into rows one pixel high, parallel to its longest edge, with a point
    /// per pixel.
    Edges,
    /// Same number of points as [`Edges`](Self::Edges), on a slightly rotated grid in quads: sub-pixel phases then vary along
    /// the rows and columns of points, so that the interpolation error averages out.
    #[default]
    Rotated,
    /// The paper's rule: every edge is divided by the largest distance in pixels between two nodes, which gives at least two
    /// points per pixel (four in a triangle). In a quad the diagonals of the parallelograms spanned by adjacent edges count
    /// as well, so that no sub-cell is longer than a pixel and every pixel inside the mesh holds a point.
    Diameter,
}

impl Rule {
    /// Every rule.
    pub const ALL: [Self; 3] = [Self::Rotated, Self::Edges, Self::Diameter];

    /// Name of the rule.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Edges => "edges",
            Self::Rotated => "rotated",
            Self::Diameter => "diameter",
        }
    }
}

impl FromStr for Rule {
    type Err = UnknownRule;

    fn from_str(name: &str) -> Result<Self, UnknownRule> {
        Self::ALL.into_iter().find(|rule| rule.name() == name).ok_or_else(|| UnknownRule { name: name.to_owned() })
    }
}

/// A name that is not a quadrature rule.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("unknown quadrature rule \"{name}\"; choose one of {}", Rule::ALL.map(|rule| format!("\"{}\"", rule.name())).join(", "))]
pub struct UnknownRule {
    /// The name given.
    pub name: String,
}
