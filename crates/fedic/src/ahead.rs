//! What the next cell will read, asked from the memory while this one is worked on.
//!
//! A cell reads some twenty short stretches of the image, which the processor does not foresee, and one of each number kept at
//! its points. They are asked for a few at a time, between the steps of the cell before: all at once, they would be waited for.

use fedic_image::Interpolator;
use fedic_mesh::Mesh;

use crate::cell_view::extents;
use crate::points::Points;
use crate::sights::Sight;

/// Part of what a cell will read.
#[derive(Clone, Copy)]
pub(crate) enum Share {
    Gradient,
    UpperImage,
    LowerImage,
    Value,
}

/// What a cell will read.
pub(crate) struct Ahead<'a> {
    points: &'a Points,
    image: &'a Interpolator,
    cell: usize,
    /// Of its nodes.
    extents: [[f64; 2]; 2],
}

impl<'a> Ahead<'a> {
    /// Of a cell whose nodes are seen so; `None` past the last one.
    pub(crate) fn new(
        points: &'a Points,
        image: &'a Interpolator,
        mesh: &Mesh,
        cell: usize,
        views: &[Sight],
    ) -> Option<Self> {
        if cell >= mesh.num_cells() {
            return None;
        }
        let extents = extents(mesh.cell(cell).nodes.iter().map(|&node| &views[node as usize]));
        Some(Self { points, image, cell, extents })
    }

    pub(crate) fn ask(&self, share: Share) {
        let [[left, right], [top, bottom]] = self.extents;
        let middle = 0.5 * (top + bottom);
        match share {
            Share::Gradient => self.points.prefetch_gradient(self.cell),
            Share::UpperImage => self.image.prefetch([left, top], [right, middle]),
            Share::LowerImage => self.image.prefetch([left, middle], [right, bottom]),
            Share::Value => self.points.prefetch_value(self.cell),
        }
    }
}
