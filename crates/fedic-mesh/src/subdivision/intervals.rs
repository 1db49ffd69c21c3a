//! Numbers of intervals into which the rules divide a cell, from the pixels of its nodes.

use crate::{CellType, jacobian};

/// Largest distance in pixels of neighbouring points in a cell that is no parallelogram, at a density of one. Up to about 1.4
/// the noise of the images is averaged as by the pixels; the margin is for fine textures.
const LARGEST_SPACING: f64 = 1.2;
/// Relative difference below which lengths count as equal.
const ROUNDING: f64 = 1e-9;

/// Intervals along `xi` and `eta` of a quadrilateral.
///
/// A parallelogram is divided into the whole pixels of its edges. In any other cell points are spread unevenly: in each direction
/// the shortest of two opposite edges and the line halfway between them counts, unless neighbouring points would be further apart
/// than [`LARGEST_SPACING`] somewhere.
pub(super) fn of_quad(cell_type: CellType, pixels: &[[f64; 2]], per_length: f64) -> [u32; 2] {
    let spans = Spans::of(cell_type, pixels);
    let midline = jacobian(cell_type, pixels, cell_type.reference_centre());
    let shortest = [0, 1].map(|axis| {
        let halfway = 2.0 * midline[0][axis].hypot(midline[1][axis]);
        let edges = [axis, axis + 2].map(|edge| edge_length(cell_type, pixels, edge));
        edges[0].min(edges[1]).min(halfway * (1.0 + ROUNDING))
    });
    // Rows of points along one direction may be sheared: their distance counts, not that along the other direction.
    let along_xi = [spans.lengths[0], spans.heights[1]];
    let along_eta = [spans.heights[0], spans.lengths[1]];
    let [one, other] = [along_xi, along_eta]
        .map(|longest| [0, 1].map(|axis| whole(shortest[axis].max(longest[axis] / LARGEST_SPACING) * per_length)));
    let count = |[nx, ny]: [u32; 2]| u64::from(nx) * u64::from(ny);
    if count(one) <= count(other) { one } else { other }
}

/// Longest edge of a triangle, by the corner at which it starts, intervals along it and rows parallel to it: a pixel each, or more
/// where an edge is curved so that neighbouring points would be further apart than [`LARGEST_SPACING`].
pub(super) fn of_triangle(cell_type: CellType, pixels: &[[f64; 2]], per_length: f64) -> (u8, [u32; 2]) {
    let length = |corner: usize| distance(pixels[corner], pixels[(corner + 1) % 3]);
    let base = [1, 2].into_iter().fold(
        0,
        |base, corner| {
            if length(corner) > length(base) * (1.0 + ROUNDING) { corner } else { base }
        },
    );
    let corners = cell_type.reference_nodes();
    let direction = [0, 1].map(|d| corners[(base + 1) % 3][d] - corners[base][d]);
    let places = CellType::Triangle6.reference_nodes();
    let [mut mean, mut longest] = [[0.0; 2], [0.0_f64; 2]];
    for &at in places {
        let [[xx, xy], [yx, yy]] = jacobian(cell_type, pixels, at);
        let along = (xx * direction[0] + xy * direction[1]).hypot(yx * direction[0] + yy * direction[1]);
        let height = (xx * yy - xy * yx).abs() / along;
        for (k, span) in [along, height].into_iter().enumerate() {
            mean[k] += span / places.len() as f64;
            longest[k] = longest[k].max(span);
        }
    }
    let intervals = [0, 1].map(|k| rounded(mean[k].max(longest[k] / LARGEST_SPACING) * per_length));
    (base as u8, intervals)
}

/// Intervals along every edge by the paper's rule.
pub(super) fn by_diameter(cell_type: CellType, pixels: &[[f64; 2]], per_length: f64) -> u32 {
    whole((diameter(cell_type, pixels) * per_length).ceil())
}

/// Largest extents of a quadrilateral in pixels along `xi` and `eta`, if it were everywhere as it is at one point.
struct Spans {
    lengths: [f64; 2],
    /// The same, perpendicular to the other direction.
    heights: [f64; 2],
}

impl Spans {
    fn of(cell_type: CellType, pixels: &[[f64; 2]]) -> Self {
        let mut spans = Self { lengths: [0.0; 2], heights: [0.0; 2] };
        for &at in CellType::Quad9.reference_nodes() {
            let [[xx, xy], [yx, yy]] = jacobian(cell_type, pixels, at);
            let lengths = [2.0 * xx.hypot(yx), 2.0 * xy.hypot(yy)];
            let area = 4.0 * (xx * yy - xy * yx).abs();
            for axis in 0..2 {
                spans.lengths[axis] = spans.lengths[axis].max(lengths[axis]);
                spans.heights[axis] = spans.heights[axis].max(area / lengths[1 - axis]);
            }
        }
        spans
    }
}

/// Whole pixels of a length, at least one.
fn whole(length: f64) -> u32 {
    length.floor().max(1.0) as u32
}

/// Pixels of a length rounded to the nearest whole number, at least one.
fn rounded(length: f64) -> u32 {
    whole(length.round())
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Largest distance between two nodes, or, in a quad, diagonal of a parallelogram spanned by two adjacent edges.
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

/// Length of the edge that starts at corner `from`, as a polyline through its nodes.
fn edge_length(cell_type: CellType, pixels: &[[f64; 2]], from: usize) -> f64 {
    let (outline, steps) = (cell_type.outline(), cell_type.edge_intervals());
    let node = |k: usize| pixels[outline[k % outline.len()]];
    (from * steps..(from + 1) * steps).map(|k| distance(node(k), node(k + 1))).sum()
}
