//! What the next cell will read, asked from the memory while this one is worked on.
//!
//! A cell reads some twenty short stretches of the image, which the processor does not foresee, and one of each number kept at
//! its points. They are asked for a few at a time, between the steps of the cell before: all at once, they would be waited for.

use fedic_image::Interpolator;
use fedic_mesh::Mesh;

use crate::expansion::NodeView;
use crate::points::Points;

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
    /// The least and the greatest pixel coordinates of its nodes.
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Ahead<'a> {
    /// Of a cell whose nodes are seen so; `None` past the last one.
    pub(crate) fn new(
        points: &'a Points,
        image: &'a Interpolator,
        mesh: &Mesh,
        cell: usize,
        views: &[NodeView],
    ) -> Option<Self> {
        if cell >= mesh.num_cells() {
            return None;
        }
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &node in mesh.cell(cell).nodes {
            let pixel = views[node as usize].pixel;
            for c in 0..2 {
                (low[c], high[c]) = (low[c].min(pixel[c]), high[c].max(pixel[c]));
            }
        }
        Some(Self { points, image, cell, low, high })
    }

    pub(crate) fn ask(&self, share: Share) {
        let ([left, top], [right, bottom]) = (self.low, self.high);
        let middle = 0.5 * (top + bottom);
        match share {
            Share::Gradient => self.points.prefetch_gradient(self.cell),
            Share::UpperImage => self.image.prefetch([left, top], [right, middle]),
            Share::LowerImage => self.image.prefetch([left, middle], [right, bottom]),
            Share::Value => self.points.prefetch_value(self.cell),
        }
    }
}
