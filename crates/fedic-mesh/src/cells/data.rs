//! The data that each cell type declares.

use super::ReferenceDomain;

/// Data of a cell type.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct CellData {
    /// meshio's name.
    pub name: &'static str,
    /// Reference domain.
    pub domain: ReferenceDomain,
    /// Nodes in the reference domain, `(xi, eta)` each: corners, nodes of the edges, nodes inside.
    pub reference_nodes: &'static [[f64; 2]],
    /// Local indices of the nodes on the boundary, counter-clockwise from the first corner.
    pub outline: &'static [usize],
    /// Local indices that list the nodes clockwise, from the first corner.
    pub reversed: &'static [usize],
    /// Local indices of the corners of linear triangles and quadrilaterals between the nodes, counter-clockwise. They cover the domain.
    /// The number of nodes stands for the centre.
    pub linear_parts: &'static [&'static [usize]],
    /// Number of intervals per edge of the coarsest regular grid of the domain that contains all nodes.
    pub grid_intervals: usize,
    /// Whether the values and slopes at the nodes and the value at the centre determine the coefficient of `xi^i eta^j`
    /// among those of degree 4 and less.
    pub determines: fn(i: i32, j: i32) -> bool,
    /// Number of the type in VTK's formats.
    pub vtk_type: u8,
    /// The type in Gmsh, or `None` if Gmsh has none.
    pub gmsh: Option<GmshElement>,
    /// Node counts in the names of Abaqus's surface elements of this type: `4` for `CPS4R`, `65` for `STRI65`.
    pub abaqus_suffixes: &'static [&'static str],
}

/// How Gmsh's mesher makes the cells of a type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GmshElement {
    /// Polynomial order.
    pub order: u8,
    /// Whether the element has nodes on its boundary alone although its order allows nodes inside.
    pub incomplete: bool,
}
