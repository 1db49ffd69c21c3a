//! Number of displacement components at a node.
//!
//! Everything below the correlator is generic in it, as the const parameter `D`.

/// Two components in the plane of the mesh: what one camera can measure.
pub const PLANE: usize = 2;
/// Three components in space: two cameras or more.
pub const SPACE: usize = 3;
