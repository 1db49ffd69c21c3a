//! Prefetching of the part of the deformed image that the next cell will read.
//!
//! A cell reads some twenty short stretches of the image, which the hardware prefetcher does not predict. Each half of them is
//! prefetched between two steps of the cell before: requested all at once, they would stall that cell.

use fedic_image::Interpolator;
use fedic_mesh::Mesh;

use crate::projection::projected_points::{ProjectedPoint, pixel_bounds};

/// The part of an image that a cell will read.
pub(crate) struct CellPrefetch<'a> {
    image: &'a Interpolator,
    bounds: [[f64; 2]; 2],
}

impl<'a> CellPrefetch<'a> {
    /// The part read by cell `next`, if there is such a cell.
    pub(crate) fn new(
        image: &'a Interpolator,
        mesh: &Mesh,
        next: Option<usize>,
        nodes: &[ProjectedPoint],
    ) -> Option<Self> {
        let cell = mesh.cell(next.filter(|&cell| cell < mesh.num_cells())?);
        Some(Self { image, bounds: pixel_bounds(cell.nodes.iter().map(|&node| &nodes[node as usize])) })
    }

    /// Prefetches the upper half.
    pub(crate) fn prefetch_upper_half(&self) {
        let [[left, right], [top, bottom]] = self.bounds;
        self.image.prefetch([left, top], [right, 0.5 * (top + bottom)]);
    }

    /// Prefetches the lower half.
    pub(crate) fn prefetch_lower_half(&self) {
        let [[left, right], [top, bottom]] = self.bounds;
        self.image.prefetch([left, 0.5 * (top + bottom)], [right, bottom]);
    }
}
