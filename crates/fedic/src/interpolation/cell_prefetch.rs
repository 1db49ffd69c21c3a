//! What the next cell will read of the deformed image, asked from the memory while this one is worked on.
//!
//! A cell reads some twenty short stretches of the image, which the processor does not foresee. They are asked for half at a
//! time, between the steps of the cell before: all at once, they would be waited for longer.

use fedic_image::Interpolator;
use fedic_mesh::Mesh;

use crate::projection::cell_projection::extents;
use crate::projection::projected_points::Sight;

/// The part of an image that a cell will read.
pub(crate) struct Ahead<'a> {
    image: &'a Interpolator,
    /// Of the cell's nodes.
    extents: [[f64; 2]; 2],
}

impl<'a> Ahead<'a> {
    /// Of the cell that comes next, if any, where nodes are seen so.
    pub(crate) fn new(image: &'a Interpolator, mesh: &Mesh, next: Option<usize>, views: &[Sight]) -> Option<Self> {
        let cell = mesh.cell(next.filter(|&cell| cell < mesh.num_cells())?);
        Some(Self { image, extents: extents(cell.nodes.iter().map(|&node| &views[node as usize])) })
    }

    /// Asks for the upper half.
    pub(crate) fn ask_upper(&self) {
        let [[left, right], [top, bottom]] = self.extents;
        self.image.prefetch([left, top], [right, 0.5 * (top + bottom)]);
    }

    /// Asks for the lower half.
    pub(crate) fn ask_lower(&self) {
        let [[left, right], [top, bottom]] = self.extents;
        self.image.prefetch([left, 0.5 * (top + bottom)], [right, bottom]);
    }
}
